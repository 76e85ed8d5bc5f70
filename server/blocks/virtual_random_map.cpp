// Virtual Random Map (3.2): "we consider the result of σ as a random number in [0, 1[ … this provides
// quantized values". Here both ends are included.
#include <cmath>

#include "server/blocks/draw_field.h"

namespace tessera {

namespace {

/// from + ⌊(to − from)·draw / (levels − 1)⌉
class SpreadOp final : public CellOp {
  public:
    SpreadOp(std::int32_t from, std::int32_t to, std::uint32_t levels)
        : from_{from}, span_{std::int64_t{to} - from}, last_{levels - 1} {
        if (levels > table_levels) return;
        for (std::uint32_t i = 0; i < levels; ++i) table_.push_back(value(i));
    }
    void run(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const override {
        const std::int32_t* draws = in[0];
        if (!table_.empty())
            for (std::int32_t i = 0; i < stretch.count; ++i)
                out[i] = table_[static_cast<std::size_t>(draws[i])];
        else
            for (std::int32_t i = 0; i < stretch.count; ++i) out[i] = value(draws[i]);
    }
    std::size_t memory_bytes() const noexcept override { return table_.size() * sizeof(std::int32_t); }

  private:
    static constexpr std::uint32_t table_levels = 1024;

    std::int32_t value(std::int64_t draw) const noexcept {
        const std::int64_t twice = 2 * span_ * draw + last_;
        const std::int64_t whole = twice / (2 * last_);
        return static_cast<std::int32_t>(from_ + (twice % (2 * last_) < 0 ? whole - 1 : whole));
    }

    std::int64_t from_, span_, last_;
    std::vector<std::int32_t> table_;
};

}  // namespace

Result<void> compile_virtual_random_map(Compilation& c, std::size_t block) {
    const proto::VirtualRandomMap& message = c.graph.blocks[block].message->virtual_random_map();
    const auto in_range = [](double value) { return value >= -32767 && value <= 32767; };
    if (!in_range(message.from()))
        return c.error(block, ".from",
                       "is " + number_text(message.from()) + "; a number from -32767 to 32767");
    if (!in_range(message.to()))
        return c.error(block, ".to", "is " + number_text(message.to()) + "; a number from -32767 to 32767");
    const double from = message.from();
    const double to = message.from() == 0 && message.to() == 0 ? 1 : message.to();
    const std::uint32_t levels = message.levels() == 0 ? 256 : message.levels();
    if (levels < 2 || levels > 65536)
        return c.error(block, ".levels",
                       "is " + std::to_string(levels) + "; from 2 to 65536, or unset for 256");

    auto draw = make_draw(c, block, c.named(message.grid()), message.generator(), message.stream(), levels);
    if (!draw) return draw.error();
    const auto drawn = c.add_node(block, std::move(*draw));
    if (!drawn) return drawn.error();
    CellNode node;
    node.number = true;
    node.inputs = {*drawn};
    node.least = std::min(to_number(from), to_number(to));
    node.most = std::max(to_number(from), to_number(to));
    node.op = std::make_shared<SpreadOp>(to_number(from), to_number(to), levels);
    c.notes[block] = "from " + number_text(from) + " to " + number_text(to);
    if (auto added = c.add_node(block, std::move(node)); !added) return added.error();
    return {};
}

}  // namespace tessera
