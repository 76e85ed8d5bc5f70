// Areas Map (3.2): which material is where. "Each cell covers an area of several tiles."
#include "server/blocks/areas_map.h"

#include "server/blocks/map_field.h"
#include "server/blocks/map_rows.h"

namespace tessera {

namespace {

class MapOp final : public CellOp {
  public:
    explicit MapOp(std::shared_ptr<const StoredMap> map) : map_{std::move(map)} {}

    void run(const Stretch& stretch, const std::int32_t* const*, std::int32_t* out) const override {
        const int log2 = map_->cells_log2;
        if (const CellAt* at = stretch.scattered) {
            for (std::int32_t i = 0; i < stretch.count; ++i, ++at)
                out[i] = map_->entry((at->x - map_->x) >> log2, (at->y - map_->y) >> log2);
            return;
        }
        const std::int64_t column = stretch.x - map_->x, row = (stretch.y - map_->y) >> log2;
        if (log2 == 0) return read_entries(*map_, column, row, stretch.count, out);
        // One entry a run of cells
        const std::int64_t mask = (std::int64_t{1} << log2) - 1;
        for (std::int32_t done = 0; done < stretch.count;) {
            const std::int64_t at = column + done;
            const auto run = static_cast<std::int32_t>(
                std::min<std::int64_t>(stretch.count - done, mask + 1 - (at & mask)));
            std::fill_n(out + done, run, map_->entry(at >> log2, row));
            done += run;
        }
    }
    std::size_t memory_bytes() const noexcept override { return map_->values.memory_bytes(); }

  private:
    std::shared_ptr<const StoredMap> map_;
};

}  // namespace

std::shared_ptr<const CellOp> make_map_op(std::shared_ptr<const StoredMap> map) {
    return std::make_shared<MapOp>(std::move(map));
}

std::string map_note(const StoredMap& map) {
    return std::to_string(map.width) + " × " + std::to_string(map.height) + " entries of " +
           std::to_string(std::int64_t{1} << map.cells_log2) + " cells";
}

Result<void> compile_map(Compilation& c, std::size_t block, const proto::ExplicitMap& message) {
    auto map = read_explicit_map(c, block, "", message);
    if (!map) return map.error();
    CellNode node;
    node.grid = c.named(message.grid());
    std::tie(node.least, node.most) = map_range(**map);
    node.op = make_map_op(*map);
    c.notes[block] = map_note(**map);
    node.map = CellMap{std::move(*map)};
    if (auto added = c.add_node(block, std::move(node)); !added) return added.error();
    return {};
}

Result<void> compile_areas_map(Compilation& c, std::size_t block) {
    return compile_map(c, block, c.graph.blocks[block].message->areas_map());
}

}  // namespace tessera
