#include "server/quality/pictures.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "server/quality/small_text.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

using Codes = std::array<std::uint8_t, 3>;

void put(Rgba8Image& image, std::int32_t x, std::int32_t y, const Codes& codes) {
    std::uint8_t* texel = image.row(y) + std::ptrdiff_t{4} * x;
    std::copy(codes.begin(), codes.end(), texel);
    texel[3] = 255;
}

Codes codes_at(const Rgb8Image& image, std::int32_t x, std::int32_t y) {
    const std::uint8_t* codes =
        image.bytes.data() + (std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * 3;
    return {codes[0], codes[1], codes[2]};
}

Codes mixed(const Codes& a, const Codes& b, double part_of_b) {
    Codes out;
    for (std::size_t c = 0; c < 3; ++c)
        out[c] = static_cast<std::uint8_t>(std::lround(a[c] * (1 - part_of_b) + b[c] * part_of_b));
    return out;
}

Codes grey_of(const Codes& codes, double scale) {
    const auto code =
        static_cast<std::uint8_t>(std::lround((0.3 * codes[0] + 0.6 * codes[1] + 0.1 * codes[2]) * scale));
    return {code, code, code};
}

/// Hues that lie apart for neighbouring numbers.
Codes hue(std::size_t number) {
    const double turn = std::fmod(double(number) * 0.618034, 1.0) * 6;
    Codes out;
    for (std::size_t c = 0; c < 3; ++c) {
        const double away = std::abs(std::fmod(turn + 6 - 2 * double(c), 6.0) - 3);
        out[c] = static_cast<std::uint8_t>(std::lround(60 + 195 * std::clamp(away - 1, 0.0, 1.0)));
    }
    return out;
}

}  // namespace

std::array<std::uint8_t, 3> heat(double value) noexcept {
    static constexpr std::array<std::array<double, 3>, 6> stops{
        {{8, 6, 20}, {70, 15, 105}, {165, 35, 95}, {232, 90, 45}, {250, 175, 50}, {252, 250, 180}}};
    const double at = std::clamp(value, 0.0, 1.0) * double(stops.size() - 1);
    const auto stop = std::min(static_cast<std::size_t>(at), stops.size() - 2);
    std::array<std::uint8_t, 3> out{};
    for (std::size_t c = 0; c < 3; ++c)
        out[c] = static_cast<std::uint8_t>(
            std::lround(stops[stop][c] + (stops[stop + 1][c] - stops[stop][c]) * (at - double(stop))));
    return out;
}

Rgba8Image tile_at_level(const Rgb8Image& tile, int level, std::int32_t least_side) {
    std::int32_t block = 1;
    while (level-- > 0 && block < tile.width) block *= 2;
    const std::int32_t side = tile.width / block;
    const std::int32_t wanted = std::max(side, (least_side + side - 1) / side * side);
    Rgba8Image out{wanted, wanted};
    const auto& codes = steps_to_srgb();
    const std::uint64_t texels = std::uint64_t(block) * std::uint64_t(block);
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            std::array<std::uint64_t, 3> sum{};
            for (std::int32_t v = 0; v < block; ++v)
                for (std::int32_t u = 0; u < block; ++u) {
                    const Codes texel = codes_at(tile, x * block + u, y * block + v);
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += srgb_to_steps[texel[c]];
                }
            Codes mean{};
            for (std::size_t c = 0; c < 3; ++c) mean[c] = codes[(sum[c] + texels / 2) / texels];
            for (std::int32_t v = y; v < wanted; v += side)
                for (std::int32_t u = x; u < wanted; u += side) put(out, u, v, mean);
        }
    return out;
}

Rgba8Image draw_patch_map(const ExchangeAsset& asset) {
    const std::int32_t side = asset.tile_side;
    Rgba8Image image{side, side};
    const auto label = [&](std::int32_t x, std::int32_t y) -> std::size_t {
        return asset.labels[std::size_t(y % side) * std::size_t(side) + std::size_t(x % side)];
    };
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const std::size_t here = label(x, y);
            const bool border = here != label(x + 1, y) || here != label(x, y + 1);
            put(image, x, y,
                border ? Codes{0, 0, 0} : mixed(grey_of(codes_at(asset.tile, x, y), 1), hue(here), 0.45));
        }
    // Each number where its patch is widest, at least along a row through its box's middle
    const std::int32_t scale = side >= 512 ? 2 : 1;
    for (std::size_t p = 0; p < asset.patches.size(); ++p) {
        const auto& patch = asset.patches[p];
        const std::int32_t y = (patch.y + patch.height / 2) % side;
        std::int32_t first = 0, last = -1;
        for (std::int32_t u = 0; u < patch.width; ++u)
            if (label(patch.x + u, y) == p) {
                if (last < 0) first = u;
                last = u;
            }
        const std::string number = std::to_string(p);
        const std::int32_t middle = (patch.x + (first + last) / 2) % side;
        draw_text_on_picture(
            image,
            std::clamp(middle - text_width(number, scale) / 2, 1,
                       std::max(1, side - text_width(number, scale))),
            std::clamp(y - letter_height * scale / 2, 1, std::max(1, side - letter_height * scale - 1)),
            number, scale);
    }
    return image;
}

Coverage draw_coverage(const ExchangeAsset& asset) {
    const std::int32_t side = asset.tile_side;
    std::vector<std::int32_t> counts(std::size_t(side) * std::size_t(side));
    Coverage coverage{Rgba8Image{side, side}, 0};
    for (const auto& patch : asset.patches)
        for (const auto& content : patch.contents)
            for (std::int32_t v = 0; v < patch.height; ++v)
                for (std::int32_t u = 0; u < patch.width; ++u) {
                    if (content.shape.width > 0 && !content.shape.at(u, v)) continue;
                    const std::int32_t x = (patch.x + u + side) % side, y = (patch.y + v + side) % side;
                    std::int32_t& count = counts[std::size_t(y) * std::size_t(side) + std::size_t(x)];
                    coverage.greatest = std::max(coverage.greatest, ++count);
                }
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            put(coverage.image, x, y,
                heat(double(counts[std::size_t(y) * std::size_t(side) + std::size_t(x)]) /
                     std::max(coverage.greatest, 1)));
    return coverage;
}

Rgba8Image draw_seam_energy(const ExchangeAsset& asset, const Seams& seams) {
    const std::int32_t side = asset.tile_side;
    Rgba8Image image{side, side};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            // Seams are a texel wide: each colours its neighbours too, the more, the oftener it is there
            double energy = 0, frequency = 0;
            for (std::int32_t v = -1; v <= 1; ++v)
                for (std::int32_t u = -1; u <= 1; ++u) {
                    const std::size_t at = std::size_t((y + v + side) % side) * std::size_t(side) +
                                           std::size_t((x + u + side) % side);
                    energy += double(seams.energy[at]) * double(seams.frequency[at]);
                    frequency += double(seams.frequency[at]);
                }
            const Codes ground = grey_of(codes_at(asset.tile, x, y), 0.35);
            const double mean = frequency > 0 ? energy / frequency : 0;
            put(image, x, y,
                mixed(ground, heat(0.15 + 0.85 * mean / seam_full_scale), std::min(1.0, frequency * 1.5)));
        }
    return image;
}

Rgba8Image draw_cells(const TileShare::Figure& figure, std::int32_t cells_a_side) {
    Rgba8Image image{cells_a_side, cells_a_side};
    for (std::int32_t y = 0; y < cells_a_side; ++y)
        for (std::int32_t x = 0; x < cells_a_side; ++x)
            put(image, x, y,
                heat(double(figure.cells[std::size_t(y) * std::size_t(cells_a_side) + std::size_t(x)])));
    return image;
}

Rgba8Image draw_mean_tile(const Repetition& repetition) {
    Rgba8Image image{repetition.mean_side, repetition.mean_side};
    for (std::int32_t y = 0; y < image.height; ++y)
        for (std::int32_t x = 0; x < image.width; ++x) {
            const float lightness =
                repetition.mean_lightness[std::size_t(y) * std::size_t(image.width) + std::size_t(x)];
            // Codes of greys follow lightness closely
            const auto code =
                static_cast<std::uint8_t>(std::lround(std::clamp(lightness, 0.0F, 100.0F) * 2.55F));
            put(image, x, y, {code, code, code});
        }
    return image;
}

}  // namespace tessera
