#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/blocks/compilation.h"

namespace tessera {

/// A material: patterns, each as often as its weight says. Entry i of `total` is the pattern whose `ends`
/// is the first above i.
struct MaterialList {
    std::vector<std::int32_t> patterns;
    std::vector<std::uint32_t> ends;
    std::uint32_t total = 0;

    std::int32_t entry(std::uint32_t i) const noexcept;
};

/// Checks a material. `field` is its path behind the block's.
Result<MaterialList> read_material(Compilation& c, std::size_t block, std::string_view field,
                                   const proto::Material& message);

/// How an index picks an entry: a draw below `count` is spread over the list, ⌊index·P / count⌋; any other
/// integer is the entry itself (count 0).
struct ListIndex {
    std::uint32_t draws = 0;
    std::uint32_t most = 0;

    std::uint32_t entry(std::uint32_t index, std::uint32_t total) const noexcept {
        return draws == 0 ? index : static_cast<std::uint32_t>(std::uint64_t{index} * total / draws);
    }
};

/// Checks that the node `index` picks an entry of each list in use, whatever it shows.
Result<ListIndex> read_list_index(Compilation& c, std::size_t block, std::size_t index,
                                  const std::vector<MaterialList>& lists,
                                  const std::vector<std::size_t>& used);

/// Lists by number, and the look-up table of (list, index), where there is room for it.
class ListTable {
  public:
    /// `list_of_code[code]` is the list of a code, no_block where a code does not occur.
    ListTable(Compilation& c, std::vector<MaterialList> lists, std::vector<std::size_t> list_of_code,
              ListIndex index);
    void look_up(const std::int32_t* codes, const std::int32_t* indices, std::int32_t cells,
                 std::int32_t* out) const;
    /// Where there is one list: by index alone.
    void look_up(const std::int32_t* indices, std::int32_t cells, std::int32_t* out) const;
    std::size_t memory_bytes() const noexcept;

  private:
    std::vector<MaterialList> lists_;
    std::vector<std::size_t> list_of_code_;
    ListIndex index_;
    std::int32_t stride_ = 0;
    std::vector<std::int32_t> table_;  ///< [code·stride + index]; empty where it would be too large.
};

/// The node of one list and an index: what a probability map is, and the others with a constant material.
Result<void> add_single_list(Compilation& c, std::size_t block, MaterialList list, std::size_t index);

/// Sets the node's range to what the lists in use show.
void set_range(CellNode& node, const std::vector<MaterialList>& lists, const std::vector<std::size_t>& used);

}  // namespace tessera
