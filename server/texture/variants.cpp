#include "server/texture/variants.h"

#include <algorithm>

#include "shared/math/hash.h"

namespace tessera {

Variants::Variants(std::uint64_t seed, std::uint32_t types, const ExemplarTexels& texels)
    : patches_{texels.patch_count()} {
    contents_.resize(std::size_t{types} * patches_);
    // For each patch a deck of the contents, as often as fits, shuffled in a stream of the patch's own
    std::vector<std::uint8_t> deck(types);
    for (std::size_t p = 0; p < patches_; ++p) {
        const std::uint64_t key = stream("contents of a patch", p);
        const std::uint32_t count = texels.content_count(p);
        for (std::uint32_t i = 0; i < types; ++i) {
            const std::uint32_t j = uniform_below(hash(seed, key, i, 0), i + 1);
            deck[i] = deck[j];
            deck[j] = static_cast<std::uint8_t>(i % count);
        }
        for (std::uint32_t type = 0; type < types; ++type)
            contents_[std::size_t{type} * patches_ + p] = deck[type];
    }
}

VariantImages::VariantImages(int level, const PatchMap& map, const Stamps& stamps, const Variants& variants)
    : tile_side_{map.levels()[std::size_t(level)].side} {
    const PatchMap::Level& rows = map.levels()[std::size_t(level)];
    side_ = tile_side_;
    for (std::int32_t y = 0; y < 2 * tile_side_; ++y)
        for (const PatchMap::Span& span : rows.row(y)) side_ = std::max({side_, span.end, y + 1});

    const std::size_t row_floats = std::size_t(side_) * 3;
    values_.resize(std::size_t{variants.types()} * std::size_t(side_) * row_floats + 16);
    std::vector<double> image(std::size_t(side_) * row_floats);
    for (std::uint32_t type = 0; type < variants.types(); ++type) {
        const std::uint8_t* contents = variants.contents(static_cast<std::uint16_t>(type));
        std::fill(image.begin(), image.end(), 0.0);
        for (std::int32_t y = 0; y < side_; ++y)
            for (const PatchMap::Span& span : rows.row(y)) {
                const float* stamp =
                    stamps.stamp(level, span.patch, contents[span.patch]) + std::size_t{span.offset} * 3;
                double* out = image.data() + std::size_t(y) * row_floats + std::size_t(span.begin) * 3;
                for (std::int32_t i = 0; i < (span.end - span.begin) * 3; ++i) out[i] += double{stamp[i]};
            }
        std::transform(image.begin(), image.end(), values_.begin() + std::ptrdiff_t(type * image.size()),
                       [](double value) { return static_cast<float>(value); });
    }
}

NodeTables::NodeTables(int top, const VariantImages& one_texel_tiles, const TypedQuadtree& tree) {
    heights_.resize(std::size_t(top) + 1, std::vector<Sums>(tree.types()));
    const std::int32_t side = one_texel_tiles.side();  // 1, or 2 where patches hang over
    for (std::size_t type = 0; type < tree.types(); ++type)
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x)
                for (std::int32_t c = 0; c < 3; ++c)
                    heights_[0][type].part[y * 2 + x][c] =
                        one_texel_tiles.row(static_cast<std::uint16_t>(type), y)[x * 3 + c];

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
