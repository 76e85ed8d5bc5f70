#include "server/prepare/interchange_patch.h"

#include <algorithm>
#include <array>
#include <vector>

#include "server/prepare/graph_cut.h"
#include "server/prepare/seam.h"

namespace tessera {
namespace {

/// 256·e^(−u), u in 16ths.
constexpr auto falling = [] {
    std::array<std::int32_t, 96> table{};
    std::int64_t value = std::int64_t{256} << 32;
    for (std::int32_t& entry : table) {
        entry = static_cast<std::int32_t>((value + (std::int64_t{1} << 31)) >> 32);
        value = (value >> 16) * 61565;  // e^(−1/16) in 65536ths
    }
    return table;
}();

/// Both layers of a square, and a mark for each texel.
struct Square {
    std::int32_t side;
    std::vector<PerceptualColor> photo, tile;
    std::vector<std::uint8_t> marks;

    std::size_t index(std::int32_t x, std::int32_t y) const noexcept {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x);
    }
    std::uint32_t price(std::size_t s, std::size_t t) const noexcept {
        return seam_price(photo[s], photo[t], tile[s], tile[t]);
    }
};

Square layers_of(const PerceptualImage& photo, const QuiltedTile& tile, const PatchPlace& place) {
    const auto texels = static_cast<std::size_t>(place.side) * static_cast<std::size_t>(place.side);
    Square square{place.side, {}, {}, std::vector<std::uint8_t>(texels)};
    square.photo.reserve(texels);
    square.tile.reserve(texels);
    for (std::int32_t y = 0; y < place.side; ++y)
        for (std::int32_t x = 0; x < place.side; ++x) {
            square.photo.push_back(photo.at(place.at.x + x, place.at.y + y));
            square.tile.push_back(tile.color(place.x + x, place.y + y));
        }
    return square;
}

/// The prices of borders.
CutGrid grid_of(const Square& square) {
    const std::int32_t side = square.side;
    CutGrid grid{side, side};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const std::size_t i = grid.index(x, y);
            if (x + 1 < side) grid.right[i] = square.price(i, i + 1);
            if (y + 1 < side) grid.below[i] = square.price(i, i + static_cast<std::size_t>(side));
        }
    return grid;
}

bool on_rim(std::int32_t x, std::int32_t y, std::int32_t side) {
    return x == 0 || y == 0 || x == side - 1 || y == side - 1;
}

/// Marks what is reached from `start` over texels of `mark` with `to`.
void fill(Square& square, std::size_t start, std::uint8_t mark, std::uint8_t to) {
    const auto side = static_cast<std::size_t>(square.side);
    if (square.marks[start] != mark) return;
    std::vector<std::size_t> open{start};
    square.marks[start] = to;
    while (!open.empty()) {
        const std::size_t i = open.back();
        open.pop_back();
        const auto visit = [&](std::size_t next) {
            if (square.marks[next] != mark) return;
            square.marks[next] = to;
            open.push_back(next);
        };
        if (i % side != 0) visit(i - 1);
        if (i % side != side - 1) visit(i + 1);
        if (i >= side) visit(i - side);
        if (i + side < square.marks.size()) visit(i + side);
    }
}

enum Mark : std::uint8_t { off, on, piece, around };

/// What hangs together with `start`, and its holes filled: both only take borders away.
void keep_one_piece(Square& square, std::size_t start) {
    fill(square, start, on, piece);
    for (std::uint8_t& mark : square.marks)
        if (mark == on) mark = off;
    fill(square, 0, off, around);  // the rim is outside, and hangs together
    for (std::uint8_t& mark : square.marks) mark = mark == around ? off : on;
}

void take_marks(Square& square, const ShapeCut& cut) {
    for (std::int32_t y = 0; y < square.side; ++y)
        for (std::int32_t x = 0; x < square.side; ++x)
            square.marks[square.index(x, y)] = cut.shape.at(x, y) ? on : off;
}

/// The patch that is marked: its box, and what its border costs.
InterchangePatch patch_of(const Square& square, const PatchPlace& place, std::int32_t tile_side) {
    const std::int32_t side = square.side;
    InterchangePatch patch;
    std::int32_t left = side, top = side, right = 0, bottom = 0;
    std::uint64_t sum = 0, steps = 0, pairs = 0;
    const auto border = [&](std::size_t s, std::size_t t) {
        if (square.marks[s] == square.marks[t]) return;
        const std::uint32_t price = square.price(s, t);
        patch.worst = std::max(patch.worst, price);
        sum += price;
        steps += square.marks[s] == on ? distance(square.photo[s], square.tile[t])
                                       : distance(square.photo[t], square.tile[s]);
        ++pairs;
    };
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const std::size_t i = square.index(x, y);
            if (x + 1 < side) border(i, i + 1);
            if (y + 1 < side) border(i, i + static_cast<std::size_t>(side));
            if (square.marks[i] != on) continue;
            ++patch.texels;
            left = std::min(left, x);
            right = std::max(right, x + 1);
            top = std::min(top, y);
            bottom = std::max(bottom, y + 1);
        }
    if (patch.texels == 0) return patch;
    patch.mean = static_cast<std::uint32_t>(sum / std::max<std::uint64_t>(pairs, 1));
    patch.gradient = static_cast<std::uint32_t>(steps / std::max<std::uint64_t>(pairs, 1));
    patch.x = place.x + left;
    patch.y = place.y + top;
    patch.width = right - left;
    patch.height = bottom - top;
    patch.at = {place.at.x + left, place.at.y + top};
    patch.shape = BitMask{patch.width, patch.height};
    for (std::int32_t y = top; y < bottom; ++y)
        for (std::int32_t x = left; x < right; ++x)
            if (square.marks[square.index(x, y)] == on) {
                patch.shape.set(x - left, y - top);
                patch.in_rhombus &= in_rhombus(place.x + x, place.y + y, tile_side);
            }
    return patch;
}

}  // namespace

std::int32_t bell(std::int32_t x, std::int32_t y, std::int32_t side) noexcept {
    const std::int64_t across = 2 * x + 1 - side, down = 2 * y + 1 - side;
    // ln 2 = 11.09 / 16 at the squared radius (3/4 side)², in half texels
    const std::int64_t u = (across * across + down * down) * 1109 * 16 / (900 * std::int64_t{side} * side);
    return falling[static_cast<std::size_t>(std::min<std::int64_t>(u, std::ssize(falling) - 1))];
}

SquareMarks suggested_shape(const PerceptualImage& photo, const QuiltedTile& tile, const SquareMarks& free,
                            const PatchPlace& place) {
    Square square = layers_of(photo, tile, place);
    CutGrid grid = grid_of(square);
    const std::int32_t side = square.side, margin = (side - place.core) / 2;
    const auto pulled = [&](std::int32_t by) {
        return static_cast<std::uint32_t>(std::uint64_t{place.pull} * static_cast<std::uint64_t>(by) / 128);
    };
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const std::size_t i = grid.index(x, y);
            const std::int32_t height = bell(x - margin, y - margin, place.core);
            if (on_rim(x, y, side) || free[i] == 0)
                grid.inside[i] = CutGrid::must;
            else if (height >= 240)
                grid.outside[i] = CutGrid::must;
            else if (height > 128)
                grid.outside[i] = pulled(height - 128);
            else
                grid.inside[i] = pulled(128 - height);
        }
    take_marks(square, cheapest_shape(grid));
    keep_one_piece(square, square.index(side / 2, side / 2));
    return std::move(square.marks);
}

std::vector<std::int32_t> depths(const SquareMarks& marks, std::int32_t side) {
    std::vector<std::int32_t> depth(marks.size());
    const auto at = [&](std::int32_t x, std::int32_t y) {
        if (x < 0 || y < 0 || x >= side || y >= side) return 0;
        return depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
                     static_cast<std::size_t>(x)];
    };
    for (const std::int32_t way : {1, -1}) {
        for (std::int32_t v = 0; v < side; ++v)
            for (std::int32_t u = 0; u < side; ++u) {
                const std::int32_t x = way > 0 ? u : side - 1 - u, y = way > 0 ? v : side - 1 - v;
                const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
                               static_cast<std::size_t>(x);
                if (marks[i] == 0) continue;
                const std::int32_t straight = std::min(at(x - way, y), at(x, y - way)) + 3;
                const std::int32_t slanted = std::min(at(x - way, y - way), at(x + way, y - way)) + 4;
                const std::int32_t here = std::min(straight, slanted);
                depth[i] = way > 0 ? here : std::min(depth[i], here);
            }
    }
    return depth;
}

InterchangePatch cut_patch(const PerceptualImage& photo, const QuiltedTile& tile, const SquareMarks& region,
                           const PatchPlace& place) {
    Square square = layers_of(photo, tile, place);
    CutGrid grid = grid_of(square);
    const std::vector<std::int32_t> depth = depths(region, square.side);
    const auto deepest = std::max_element(depth.begin(), depth.end());
    if (*deepest == 0) return {};
    for (std::size_t i = 0; i < depth.size(); ++i) {
        if (depth[i] == 0)
            grid.inside[i] = CutGrid::must;
        else if (depth[i] * 4 >= *deepest * 3)
            grid.outside[i] = CutGrid::must;
        else
            grid.outside[i] = place.pull * static_cast<std::uint32_t>(std::min(depth[i], 24)) / 12;
    }
    const ShapeCut cut = cheapest_shape(grid);
    take_marks(square, cut);
    keep_one_piece(square, static_cast<std::size_t>(deepest - depth.begin()));
    InterchangePatch patch = patch_of(square, place, tile.side);
    patch.cost = cut.cost;
    return patch;
}

}  // namespace tessera
