// Materials Map (3.2): "considering a set of materials, a material map allows the user to access a material
// using an index"; a material is a probability map.
#include <numeric>

#include "server/blocks/material_lists.h"

namespace tessera {

namespace {

class MaterialsOp final : public CellOp {
  public:
    explicit MaterialsOp(ListTable table) : table_{std::move(table)} {}
    void run(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const override {
        table_.look_up(in[0], in[1], stretch.count, out);
    }
    std::size_t memory_bytes() const noexcept override { return table_.memory_bytes(); }

  private:
    ListTable table_;
};

}  // namespace

Result<void> compile_materials_map(Compilation& c, std::size_t block) {
    const proto::MaterialsMap& message = c.graph.blocks[block].message->materials_map();
    if (message.materials().empty() || message.materials_size() > 256)
        return c.error(block, ".materials",
                       "lists " + std::to_string(message.materials_size()) + " materials; from 1 to 256");
    std::vector<MaterialList> lists;
    for (int i = 0; i < message.materials_size(); ++i) {
        auto list = read_material(c, block, ".materials[" + std::to_string(i) + "]", message.materials(i));
        if (!list) return list.error();
        lists.push_back(std::move(*list));
    }
    const auto material = c.integer(block, ".material", message.material(), 0);
    if (!material) return material.error();
    const auto index = c.integer(block, ".index", message.index(), 0);
    if (!index) return index.error();
    const CellNode& chosen = c.nodes[*material];
    if (chosen.least < 0 || static_cast<std::size_t>(chosen.most) >= lists.size())
        return c.error(block, ".material",
                       range_text(chosen) + "; materials are from 0 to " + std::to_string(lists.size() - 1));
    if (chosen.constant())
        return add_single_list(c, block, std::move(lists[static_cast<std::size_t>(chosen.least)]), *index);

    std::vector<std::size_t> all(lists.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    const auto picked = read_list_index(c, block, *index, lists, all);
    if (!picked) return picked.error();
    CellNode node;
    node.inputs = {*material, *index};
    set_range(node, lists, all);
    c.notes[block] = std::to_string(lists.size()) + " materials";
    node.op = std::make_shared<MaterialsOp>(ListTable{c, std::move(lists), std::move(all), *picked});
    if (auto added = c.add_node(block, std::move(node)); !added) return added.error();
    return {};
}

}  // namespace tessera
