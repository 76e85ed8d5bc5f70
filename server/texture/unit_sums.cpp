#include "server/texture/unit_sums.h"

#include <algorithm>

namespace tessera {
namespace {

/// Side of the images of a level, in texels: the unit's and as much more as a patch of any variant hangs
/// over.
std::int32_t image_side(std::int32_t tile_side, const StampSpans::Level& level, const Variants& variants) {
    std::int32_t side = tile_side * variants.unit_tiles;
    for (std::uint32_t type = 0; type < variants.types(); ++type)
        for (const Shown& shown : variants.of(type)) {
            std::int32_t y = shown.tile_y * tile_side + level.stamps[shown.shape].y;
            for (const StampSpans::Span& span : level.of(shown.shape)) {
                ++y;
                if (span.begin < span.end) side = std::max({side, shown.tile_x * tile_side + span.end, y});
            }
        }
    return side;
}

}  // namespace

std::size_t VariantImages::bytes(int level, int tile_level, const StampSpans& spans,
                                 const Variants& variants) {
    const auto side =
        static_cast<std::size_t>(image_side(1 << (tile_level - level), spans.level(level), variants));
    return variants.types() * side * side * 3 * sizeof(float);
}

void VariantImages::fill(std::uint32_t type, const std::vector<double>& image) {
    const double* from = image.data();
    float* to = values_.data() + std::size_t{type} * std::size_t(side_) * row_floats();
    for (std::int32_t y = 0; y < side_; ++y, from += std::size_t(side_) * 3, to += row_floats())
        std::transform(from, from + std::size_t(side_) * 3, to,
                       [](double value) { return static_cast<float>(value); });
}

VariantImages::VariantImages(int level, int tile_level, const StampSpans& spans, const Stamps& stamps,
                             const Variants& variants)
    : level_{level}, types_{variants.types()} {
    const std::int32_t tile_side = 1 << (tile_level - level);
    const StampSpans::Level& in = spans.level(level);
    unit_side_ = tile_side * variants.unit_tiles;
    side_ = image_side(tile_side, in, variants);

    const std::size_t width = std::size_t(side_) * 3;
    values_.resize(std::size_t{types_} * std::size_t(side_) * row_floats() + 16);
    std::vector<double> image(std::size_t(side_) * width);
    for (std::uint32_t type = 0; type < types_; ++type) {
        std::fill(image.begin(), image.end(), 0.0);
        for (const Shown& shown : variants.of(type)) {
            auto y = static_cast<std::size_t>(shown.tile_y * tile_side + in.stamps[shown.shape].y);
            for (const StampSpans::Span& span : in.of(shown.shape)) {
                const float* from = stamps.row(level, span);
                double* to = image.data() + y++ * width;
                if (span.begin == span.end) continue;
                to += std::size_t(shown.tile_x * tile_side + span.begin) * 3;
                for (std::int32_t i = 0; i < (span.end - span.begin) * 3; ++i) to[i] += double{from[i]};
            }
        }
        fill(type, image);
    }
}

VariantImages VariantImages::halved() const {
    VariantImages out;
    out.level_ = level_ + 1;
    out.types_ = types_;
    out.unit_side_ = unit_side_ / 2;
    out.side_ = (side_ + 1) / 2;
    out.values_.resize(std::size_t{types_} * std::size_t(out.side_) * out.row_floats() + 16);
    std::vector<double> image(std::size_t(out.side_) * std::size_t(out.side_) * 3);
    for (std::uint32_t type = 0; type < types_; ++type) {
        std::fill(image.begin(), image.end(), 0.0);
        for (std::int32_t y = 0; y < side_; ++y) {
            const float* from = row(type, y);
            double* to = image.data() + std::ptrdiff_t{y / 2} * out.side_ * 3;
            for (std::int32_t x = 0; x < side_; ++x)
                for (std::int32_t c = 0; c < 3; ++c) to[x / 2 * 3 + c] += 0.25 * double{from[x * 3 + c]};
        }
        out.fill(type, image);
    }
    return out;
}

NodeTables::NodeTables(int top, const VariantImages& one_texel_units, const UnitTree& tree) {
    heights_.resize(std::size_t(top) + 1, std::vector<Sums>(tree.types()));
    const std::int32_t side = one_texel_units.side();  // 1, or 2 where patches hang over
    for (std::size_t type = 0; type < tree.types(); ++type)
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x)
                for (std::int32_t c = 0; c < 3; ++c)
                    heights_[0][type].part[y * 2 + x][c] =
                        one_texel_units.row(static_cast<std::uint32_t>(type), y)[x * 3 + c];

    for (int height = 1; height <= top; ++height)
        for (std::size_t type = 0; type < tree.types(); ++type) {
            // The four children and what hangs over them cover 3 × 3 texels of the level below; the node
            // takes the mean of the first 2 × 2, and the rest hangs over
            double sums[4][3] = {};
            const auto& children = tree.children(height, static_cast<std::uint16_t>(type));
            for (std::size_t child = 0; child < 4; ++child)
                for (std::size_t part = 0; part < 4; ++part) {
                    const std::size_t x = child % 2 + part % 2, y = child / 2 + part / 2;
                    for (std::size_t c = 0; c < 3; ++c)
                        sums[(y / 2) * 2 + x / 2][c] +=
                            double{heights_[std::size_t(height) - 1][children[child]].part[part][c]};
                }
            for (std::size_t part = 0; part < 4; ++part)
                for (std::size_t c = 0; c < 3; ++c)
                    heights_[std::size_t(height)][type].part[part][c] =
                        static_cast<float>(0.25 * sums[part][c]);
        }
}

std::size_t NodeTables::memory_bytes() const noexcept {
    return heights_.size() * (heights_.empty() ? 0 : heights_[0].size()) * sizeof(Sums);
}

}  // namespace tessera
