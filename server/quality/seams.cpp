#include <algorithm>

#include "server/quality/lab.h"
#include "server/quality/measures.h"

namespace tessera {
namespace {

constexpr std::int32_t strip_rows = 64;
/// Below this an exemplar is one colour, as far as 8-bit codes go.
constexpr double least_step = 0.01;

const std::uint8_t* texel(const Rgba8Image& image, std::int32_t x, std::int32_t y) {
    return image.row(y) + std::ptrdiff_t{4} * x;
}

Steps steps_of(const Histogram& histogram) { return {histogram.mean(), histogram.percentile(0.99)}; }

Steps ratio(const Steps& seams, const Steps& exemplar) {
    return {seams.mean / std::max(exemplar.mean, least_step),
            seams.percentile_99 / std::max(exemplar.percentile_99, least_step)};
}

}  // namespace

std::vector<TexelRect> exemplar_parts(const ExchangeAsset& asset) {
    if (asset.method != ExchangeMethod::wang) return {{0, 0, asset.exemplar.width, asset.exemplar.height}};
    std::vector<TexelRect> parts;
    for (const auto& patch : asset.patches)
        for (const auto& content : patch.contents)
            parts.push_back({content.at.x, content.at.y, patch.width, patch.height});
    return parts;
}

Result<Seams> measure_seams(const ExchangeAsset& asset, const ExchangeTexture& hard,
                            const ExchangeTexture& blended, const ProgressPart& progress) {
    const std::int32_t tile = asset.tile_side;
    const auto tile_texels = std::size_t(tile) * std::size_t(tile);
    Seams seams;

    // The exemplar's own steps
    Histogram own{0, 300};
    for (const TexelRect& part : exemplar_parts(asset)) {
        const auto at = [&](std::int32_t x, std::int32_t y) {
            return asset.exemplar.bytes.data() +
                   (std::size_t(y) * std::size_t(asset.exemplar.width) + std::size_t(x)) * 3;
        };
        std::vector<Lab> above(std::size_t(part.width)), row(std::size_t(part.width));
        for (std::int32_t y = 0; y < part.height; ++y, std::swap(above, row))
            for (std::int32_t x = 0; x < part.width; ++x) {
                const auto i = std::size_t(x);
                row[i] = to_lab(at(part.x + x, part.y + y));
                if (x > 0) own.add(difference(row[i - 1], row[i]));
                if (y > 0) own.add(difference(above[i], row[i]));
            }
    }
    seams.exemplar = steps_of(own);

    // The texture's, where sources meet: strips that overlap by a row
    const std::int32_t side = std::clamp(4 * tile, 2048, 4096);
    Histogram hard_steps{0, 300}, blended_steps{0, 300};
    std::vector<double> energy(tile_texels);
    std::vector<std::uint32_t> counts(tile_texels);
    Rgba8Image cut, smooth;
    for (std::int32_t top = 0; top < side; top += strip_rows) {
        progress.advance(double(top) / side);
        // One texel more at the right and below, for the steps of the last ones
        const TexelRegion region{0, -1, top, std::min(side + 1, 4096), strip_rows + 1};
        if (auto done = hard.evaluate(region, progress.budget(), cut); !done) return done.error();
        if (auto done = blended.evaluate(region, progress.budget(), smooth); !done) return done.error();
        const auto sources = hard.sources(region);
        if (!sources) return sources.error();
        for (std::int32_t y = 0; y < strip_rows; ++y)
            for (std::int32_t x = 0; x + 1 < region.width; ++x) {
                const std::size_t here = std::size_t(y) * std::size_t(region.width) + std::size_t(x);
                const std::int32_t tile_x = (x + tile - 1) % tile, tile_y = (top + y) % tile;
                const auto step = [&](std::size_t there, std::int32_t dx, std::int32_t dy,
                                      bool between_tiles) {
                    if ((*sources)[here] == (*sources)[there] &&
                        !(between_tiles && asset.method == ExchangeMethod::wang))
                        return;
                    const float sharp = difference(texel(cut, x, y), texel(cut, x + dx, y + dy));
                    hard_steps.add(sharp);
                    blended_steps.add(difference(texel(smooth, x, y), texel(smooth, x + dx, y + dy)));
                    const std::size_t place = std::size_t(tile_y) * std::size_t(tile) + std::size_t(tile_x);
                    energy[place] += double(sharp);
                    ++counts[place];
                };
                step(here + 1, 1, 0, tile_x == tile - 1);
                step(here + std::size_t(region.width), 0, 1, tile_y == tile - 1);
            }
    }
    seams.pairs = hard_steps.count();
    seams.hard = steps_of(hard_steps);
    seams.blended = steps_of(blended_steps);
    seams.hard_ratio = ratio(seams.hard, seams.exemplar);
    seams.blended_ratio = ratio(seams.blended, seams.exemplar);
    const double occurrences = std::max(1.0, double(side) * side / double(tile_texels));
    for (std::size_t i = 0; i < tile_texels; ++i) {
        seams.energy.push_back(
            counts[i] == 0
                ? 0.0F
                : static_cast<float>(energy[i] / counts[i] / std::max(seams.exemplar.mean, least_step)));
        seams.frequency.push_back(static_cast<float>(counts[i] / occurrences));
    }
    progress.advance(1);
    return seams;
}

}  // namespace tessera
