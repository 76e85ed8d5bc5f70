// Transition Tiles (3.3, figure 11): "the transition tile is chosen by looking at the material of the
// neighboring cells. A transition texture dealing with m families of materials therefore contains m⁴
// transition tiles". The bordered variant is that of the section's end: one family with a transparent ground.
#include <bit>

#include "server/blocks/kernels.h"
#include "server/blocks/material_lists.h"

namespace tessera {

namespace {

class TransitionOp final : public CellOp {
  public:
    TransitionOp(ListTable table, int bits, std::int32_t family)
        : table_{std::move(table)}, bits_{bits}, family_{family}, kernels_{block_kernels()} {}

    void run(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const override {
        std::int32_t codes[stretch_cells + max_reach];
        if (family_ < 0) {
            kernels_.join_corners(in, bits_, stretch.count, codes);
        } else {
            for (std::int32_t i = 0; i < stretch.count; ++i)
                codes[i] = int{in[0][i] >= family_} | int{in[1][i] >= family_} << 1 |
                           int{in[2][i] >= family_} << 2 | int{in[3][i] >= family_} << 3;
        }
        table_.look_up(codes, in[4], stretch.count, out);
    }
    std::size_t memory_bytes() const noexcept override { return table_.memory_bytes(); }

  private:
    ListTable table_;
    int bits_;
    std::int32_t family_;
    const BlockKernels& kernels_;
};

std::string corners_text(std::size_t combination, std::size_t families) {
    std::string text;
    for (int i = 0; i < 4; ++i) {
        text += (i == 0 ? "" : ", ") + std::to_string(combination % families);
        combination /= families;
    }
    return text;
}

/// The list of each combination, the first corner changing fastest.
struct Combinations {
    std::vector<MaterialList> lists;
    std::vector<std::size_t> list_of;
};

Result<Combinations> read_combinations(Compilation& c, std::size_t block,
                                       const proto::TransitionTiles& message, std::size_t families) {
    Combinations read;
    read.list_of.assign(families * families * families * families, no_block);
    for (int i = 0; i < message.combinations_size(); ++i) {
        const proto::TransitionTiles::Combination& combination = message.combinations(i);
        const std::string field = ".combinations[" + std::to_string(i) + "]";
        if (combination.corners_size() != 4)
            return c.error(block, field + ".corners",
                           "lists " + std::to_string(combination.corners_size()) +
                               " corners; four: (i, j), (i+1, j), (i, j+1), (i+1, j+1)");
        std::size_t code = 0;
        for (int corner = 3; corner >= 0; --corner) {
            if (combination.corners(corner) >= families)
                return c.error(block, field + ".corners[" + std::to_string(corner) + "]",
                               "is " + std::to_string(combination.corners(corner)) + "; below " +
                                   std::to_string(families));
            code = code * families + combination.corners(corner);
        }
        if (read.list_of[code] != no_block)
            return c.error(block, field + ".corners",
                           "repeats " + corners_text(code, families) + " of combinations[" +
                               std::to_string(read.list_of[code]) + "]; list each once");
        auto list = read_material(c, block, field + ".patterns", combination.patterns());
        if (!list) return list.error();
        read.list_of[code] = read.lists.size();
        read.lists.push_back(std::move(*list));
    }
    std::size_t missing = 0, first = 0;
    for (std::size_t code = read.list_of.size(); code-- > 0;)
        if (read.list_of[code] == no_block) ++missing, first = code;
    if (missing != 0)
        return c.error(block, ".combinations",
                       "lacks the corners " + corners_text(first, families) +
                           (missing > 1 ? " and " + std::to_string(missing - 1) + " more" : std::string{}) +
                           "; list all " + std::to_string(read.list_of.size()) + " combinations");
    return read;
}

}  // namespace

Result<void> compile_transition_tiles(Compilation& c, std::size_t block) {
    const proto::TransitionTiles& message = c.graph.blocks[block].message->transition_tiles();
    if (message.families() < 2 || message.families() > 8)
        return c.error(block, ".families", "is " + std::to_string(message.families()) + "; from 2 to 8");
    const auto families = static_cast<std::int32_t>(message.families());
    if (message.has_family() && (message.family() < 1 || message.family() >= message.families()))
        return c.error(block, ".family",
                       "is " + std::to_string(message.family()) + "; from 1 to " +
                           std::to_string(families - 1) + ", below families");
    const std::size_t kinds = message.has_family() ? 2 : message.families();
    auto combinations = read_combinations(c, block, message, kinds);
    if (!combinations) return combinations.error();

    const auto material = c.integer(block, ".material", message.material(), 0);
    if (!material) return material.error();
    const auto index = c.integer(block, ".index", message.index(), 0);
    if (!index) return index.error();
    const CellNode& chosen = c.nodes[*material];
    if (chosen.least < 0 || chosen.most >= families)
        return c.error(block, ".material",
                       range_text(chosen) + "; families are from 0 to " + std::to_string(families - 1));
    const auto family = message.has_family() ? static_cast<std::int32_t>(message.family()) : -1;
    if (chosen.constant()) {
        // No transition anywhere: the plain tiles, "the block is a pass-through"
        const auto corner = static_cast<std::size_t>(family < 0 ? chosen.least : chosen.least >= family);
        const std::size_t plain = corner * (1 + kinds + kinds * kinds + kinds * kinds * kinds);
        return add_single_list(c, block, std::move(combinations->lists[combinations->list_of[plain]]),
                               *index);
    }

    // Codes of corners are bits side by side, so that joining them is shifts
    const int bits = static_cast<int>(std::bit_width(kinds - 1));
    std::vector<std::size_t> list_of_code(std::size_t{1} << (4 * bits), no_block), used;
    for (std::size_t i = 0; i < combinations->list_of.size(); ++i) {
        std::size_t rest = i, code = 0;
        for (int corner = 0; corner < 4; ++corner) {
            code |= (rest % kinds) << (corner * bits);
            rest /= kinds;
        }
        list_of_code[code] = combinations->list_of[i];
        used.push_back(combinations->list_of[i]);
    }
    const auto picked = read_list_index(c, block, *index, combinations->lists, used);
    if (!picked) return picked.error();
    CellNode node;
    node.corners = true;
    node.inputs = {*material, *index};
    set_range(node, combinations->lists, used);
    c.notes[block] = std::to_string(used.size()) + " combinations of four corners";
    node.op = std::make_shared<TransitionOp>(
        ListTable{c, std::move(combinations->lists), std::move(list_of_code), *picked}, bits, family);
    if (auto added = c.add_node(block, std::move(node)); !added) return added.error();
    return {};
}

}  // namespace tessera
