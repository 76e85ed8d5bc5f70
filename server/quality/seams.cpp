#include <algorithm>
#include <cmath>

#include "server/quality/lab.h"
#include "server/quality/measures.h"
#include "server/quality/own_neighbours.h"
#include "server/quality/quiet_curves.h"

namespace tessera {
namespace {

constexpr std::int32_t strip_rows = 64;
/// Below this an exemplar is one colour, as far as 8-bit codes go.
constexpr double least_step = 0.01;
/// A difference that is just seen (Mahy et al. 1994).
constexpr float just_seen = 2.3F;

const std::uint8_t* texel(const Rgba8Image& image, std::int32_t x, std::int32_t y) {
    return image.row(y) + std::ptrdiff_t{4} * x;
}

Steps steps_of(const Histogram& histogram) { return {histogram.mean(), histogram.percentile(0.99)}; }

Steps ratio(const Steps& seams, const Steps& others) {
    return {seams.mean / std::max(others.mean, least_step),
            seams.percentile_99 / std::max(others.percentile_99, least_step)};
}

/// The side of a square as large as a patch on average.
std::int32_t patch_side(const ExchangeAsset& asset) {
    const double side = asset.tile_side;
    if (asset.method != ExchangeMethod::interchange)
        return static_cast<std::int32_t>(side /
                                         std::sqrt(double(std::max<std::size_t>(asset.patches.size(), 1))));
    double texels = 0;
    for (const auto& patch : asset.patches)
        for (const auto& content : patch.contents)
            for (std::int32_t y = 0; y < content.shape.height; ++y)
                for (std::int32_t x = 0; x < content.shape.width; ++x)
                    texels += content.shape.at(x, y) ? 1 : 0;
    return static_cast<std::int32_t>(
        std::sqrt(texels / double(std::max<std::size_t>(asset.patches.size(), 1))));
}

/// The steps that the two sources of a pair have there of themselves.
class NaturalSteps {
  public:
    explicit NaturalSteps(const ExchangeAsset& asset) : own_{asset} {}

    struct End {
        std::uint32_t source = 0;
        std::int64_t x = 0, y = 0;
        const std::uint8_t* codes = nullptr;
    };
    void add(const End& from, const End& to, float shown) {
        const auto dx = static_cast<std::int32_t>(to.x - from.x),
                   dy = static_cast<std::int32_t>(to.y - from.y);
        const std::uint8_t* on = own_.beside(from.source, from.x, from.y, dx, dy, from.codes);
        const std::uint8_t* back = own_.beside(to.source, to.x, to.y, -dx, -dy, to.codes);
        float larger = 0;
        const auto count = [&](const std::uint8_t* one, const std::uint8_t* other) {
            if (other == nullptr) return;
            const float step = difference(one, other);
            steps_.add(step);
            larger = std::max(larger, step);
        };
        count(from.codes, on);
        count(to.codes, back);
        if (on == nullptr || back == nullptr) return;
        ++pairs_;
        new_edges_ += shown > larger + just_seen ? 1 : 0;
    }
    void write(Seams& seams) const {
        seams.natural_steps = steps_.count();
        if (steps_.count() == 0) return;
        seams.natural = steps_of(steps_);
        seams.natural_ratio = ratio(seams.natural, seams.exemplar);
        seams.excess = ratio(seams.hard, seams.natural);
        seams.new_edges = double(new_edges_) / double(std::max<std::uint64_t>(pairs_, 1));
    }

  private:
    OwnNeighbours own_;
    Histogram steps_{0, 300};
    std::uint64_t pairs_ = 0, new_edges_ = 0;
};

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
    NaturalSteps natural{asset};
    std::vector<double> energy(tile_texels);
    std::vector<std::uint32_t> counts(tile_texels);
    Rgba8Image cut, smooth;
    for (std::int32_t top = 0; top < side; top += strip_rows) {
        progress.advance(0.8 * top / side);
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
                    const std::int64_t plane_x = region.x + x, plane_y = region.y + y;
                    natural.add({(*sources)[here], plane_x, plane_y, texel(cut, x, y)},
                                {(*sources)[there], plane_x + dx, plane_y + dy, texel(cut, x + dx, y + dy)},
                                sharp);
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
    natural.write(seams);
    const auto quiet = steps_of_quiet_curves(asset.exemplar, patch_side(asset), progress.part(0.8, 1));
    if (!quiet) return quiet.error();
    seams.quiet_steps = quiet->count();
    seams.quiet_ratio = ratio(steps_of(*quiet), seams.exemplar);
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
