#include "server/prepare/painted_patches.h"

#include <algorithm>
#include <array>
#include <map>
#include <string>

namespace tessera {
namespace {

/// A piece of the map as it was walked: without the torus' wraps, so that its extent is known.
struct Piece {
    std::int32_t left = 0, top = 0, right = 0, bottom = 0;
};

/// Marks all of the piece that holds texel (x, y) with `patch`.
Piece fill(const std::vector<std::uint16_t>& map, std::int32_t side, std::int32_t x, std::int32_t y,
           std::uint16_t patch, std::vector<std::int32_t>& patch_of) {
    struct Step {
        std::int32_t x, y;  ///< Unwrapped.
    };
    const std::int32_t mask = side - 1;
    const auto index = [&](std::int32_t u, std::int32_t v) {
        return std::size_t(v & mask) * std::size_t(side) + std::size_t(u & mask);
    };
    Piece piece{x, y, x, y};
    std::vector<Step> ahead{{x, y}};
    const std::uint16_t label = map[index(x, y)];
    patch_of[index(x, y)] = patch;
    for (std::size_t i = 0; i < ahead.size(); ++i) {
        const Step at = ahead[i];
        piece = {std::min(piece.left, at.x), std::min(piece.top, at.y), std::max(piece.right, at.x),
                 std::max(piece.bottom, at.y)};
        for (const Step next :
             {Step{at.x + 1, at.y}, Step{at.x - 1, at.y}, Step{at.x, at.y + 1}, Step{at.x, at.y - 1}})
            if (const std::size_t j = index(next.x, next.y); patch_of[j] < 0 && map[j] == label) {
                patch_of[j] = patch;
                ahead.push_back(next);
            }
    }
    return piece;
}

std::string place(std::int32_t x, std::int32_t y) {
    return "texel (" + std::to_string(x) + ", " + std::to_string(y) + ")";
}

}  // namespace

Result<Segmentation> painted_patches(const std::vector<std::uint16_t>& map, std::int32_t side) {
    Segmentation segmentation;
    std::map<std::uint16_t, std::string> first_place;
    std::vector<std::int32_t> patch_of(map.size(), -1);
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const std::size_t i = std::size_t(y) * std::size_t(side) + std::size_t(x);
            if (patch_of[i] >= 0) continue;
            const std::string label = "the patch map's label " + std::to_string(map[i]);
            const auto [seen, is_new] = first_place.emplace(map[i], place(x, y));
            if (!is_new)
                return Error{ErrorCode::invalid_input, label + " is in pieces, one at " + seen->second +
                                                           " and another at " + place(x, y) +
                                                           "; join them, or give each a grey of its own"};
            const Piece piece =
                fill(map, side, x, y, static_cast<std::uint16_t>(segmentation.patches.size()), patch_of);
            const std::int32_t width = piece.right - piece.left + 1, height = piece.bottom - piece.top + 1;
            if (std::max(width, height) > side / 2)
                return Error{ErrorCode::invalid_input,
                             label + " at " + place(x, y) + " is " + std::to_string(width) + "×" +
                                 std::to_string(height) + " texels; at most " + std::to_string(side / 2) +
                                 ", half the tile, so divide it"};
            ExchangeAsset::Patch patch;
            patch.x = piece.left & (side - 1);
            patch.y = piece.top & (side - 1);
            patch.width = width;
            patch.height = height;
            segmentation.patches.push_back(std::move(patch));
        }
    segmentation.labels.assign(patch_of.begin(), patch_of.end());
    return segmentation;
}

}  // namespace tessera
