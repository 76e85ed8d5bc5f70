#include "server/pattern/node_tables.h"

#include <cstring>
#include <utility>

#include "server/texture/texture.h"
#include "shared/page/page_key.h"

namespace tessera {
namespace {

/// A texel as pages carry it, moved as one.
using Code = std::array<std::uint8_t, 4>;

std::vector<Code> encoded(const std::vector<float>& texels) {
    LinearImage linear;
    linear.width = static_cast<std::int32_t>(texels.size() / 4);
    linear.height = 1;
    linear.values = texels;
    Rgba8Image coded;
    encode(linear, coded);
    std::vector<Code> codes(texels.size() / 4);
    if (!codes.empty()) std::memcpy(codes.data(), coded.bytes.data(), coded.bytes.size());
    return codes;
}

std::vector<float> rounded(const std::vector<std::array<double, 4>>& colours) {
    std::vector<float> values;
    values.reserve(colours.size() * 4);
    for (const auto& colour : colours)
        for (const double channel : colour) values.push_back(static_cast<float>(channel));
    return values;
}

/// Images of 4×4 texels, one for each type of the nodes of `height`. The texels of child c of a node are the
/// 2×2 that `quarters` gives for its type: four codes, from the top left.
template <class Quarters>
std::vector<std::uint8_t> blocks_of(const TypedQuadtree& quadtree, int height, Quarters quarters) {
    std::vector<std::uint8_t> blocks(std::size_t{quadtree.types()} * 16 * sizeof(Code));
    for (std::uint32_t type = 0; type < quadtree.types(); ++type) {
        std::array<Code, 16> block;
        const auto& children = quadtree.children(height, static_cast<std::uint16_t>(type));
        for (std::size_t child = 0; child < 4; ++child) {
            const std::array<Code, 4> of_child = quarters(children[child]);
            for (std::size_t quarter = 0; quarter < 4; ++quarter)
                block[((child / 2) * 2 + quarter / 2) * 4 + (child % 2) * 2 + quarter % 2] =
                    of_child[quarter];
        }
        std::memcpy(&blocks[type * sizeof block], block.data(), sizeof block);
    }
    return blocks;
}

}  // namespace

CellNodeTables::CellNodeTables(const TypedQuadtree& quadtree, int cell_log2,
                               std::vector<std::array<double, 4>> means, std::vector<float> quarters)
    : cell_log2_{cell_log2}, quarters_{std::move(quarters)} {
    if (cell_log2 > 0) {
        const std::vector<Code> codes = encoded(quarters_);
        blocks_.push_back(blocks_of(quadtree, 1, [&](std::uint16_t type) {
            std::array<Code, 4> four;
            std::memcpy(four.data(), &codes[type * std::size_t{4}], sizeof four);
            return four;
        }));
    }
    for (int height = 0; height <= max_level - cell_log2; ++height) {
        if (height > 0) {
            // Sums of doubles in one order: the same everywhere, and exact where all four are equal
            std::vector<std::array<double, 4>> above(means.size());
            for (std::uint32_t type = 0; type < quadtree.types(); ++type) {
                const auto& child = quadtree.children(height, static_cast<std::uint16_t>(type));
                for (std::size_t channel = 0; channel < 4; ++channel)
                    above[type][channel] = (means[child[0]][channel] + means[child[1]][channel] +
                                            (means[child[2]][channel] + means[child[3]][channel])) /
                                           4;
            }
            means = std::move(above);
        }
        means_.push_back(rounded(means));
        const std::vector<Code> codes = encoded(means_.back());
        blocks_.push_back(blocks_of(quadtree, height + 2, [&](std::uint16_t type) {
            const auto& child = quadtree.children(height + 1, type);
            return std::array<Code, 4>{codes[child[0]], codes[child[1]], codes[child[2]], codes[child[3]]};
        }));
    }
}

CellNodeTables::Images<float> CellNodeTables::linear(int level) const noexcept {
    if (level < cell_log2_) return {quarters_.data(), 1, 0};
    return {means_[std::size_t(level - cell_log2_)].data(), 0, level - cell_log2_};
}

CellNodeTables::Images<std::uint8_t> CellNodeTables::codes(int level) const noexcept {
    return {blocks_[std::size_t(level - first_level())].data(), 2, level - cell_log2_ + 2};
}

std::size_t CellNodeTables::memory_bytes() const noexcept {
    std::size_t bytes = sizeof *this + quarters_.size() * sizeof(float);
    for (const auto& means : means_) bytes += means.size() * sizeof(float);
    for (const auto& blocks : blocks_) bytes += blocks.size();
    return bytes;
}

}  // namespace tessera
