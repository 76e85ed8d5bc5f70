// Dithered Areas Map (3.2, figures 8 and 9). The paper draws between the nodes around a cell as often as
// linear weights say. Adding a uniform jitter below the nodes' distance to the cell's corner, and taking the
// node to the left and above of where it falls, does exactly that with integers: of 2^c cells between two
// nodes, the one at column f moves over for f of 2^c jitters. In two dimensions the two jitters are 16 bits
// each of one draw.
#include <array>

#include "server/blocks/areas_map.h"
#include "server/blocks/kernels.h"
#include "server/blocks/map_field.h"
#include "server/blocks/map_rows.h"
#include "server/blocks/nested_thresholds.h"

namespace tessera {

namespace {

using Sampling = VaryingMap::Sampling;

/// Where a stretch lies between nodes. Along an axis that is not dithered, cells lie on their node.
struct Between {
    std::int64_t node_x, node_y;  ///< Left of and above the first cell.
    std::uint32_t column, row;    ///< Cells from there, below 2^cells_log2.
};

class DitherOp : public CellOp {
  public:
    DitherOp(std::shared_ptr<const StoredMap> map, Sampling sampling, std::uint64_t base)
        : map_{std::move(map)}, sampling_{sampling}, base_{base} {}
    std::size_t memory_bytes() const noexcept override { return map_->values.memory_bytes(); }

  protected:
    Between between(std::int64_t x, std::int64_t y) const noexcept {
        const int log2 = map_->cells_log2;
        const std::int64_t mask = (std::int64_t{1} << log2) - 1;
        return {(x - map_->x) >> log2, (y - map_->y) >> log2,
                sampling_ == Sampling::dithered_y ? 0u : static_cast<std::uint32_t>((x - map_->x) & mask),
                sampling_ == Sampling::dithered_x ? 0u : static_cast<std::uint32_t>((y - map_->y) & mask)};
    }

    std::shared_ptr<const StoredMap> map_;
    Sampling sampling_;
    std::uint64_t base_;
};

class JitterOp final : public DitherOp {
  public:
    JitterOp(std::shared_ptr<const StoredMap> map, Sampling sampling, std::uint64_t base)
        : DitherOp{std::move(map), sampling, base}, kernels_{block_kernels()} {}

    bool scatters() const noexcept override { return false; }
    void run(const Stretch& stretch, const std::int32_t* const*, std::int32_t* out) const override {
        constexpr std::int64_t mask = (std::int64_t{1} << row_log2) - 1;
        for (std::int32_t done = 0; done < stretch.count;) {
            const std::int64_t x = stretch.x + done;
            const auto run = static_cast<std::int32_t>(
                std::min<std::int64_t>(stretch.count - done, mask + 1 - (x & mask)));
            run_row(x, stretch.y, run, row_key(base_, x, stretch.y, stretch.z), out + done);
            done += run;
        }
    }

  private:
    static constexpr int close_log2 = 4;  ///< Up to here runs between nodes are too short to be worth it.

    void run_row(std::int64_t x, std::int64_t y, std::int32_t cells, RowKey key, std::int32_t* out) const {
        const int log2 = map_->cells_log2;
        const std::int32_t side = std::int32_t{1} << log2;
        const Between first = between(x, y);
        const std::uint32_t offset = static_cast<std::uint32_t>((x - map_->x) & (side - 1));
        const auto nodes =
            static_cast<std::int32_t>((offset + static_cast<std::uint32_t>(cells) - 1) >> log2) + 2;
        constexpr std::int32_t below = stretch_cells + max_reach + 2;
        std::int32_t top[2 * below], *const bottom = top + below;
        read_entries(*map_, first.node_x, first.node_y, nodes, top);
        if (first.row != 0)
            read_entries(*map_, first.node_x, first.node_y + 1, nodes, bottom);
        else
            std::copy_n(top, nodes, bottom);
        const std::uint32_t down = (static_cast<std::uint32_t>(side) - first.row) << (16 - log2);
        BlockKernels::DitherRun run{
            key, static_cast<std::uint32_t>(x & ((1 << row_log2) - 1)), cells, log2, offset, down, {}};
        const bool across = sampling_ != Sampling::dithered_y;
        if (log2 <= close_log2 && across) return kernels_.dither_close(run, top, below, out);

        std::uint32_t column = offset;
        for (std::int32_t done = 0, node = 0; done < cells; ++node) {
            const std::int32_t count = std::min(cells - done, side - static_cast<std::int32_t>(column));
            const std::int32_t right = across ? node + 1 : node;
            const std::int32_t around[4] = {top[node], top[right], bottom[node], bottom[right]};
            if (around[0] == around[1] && around[0] == around[2] && around[0] == around[3]) {
                // No draw can matter
                std::fill_n(out + done, count, around[0]);
            } else {
                std::copy_n(around, 4, run.nodes);
                run.cells = count;
                run.column = column;
                kernels_.dither(run, out + done);
            }
            run.x += static_cast<std::uint32_t>(count);
            done += count;
            column = 0;
        }
    }

    const BlockKernels& kernels_;
};

/// One threshold against the four cumulative weights.
class NestedDitherOp final : public DitherOp {
  public:
    using DitherOp::DitherOp;

    bool scatters() const noexcept override { return false; }
    void run(const Stretch& stretch, const std::int32_t* const*, std::int32_t* out) const override {
        // Weights are of side² in all: no digit behind log2 can matter
        const int log2 = map_->cells_log2;
        std::uint32_t thresholds[stretch_cells + max_reach];
        NestedThresholds{base_, stretch.z}.row(stretch.x, stretch.y, stretch.count, thresholds, log2);
        const Between at = between(stretch.x, stretch.y);
        const auto column =
            static_cast<std::int32_t>((stretch.x - map_->x) & ((std::int64_t{1} << log2) - 1));
        const std::int32_t nodes = ((column + stretch.count - 1) >> log2) + 2;
        constexpr std::int32_t below = stretch_cells + max_reach + 2;
        std::int32_t top[2 * below];
        read_entries(*map_, at.node_x, at.node_y, nodes, top);
        read_entries(*map_, at.node_x, at.node_y + 1, nodes, top + below);
        block_kernels().dither_nested({stretch.count, log2, column, static_cast<std::int32_t>(at.row),
                                       sampling_ != Sampling::dithered_y},
                                      thresholds, top, below, out);
    }
};

}  // namespace

Result<void> compile_dithered_areas_map(Compilation& c, std::size_t block) {
    const proto::DitheredAreasMap& message = c.graph.blocks[block].message->dithered_areas_map();
    Sampling sampling = Sampling::dithered;
    switch (message.axes()) {
        case proto::DitheredAreasMap::both:
            break;
        case proto::DitheredAreasMap::x_only:
            sampling = Sampling::dithered_x;
            break;
        case proto::DitheredAreasMap::y_only:
            sampling = Sampling::dithered_y;
            break;
        default:
            return c.error(block, ".axes",
                           "is " + std::to_string(message.axes()) + "; both, x_only or y_only");
    }
    const Generator generator = message.generator();
    if (generator != proto::Draw::automatic && generator != proto::Draw::independent &&
        generator != proto::Draw::nested)
        return c.error(block, ".generator",
                       "is " +
                           (proto::Draw::Generator_IsValid(generator) ? proto::Draw::Generator_Name(generator)
                                                                      : std::to_string(generator)) +
                           "; independent or nested: what a dithered map draws varies over the plane");
    if (message.areas().edge() == proto::ExplicitMap::blank)
        return c.error(block, ".areas.edge", "is blank; wrap or clamp, so that there is a node on each side");
    auto map = read_explicit_map(c, block, ".areas", message.areas());
    if (!map) return map.error();

    CellNode node;
    node.grid = c.named(message.areas().grid());
    std::tie(node.least, node.most) = map_range(**map);
    const bool nested = generator == proto::Draw::nested;
    c.notes[block] = map_note(**map) + (nested ? ", nested" : ", independent");
    const std::uint64_t key = c.stream_key(block, message.stream(), node.grid);
    if ((*map)->cells_log2 == 0) {
        // A node at every cell: there is nothing between
        node.op = make_map_op(*map);
        node.map = CellMap{std::move(*map)};
    } else {
        const std::uint64_t base = stream_base(c.seed, key);
        if (nested)
            node.op = std::make_shared<NestedDitherOp>(*map, sampling, base);
        else
            node.op = std::make_shared<JitterOp>(*map, sampling, base);
        node.map = CellMap{std::move(*map), sampling, nested, key};
    }
    if (auto added = c.add_node(block, std::move(node)); !added) return added.error();
    return {};
}

}  // namespace tessera
