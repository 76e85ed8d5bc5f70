// Animation Map (3.4) whose frames the distance to targets calls for ("triggered by the distance to the two
// balls", figure 21 a), or a parameter of the request.
#include "server/blocks/compilation.h"

namespace tessera {

namespace {

constexpr std::size_t max_target_laws = 64;  // Each looks at all targets
__extension__ using Wide = __int128;

constexpr std::uint32_t max_far_texels = 1u << 28;

Result<void> check_driven(Compilation& c, std::size_t block, const proto::AnimationMap& message) {
    const bool by_request = message.has_request_parameter();
    const auto unknown = [&](const char* field) {
        return c.error(block, field,
                       std::string{"is for animations that the clock drives; this one follows "} +
                           (by_request ? "the request's parameter" : "targets") + ": leave it out");
    };
    if (message.has_phase()) return unknown(".phase");
    if (message.has_rest()) return unknown(".rest");
    if (message.has_density()) return unknown(".density");
    if (message.changes_size() > 0) return unknown(".changes");
    if (by_request) return {};
    const proto::TargetDistance& law = message.target_distance();
    if (law.far_texels() > max_far_texels)
        return c.error(block, ".target_distance.far_texels",
                       "is " + std::to_string(law.far_texels()) + "; at most 2^28");
    if (law.near_texels() >= law.far_texels())
        return c.error(block, ".target_distance.near_texels",
                       "is " + std::to_string(law.near_texels()) + "; below far_texels, which is " +
                           std::to_string(law.far_texels()));
    if (c.plan.target_laws.size() >= max_target_laws)
        return c.error(
            block, ".target_distance",
            "is one of more than " + std::to_string(max_target_laws) + "; let textures share animation maps");
    return {};
}

}  // namespace

Result<void> compile_driven_animation(Compilation& c, std::size_t block) {
    const proto::AnimationMap& message = c.graph.blocks[block].message->animation_map();
    if (auto checked = check_driven(c, block, message); !checked) return checked;
    const auto& frames = c.blocks[c.named(message.sequence())].frames;
    CellNode node;
    node.least = frames->least;
    node.most = frames->most;
    node.steps = frames->patterns.size() > 1;
    if (!node.steps) node.least = node.most = frames->patterns.front();
    std::optional<std::size_t> law;
    if (!node.steps) {
        // It is folded
    } else if (message.has_request_parameter()) {
        // The least parameter of each frame
        const TimeLine& line = frames->line;
        for (std::int32_t frame = 0; frame < line.frames(); ++frame) {
            const auto first =
                static_cast<std::int32_t>((Wide{line.begin_of(frame)} * 65536 + line.run() - 1) / line.run());
            if (frame_of_parameter(line, first) == frame) c.plan.parameters.push_back(first);
        }
        c.notes[block] = "driven by requests";
    } else {
        law = c.plan.target_laws.size();
        c.plan.target_laws.push_back(
            {frames, message.target_distance().near_texels(), message.target_distance().far_texels()});
        c.notes[block] = "driven by targets";
    }
    node.driven = std::make_shared<const DrivenOp>(frames, law);
    node.op = node.driven;
    if (auto added = c.add_node(block, std::move(node)); !added) return added.error();
    return {};
}

}  // namespace tessera
