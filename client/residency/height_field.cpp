#include "client/residency/height_field.h"

#include <utility>

#include "shared/math/hash.h"

namespace tessera {
namespace {

constexpr int shortest_log2 = 10, longest_log2 = 20;
constexpr int steepest_log2 = 13;
static_assert(made_height_shortest == std::int64_t{1} << shortest_log2);

/// 3t² − 2t³ of 0 to 65536, as 0 to 65536.
std::int64_t smooth(std::int64_t t) { return (t * t >> 16) * (3 * 65536 - 2 * t) >> 16; }

/// Noise of one size: 0 to 65535, smooth between a lattice's points.
std::int64_t hill(std::int64_t x, std::int64_t y, int size_log2) {
    const std::int64_t column = x >> size_log2, row = y >> size_log2;
    const auto within = [&](std::int64_t at, std::int64_t cell) {
        return smooth((at - (cell << size_log2)) << 16 >> size_log2);
    };
    const std::int64_t across = within(x, column), down = within(y, row);
    const auto corner = [&](std::int64_t dx, std::int64_t dy) {
        return static_cast<std::int64_t>(
            hash(7, stream("hills", static_cast<std::uint64_t>(size_log2)), column + dx, row + dy) >> 48);
    };
    const auto mix = [](std::int64_t a, std::int64_t b, std::int64_t t) { return a + ((b - a) * t >> 16); };
    return mix(mix(corner(0, 0), corner(1, 0), across), mix(corner(0, 1), corner(1, 1), across), down);
}

/// Of a row of so many pixels and its mirror image, over and over.
std::int32_t mirrored(std::int64_t at, std::int32_t pixels) {
    const std::int64_t period = 2 * (std::int64_t{pixels} - 1);
    const std::int64_t within = ((at % period) + period) % period;
    return static_cast<std::int32_t>(within < pixels ? within : period - within);
}

}  // namespace

HeightImage::HeightImage(std::int32_t width, std::int32_t height, std::vector<std::uint16_t> codes)
    : width_{width}, height_{height}, codes_{std::move(codes)} {}

double HeightImage::at(std::int64_t x, std::int64_t y) const {
    constexpr int spacing_log2 = 8;
    static_assert(spacing_texels == 1 << spacing_log2);
    const std::int64_t column = x >> spacing_log2, row = y >> spacing_log2;
    const auto part = [](std::int64_t at) {
        return static_cast<double>(at & (spacing_texels - 1)) / static_cast<double>(spacing_texels);
    };
    const auto code = [&](std::int64_t dx, std::int64_t dy) {
        const auto at =
            static_cast<std::size_t>(mirrored(row + dy, height_)) * static_cast<std::size_t>(width_) +
            static_cast<std::size_t>(mirrored(column + dx, width_));
        return static_cast<double>(codes_[at]);
    };
    const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
    return mix(mix(code(0, 0), code(1, 0), part(x)), mix(code(0, 1), code(1, 1), part(x)), part(y));
}

std::int64_t made_height(std::int64_t x, std::int64_t y, std::int64_t spacing) {
    std::int64_t height = 0;
    for (int size = shortest_log2; size <= longest_log2; ++size) {
        if (std::int64_t{1} << size < 4 * spacing) continue;
        // Larger hills are higher, and gentler
        std::int64_t scale = std::int64_t{200} << (size - shortest_log2);
        for (int doubled = steepest_log2; doubled < size; ++doubled) scale -= scale / 4;
        height += hill(x, y, size) * scale >> 10;
    }
    return height;
}

}  // namespace tessera
