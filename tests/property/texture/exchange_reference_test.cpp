#include <array>
#include <set>
#include <tuple>

#include "server/texture/typed_quadtree.h"
#include "server/texture/unit_choice.h"
#include "shared/math/srgb.h"
#include "tests/property/texture/exchange_pages.h"

namespace tessera {
namespace {

using tests::codes;
using tests::linear;
using tests::make_asset;
using tests::make_synthetic_asset;

/// DESIGN section 2's sum, one texel at a time and from the asset alone: the readable reference. I = tile + Σ
/// over the patches of the shape's share of the window around the texel, rounded down to a 32768th, times
/// (content − tile).
std::array<double, 3> reference_texel(const ExchangeAsset& asset, const TypedQuadtree& tree,
                                      const Variants& variants, std::int64_t x, std::int64_t y,
                                      std::int32_t radius) {
    const std::int64_t side = asset.tile_side;
    const auto floor_mod = [&](std::int64_t a) { return ((a % side) + side) % side; };
    const auto texel = [](const Rgb8Image& image, std::int64_t u, std::int64_t v, std::size_t c) {
        return srgb_to_steps[image.bytes[static_cast<std::size_t>(v * image.width + u) * 3 + c]] / 65535.0;
    };
    std::array<double, 3> sum{};
    for (std::size_t c = 0; c < 3; ++c) sum[c] = texel(asset.tile, floor_mod(x), floor_mod(y), c);
    std::uint32_t first_shape = 0;
    for (const auto& patch : asset.patches) {
        // The occurrence of the patch that covers (x, y): its grown origin lies in [x − width, x]
        const std::int64_t in_x = floor_mod(x - patch.x + radius), in_y = floor_mod(y - patch.y + radius);
        const auto tile_of = [&](std::int64_t a) { return (a - floor_mod(a)) / side; };
        const std::int64_t tile_x = tile_of(x - in_x), tile_y = tile_of(y - in_y);
        const std::uint16_t type = tree.types_of(0, tile_x, tile_y, 1, 1).at(tile_x, tile_y);
        for (const Shown& shown : variants.of(type)) {
            if (shown.shape < first_shape || shown.shape >= first_shape + patch.contents.size()) continue;
            const auto& content = patch.contents[shown.shape - first_shape];
            std::int64_t count = 0;
            for (std::int64_t v = in_y - 2 * radius; v <= in_y; ++v)
                for (std::int64_t u = in_x - 2 * radius; u <= in_x; ++u)
                    if (u >= 0 && v >= 0 && u < patch.width && v < patch.height)
                        count += content.shape.at(static_cast<std::int32_t>(u), static_cast<std::int32_t>(v));
            const double weight = double(count * 32768 / ((2 * radius + 1) * (2 * radius + 1))) / 32768;
            if (weight == 0) continue;
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += weight * (texel(asset.exemplar, content.at.x - radius + in_x,
                                          content.at.y - radius + in_y, c) -
                                    texel(asset.tile, floor_mod(x), floor_mod(y), c));
        }
        first_shape += static_cast<std::uint32_t>(patch.contents.size());
    }
    return sum;
}

TEST(Exchange, AgreesWithTheReadableReferenceAtLevel0) {
    const ExchangeAsset asset = make_synthetic_asset({});
    const ExchangeOptions options{.seed = 77, .types = 4096};
    const auto texture = make_exchange_texture(asset, options);
    const TypedQuadtree tree{options.seed, options.types};
    const std::int32_t radius = asset.blend_texels / 2;
    const Variants variants = content_variants(Shapes{asset, radius}, options.seed, options.types);
    const TexelRegion region{0, -70, 1000, 140, 100};
    const LinearImage page = linear(*texture, region);
    for (std::int32_t y = 0; y < region.height; ++y)
        for (std::int32_t x = 0; x < region.width; ++x) {
            const auto expected = reference_texel(asset, tree, variants, region.x + x, region.y + y, radius);
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(page.row(y)[4 * x + std::int32_t(c)], expected[c], 0.01 * code_in_linear)
                    << x << ", " << y;
        }
}

TEST(Exchange, AgreesWithPaintingOneShapeAfterAnotherWhereItDoesNotBlend) {
    // Whatever the method: sources() says which content a texel shows, and the page shows that content's
    // texel
    for (const ExchangeMethod method :
         {ExchangeMethod::content_exchange, ExchangeMethod::interchange, ExchangeMethod::wang})
        for (const Choice choice : {Choice::typed, Choice::kolar}) {
            if (choice == Choice::kolar && method != ExchangeMethod::interchange) continue;
            const ExchangeAsset asset = make_asset(method, {.patches = 100, .groups = 8});
            const auto texture =
                make_exchange_texture(asset, {.choice = choice, .types = 64, .blended = false});
            const TexelRegion region{0, -200, 77, 300, 200};
            const auto sources = texture->sources(region);
            ASSERT_TRUE(sources.has_value());
            const Rgba8Image page = codes(*texture, region);
            std::vector<std::pair<std::size_t, std::size_t>> of_source;
            for (std::size_t p = 0; p < asset.patches.size(); ++p)
                for (std::size_t c = 0; c < asset.patches[p].contents.size(); ++c)
                    of_source.emplace_back(p, c);
            std::size_t exchanged = 0;
            for (std::int32_t y = 0; y < region.height; ++y)
                for (std::int32_t x = 0; x < region.width; ++x) {
                    const std::int64_t wrap = asset.tile_side - 1;
                    const std::uint32_t source = (*sources)[std::size_t(y * region.width + x)];
                    const Rgb8Image& image = source == 0 ? asset.tile : asset.exemplar;
                    std::int64_t u = (region.x + x) & wrap, v = (region.y + y) & wrap;
                    if (source > 0) {
                        const auto& patch = asset.patches[of_source[source - 1].first];
                        const auto& content = patch.contents[of_source[source - 1].second];
                        // Where in its box the texel lies: boxes are no wider than two tiles
                        std::int64_t in_x = (region.x + x - patch.x) & wrap,
                                     in_y = (region.y + y - patch.y) & wrap;
                        ASSERT_LT(patch.width, asset.tile_side + 1);
                        ASSERT_TRUE(content.shape.at(static_cast<std::int32_t>(in_x),
                                                     static_cast<std::int32_t>(in_y)));
                        u = content.at.x + in_x;
                        v = content.at.y + in_y;
                        ++exchanged;
                    }
                    for (std::int32_t c = 0; c < 3; ++c)
                        ASSERT_EQ(page.row(y)[x * 4 + c],
                                  image.bytes[std::size_t((v * image.width + u) * 3 + c)]);
                }
            EXPECT_GT(exchanged, sources->size() / (choice == Choice::kolar ? 10 : 3));
        }
}

TEST(Exchange, ShowsOnlyColoursOfTheExemplarWhereItDoesNotBlend) {
    const ExchangeAsset asset = make_synthetic_asset({});
    const auto texture = make_exchange_texture(asset, {.blended = false});
    std::set<std::tuple<int, int, int>> colours;
    for (const Rgb8Image* image : {&asset.exemplar, &asset.tile})
        for (std::size_t i = 0; i < image->bytes.size(); i += 3)
            colours.emplace(image->bytes[i], image->bytes[i + 1], image->bytes[i + 2]);
    const Rgba8Image page = codes(*texture, {0, -300, 500, 256, 256});
    for (std::size_t i = 0; i < page.bytes.size(); i += 4)
        ASSERT_TRUE(colours.contains({page.bytes[i], page.bytes[i + 1], page.bytes[i + 2]}));
}

}  // namespace
}  // namespace tessera
