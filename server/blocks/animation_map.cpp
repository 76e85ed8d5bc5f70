// Animation Map (3.4): p = max(0, (t + φ) mod (n + aZ) − aZ). Integers for any 64-bit step; aZ is rounded
// down.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/blocks/compilation.h"

namespace tessera {

namespace {

__extension__ using Wide = __int128;

/// So long that the frames are never reached: "∞".
constexpr std::int64_t never = std::int64_t{1} << 62;

/// Steps of a field: a constant of any size, or what a node gives, rounded down.
struct Steps {
    std::int64_t constant = 0;
    int input = -1;       ///< Of the op, if it is no constant.
    int number_log2 = 0;  ///< The input is in steps of 2^-number_log2.
};

class AnimationOp final : public CellOp {
  public:
    AnimationOp(std::shared_ptr<const FrameLine> frames, Steps phase, Steps rest, std::int64_t density)
        : frames_{std::move(frames)}, phase_{phase}, rest_{rest}, density_{density} {}

    void run(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const override {
        for (std::int32_t i = 0; i < stretch.count; ++i) {
            const std::int64_t phase =
                phase_.input < 0 ? phase_.constant : std::int64_t{in[phase_.input][i]} >> phase_.number_log2;
            const std::int64_t rest =
                rest_.input < 0 ? rest_.constant : in[rest_.input][i] * density_ >> (16 + rest_.number_log2);
            out[i] = pattern_at(stretch.step, phase, rest);
        }
    }

  private:
    std::int32_t pattern_at(std::int64_t step, std::int64_t phase, std::int64_t rest) const noexcept {
        if (rest >= never) return frames_->patterns.front();
        const std::int64_t cycle = frames_->steps() + rest;
        const auto floor_mod = [&](std::int64_t value) {
            const std::int64_t left = value % cycle;
            return left < 0 ? left + cycle : left;
        };
        // Both below 2^63 − 1, so that their sum needs one subtraction and no wider type
        std::int64_t at = floor_mod(step);
        const std::int64_t shift = floor_mod(phase);
        at = at >= cycle - shift ? at - (cycle - shift) : at + shift;
        const std::int64_t shown = std::max<std::int64_t>(0, at - rest);
        const auto frame = std::upper_bound(frames_->ends.begin(), frames_->ends.end(), shown);
        return frames_->patterns[static_cast<std::size_t>(frame - frames_->ends.begin())];
    }

    std::shared_ptr<const FrameLine> frames_;
    Steps phase_, rest_;
    std::int64_t density_;  ///< In steps of 2^-16; 0 to 2^31.
};

/// A field of steps. Adds its node to `inputs` if it is no constant.
Result<Steps> read_steps(Compilation& c, std::size_t block, std::string_view field, const proto::Value& value,
                         std::int64_t least, std::vector<std::size_t>& inputs) {
    const std::string range = "; from " + std::to_string(least) + " on";
    switch (value.value_case()) {
        case proto::Value::VALUE_NOT_SET:
            return Steps{};
        case proto::Value::kInteger:
            if (value.integer() < least)
                return c.error(block, field, "is " + std::to_string(value.integer()) + range);
            return Steps{value.integer()};
        case proto::Value::kNumber:
            if (!(std::abs(value.number()) <= 1e15) || value.number() < static_cast<double>(least))
                return c.error(block, field,
                               "is " + number_text(value.number()) + "; a number of steps up to 1e15" +
                                   (least == 0 ? ", from 0 on" : ""));
            return Steps{static_cast<std::int64_t>(std::floor(value.number()))};
        case proto::Value::kBlock:
            break;
    }
    const std::size_t node = c.blocks[c.named(value.block())].node;
    if (c.nodes[node].least < least) return c.error(block, field, range_text(c.nodes[node]) + range);
    inputs.push_back(node);
    return Steps{0, static_cast<int>(inputs.size() - 1), c.nodes[node].number ? 16 : 0};
}

}  // namespace

Result<void> compile_animation_map(Compilation& c, std::size_t block) {
    const proto::AnimationMap& message = c.graph.blocks[block].message->animation_map();
    const double density = message.has_density() ? message.density() : 1;
    if (!(density >= 0 && density <= 32767))
        return c.error(block, ".density", "is " + number_text(density) + "; a number from 0 to 32767");
    const std::int64_t fixed_density = to_number(density);
    CellNode node;
    const auto phase = read_steps(c, block, ".phase", message.phase(),
                                  std::numeric_limits<std::int64_t>::min(), node.inputs);
    if (!phase) return phase.error();
    auto rest = read_steps(c, block, ".rest", message.rest(), 0, node.inputs);
    if (!rest) return rest.error();
    if (rest->input < 0)
        rest->constant =
            static_cast<std::int64_t>(std::min<Wide>(Wide{rest->constant} * fixed_density >> 16, never));

    const auto& frames = c.blocks[c.named(message.sequence())].frames;
    node.least = frames->least;
    node.most = frames->most;
    node.steps = frames->patterns.size() > 1 && (rest->input >= 0 || rest->constant < never);
    if (!node.steps) node.least = node.most = frames->patterns.front(), node.inputs.clear();
    node.op = std::make_shared<AnimationOp>(frames, *phase, *rest, fixed_density);
    if (auto added = c.add_node(block, std::move(node)); !added) return added.error();
    return {};
}

}  // namespace tessera
