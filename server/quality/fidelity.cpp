#include <algorithm>

#include "server/quality/lab.h"
#include "server/quality/measures.h"

namespace tessera {
namespace {

constexpr std::int32_t strip_rows = 64;

/// Counts texels row by row, with their steps to the left and upwards.
class Counter {
  public:
    Counter(Fidelity::Curves& curves, std::int32_t width)
        : curves_{curves}, above_(std::size_t(width)), row_(std::size_t(width)) {}

    /// `channels` bytes a texel, of which the first three are codes.
    void add_row(const std::uint8_t* codes, std::ptrdiff_t channels) {
        for (std::size_t x = 0; x < row_.size(); ++x) {
            row_[x] = to_lab(codes + std::ptrdiff_t(x) * channels);
            curves_.lightness.add(row_[x].lightness);
            curves_.green_red.add(row_[x].green_red);
            curves_.blue_yellow.add(row_[x].blue_yellow);
            if (x > 0) curves_.steps.add(difference(row_[x - 1], row_[x]));
            if (!first_) curves_.steps.add(difference(above_[x], row_[x]));
        }
        std::swap(above_, row_);
        first_ = false;
    }

  private:
    Fidelity::Curves& curves_;
    std::vector<Lab> above_, row_;
    bool first_ = true;
};

void count_image(Fidelity::Curves& curves, const Rgb8Image& image, const TexelRect& part) {
    Counter counter{curves, part.width};
    for (std::int32_t y = part.y; y < part.y + part.height; ++y)
        counter.add_row(
            image.bytes.data() + (std::size_t(y) * std::size_t(image.width) + std::size_t(part.x)) * 3, 3);
}

Fidelity::Distances distances(const Fidelity::Curves& a, const Fidelity::Curves& b) {
    return {distance(a.lightness, b.lightness), distance(a.green_red, b.green_red),
            distance(a.blue_yellow, b.blue_yellow), distance(a.steps, b.steps)};
}

}  // namespace

Result<Fidelity> measure_fidelity(const ExchangeAsset& asset, const ExchangeTexture& texture,
                                  const ProgressPart& progress) {
    Fidelity fidelity;
    for (const TexelRect& part : exemplar_parts(asset))
        count_image(fidelity.exemplar_curves, asset.exemplar, part);
    const std::int32_t side = std::clamp(4 * asset.tile_side, 2048, 4096);
    Counter counter{fidelity.texture_curves, side};
    Rgba8Image texels;
    for (std::int32_t top = 0; top < side; top += strip_rows) {
        progress.advance(double(top) / side);
        if (auto done = texture.evaluate({0, 0, top, side, strip_rows}, progress.budget(), texels); !done)
            return done.error();
        for (std::int32_t y = 0; y < strip_rows; ++y) counter.add_row(texels.row(y), 4);
    }
    fidelity.texture = distances(fidelity.texture_curves, fidelity.exemplar_curves);
    Fidelity::Curves tile;
    count_image(tile, asset.tile, {0, 0, asset.tile_side, asset.tile_side});
    fidelity.tile = distances(tile, fidelity.exemplar_curves);
    progress.advance(1);
    return fidelity;
}

}  // namespace tessera
