#include "server/blocks/material_lists.h"

#include <algorithm>

#include "server/blocks/kernels.h"

namespace tessera {

namespace {

constexpr std::uint32_t max_total = 65536;

class SingleListOp final : public CellOp {
  public:
    explicit SingleListOp(ListTable table) : table_{std::move(table)} {}
    void run(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const override {
        table_.look_up(in[0], stretch.count, out);
    }
    std::size_t memory_bytes() const noexcept override { return table_.memory_bytes(); }

  private:
    ListTable table_;
};

}  // namespace

std::int32_t MaterialList::entry(std::uint32_t i) const noexcept {
    return patterns[static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), i) - ends.begin())];
}

Result<MaterialList> read_material(Compilation& c, std::size_t block, std::string_view field,
                                   const proto::Material& message) {
    MaterialList list;
    std::uint64_t total = 0;
    for (int i = 0; i < message.entries_size(); ++i) {
        const proto::Material::Entry& entry = message.entries(i);
        const std::string path = std::string{field} + ".entries[" + std::to_string(i) + "]";
        if (entry.pattern() < -1)
            return c.error(
                block, path + ".pattern",
                "is " + std::to_string(entry.pattern()) + "; a pattern from 0 on, or -1 for blank");
        const std::uint32_t weight = entry.has_weight() ? entry.weight() : 1;
        if (weight == 0) continue;
        total += weight;
        if (total > max_total)
            return c.error(block, path + ".weight",
                           "brings the sum of weights to " + std::to_string(total) + "; at most 65536");
        list.patterns.push_back(entry.pattern());
        list.ends.push_back(static_cast<std::uint32_t>(total));
    }
    if (total == 0)
        return c.error(block, field,
                       message.entries().empty() ? "lists no entry; give at least one pattern"
                                                 : "has the weight 0 everywhere; give one entry a weight");
    list.total = static_cast<std::uint32_t>(total);
    return list;
}

Result<ListIndex> read_list_index(Compilation& c, std::size_t block, std::size_t index,
                                  const std::vector<MaterialList>& lists,
                                  const std::vector<std::size_t>& used) {
    const CellNode& node = c.nodes[index];
    if (node.draw) return ListIndex{node.draw->count, node.draw->count - 1};
    std::uint32_t least_total = max_total;
    for (const std::size_t list : used) least_total = std::min(least_total, lists[list].total);
    if (node.least < 0 || static_cast<std::uint32_t>(node.most) >= least_total)
        return c.error(block, ".index",
                       range_text(node) + ", but the material lists " + std::to_string(least_total) +
                           " entries; give integers from 0 to " + std::to_string(least_total - 1) +
                           ", or a virtual_indirection_map");
    return ListIndex{0, static_cast<std::uint32_t>(node.most)};
}

ListTable::ListTable(Compilation& c, std::vector<MaterialList> lists, std::vector<std::size_t> list_of_code,
                     ListIndex index)
    : lists_{std::move(lists)},
      list_of_code_{std::move(list_of_code)},
      index_{index},
      stride_{static_cast<std::int32_t>(index.most + 1)} {
    const std::size_t size = list_of_code_.size() * static_cast<std::size_t>(stride_);
    if (size > c.table_room || size > std::size_t{1} << 22) return;
    c.table_room -= size;
    table_.assign(size, -1);
    for (std::size_t code = 0; code < list_of_code_.size(); ++code) {
        if (list_of_code_[code] == no_block) continue;
        const MaterialList& list = lists_[list_of_code_[code]];
        for (std::uint32_t i = 0; i <= index_.most; ++i)
            table_[code * static_cast<std::size_t>(stride_) + i] = list.entry(index_.entry(i, list.total));
    }
}

void ListTable::look_up(const std::int32_t* codes, const std::int32_t* indices, std::int32_t cells,
                        std::int32_t* out) const {
    if (!table_.empty())
        return block_kernels().look_up_pairs(table_.data(), static_cast<std::int32_t>(table_.size()), stride_,
                                             codes, indices, cells, out);
    for (std::int32_t i = 0; i < cells; ++i) {
        const MaterialList& list = lists_[list_of_code_[static_cast<std::size_t>(codes[i])]];
        out[i] = list.entry(index_.entry(static_cast<std::uint32_t>(indices[i]), list.total));
    }
}

void ListTable::look_up(const std::int32_t* indices, std::int32_t cells, std::int32_t* out) const {
    if (!table_.empty())
        return block_kernels().look_up(table_.data(), static_cast<std::int32_t>(table_.size()), indices,
                                       cells, out);
    const MaterialList& list = lists_.front();
    for (std::int32_t i = 0; i < cells; ++i)
        out[i] = list.entry(index_.entry(static_cast<std::uint32_t>(indices[i]), list.total));
}

std::size_t ListTable::memory_bytes() const noexcept {
    std::size_t bytes = table_.size() * sizeof table_[0] + list_of_code_.size() * sizeof list_of_code_[0];
    for (const MaterialList& list : lists_) bytes += list.patterns.size() * 8;
    return bytes;
}

void set_range(CellNode& node, const std::vector<MaterialList>& lists, const std::vector<std::size_t>& used) {
    node.least = 0x7fffffff;
    node.most = -1;
    for (const std::size_t list : used) {
        const auto [least, most] =
            std::minmax_element(lists[list].patterns.begin(), lists[list].patterns.end());
        node.least = std::min(node.least, *least);
        node.most = std::max(node.most, *most);
    }
}

Result<void> add_single_list(Compilation& c, std::size_t block, MaterialList list, std::size_t index) {
    std::vector<MaterialList> lists;
    lists.push_back(std::move(list));
    const auto picked = read_list_index(c, block, index, lists, {0});
    if (!picked) return picked.error();
    CellNode node;
    node.inputs = {index};
    set_range(node, lists, {0});
    if (picked->draws != 0)
        c.notes[block] = std::to_string(lists[0].total) + " entries, drawn from " +
                         std::to_string(picked->draws) +
                         (picked->draws % lists[0].total == 0 ? "" : ": some entries more often than others");
    node.op = std::make_shared<SingleListOp>(ListTable{c, std::move(lists), {0}, *picked});
    if (auto added = c.add_node(block, std::move(node)); !added) return added.error();
    return {};
}

}  // namespace tessera
