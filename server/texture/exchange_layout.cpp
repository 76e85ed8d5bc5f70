#include "server/texture/exchange_layout.h"

#include <bit>

namespace tessera {

namespace {

Variants make_variants(const ExchangeAsset& asset, const Shapes& shapes, const ExchangeOptions& options) {
    const std::uint32_t types = types_of(asset.method, options);
    if (options.choice != Choice::typed) return {};
    switch (asset.method) {
        case ExchangeMethod::interchange:
            return packed_variants(asset, shapes, options.seed, types);
        case ExchangeMethod::wang:
            return wang_variants(asset, shapes, options.seed, types);
        case ExchangeMethod::content_exchange:
            break;
    }
    return content_variants(shapes, options.seed, types);
}

}  // namespace

std::uint32_t types_of(ExchangeMethod method, const ExchangeOptions& options) {
    if (options.types != 0) return options.types;
    // Units of many tiles are packed one by one when the scene loads, and differ more; with so few types
    // images of variants hold tiles of 16 texels, on which patches are a texel or two
    if (method == ExchangeMethod::interchange) return 512;
    return method == ExchangeMethod::wang ? 1024 : 4096;
}

std::int32_t blend_radius(const ExchangeAsset& asset, const ExchangeOptions& options) {
    return options.blended ? asset.blend_texels / 2 : 0;
}

ExchangeLayout::ExchangeLayout(const ExchangeAsset& asset, const ExchangeOptions& options)
    : method{asset.method},
      choice{options.choice},
      tile_side{asset.tile_side},
      tile_level{std::countr_zero(static_cast<std::uint32_t>(asset.tile_side))},
      shapes{asset, blend_radius(asset, options)},
      spans{shapes, tile_level},
      variants{make_variants(asset, shapes, options)},
      joined{asset, shapes, asset.method == ExchangeMethod::interchange && options.choice == Choice::typed} {
    unit_level = tile_level + std::countr_zero(static_cast<std::uint32_t>(variants.unit_tiles));
    if (choice == Choice::typed) tree.emplace(options.seed, types_of(method, options), variants.apart);
    if (choice == Choice::independent) independent.emplace(options.seed, shapes);
    if (choice == Choice::kolar) kolar.emplace(asset, shapes, options.seed);

    variants.sort([&](const Shown& a, const Shown& b) { return top_of(a) < top_of(b); });
    if (joined.joins()) joined_variants = joined.joined(variants, tile_side);
    for (std::size_t s = 0; s < shapes.size(); ++s) tallest = std::max(tallest, shapes[s].height);
    const auto reach = [&](const Shown& shown, std::int32_t unit_tiles) {
        const Shapes::Shape& shape = shapes[shown.shape];
        const std::int32_t right = shown.tile_x * tile_side + shape.x + shape.width;
        const std::int32_t bottom = shown.tile_y * tile_side + shape.y + shape.height;
        overhang = std::max({overhang, right - unit_tiles * tile_side, bottom - unit_tiles * tile_side});
    };
    for (std::uint32_t type = 0; type < variants.types(); ++type)
        for (const Shown& shown : variants.of(type)) reach(shown, variants.unit_tiles);
    if (independent)
        for (std::size_t s = 0; s < shapes.size(); ++s) reach({static_cast<std::uint16_t>(s), 0, 0}, 1);
    for (std::uint32_t type = 0; type < variants.types(); ++type)
        most_shown = std::max(most_shown, variants.of(type).size());
    if (independent) most_shown = shapes.patch_count();
    if (kolar) most_shown = shapes.size();
    if (kolar) overhang = tile_side;  // a rhombus reaches half a tile over, and its blending little more
}

UnitGrid ExchangeLayout::shown_at(const TexelRegion& region, const Variants& lists) const {
    const int shift = unit_level - region.level;
    // A texel of the overhang's width before the region may still reach into it
    const std::int64_t before = (overhang + (std::int64_t{1} << region.level) - 1) >> region.level;
    // Shapes of `choice: kolar` begin up to a tile before their own
    const std::int64_t after = choice == Choice::kolar ? 1 : 0;
    const std::int64_t x = (region.x - before) >> shift, y = (region.y - before) >> shift;
    return shown_by(x, y, ((region.x + region.width - 1) >> shift) + after - x + 1,
                    ((region.y + region.height - 1) >> shift) + after - y + 1, lists);
}

UnitGrid ExchangeLayout::shown_by(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height,
                                  const Variants& lists) const {
    UnitGrid grid{x, y, width, height};
    std::optional<TypeGrid> types;
    if (tree)
        types = tree->types_of(0, x, y, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height));
    for (std::int64_t row = y; row < y + height; ++row)
        for (std::int64_t column = x; column < x + width; ++column) {
            if (types) {
                grid.at(column, row) = lists.of(types->at(column, row));
                continue;
            }
            std::vector<Shown> shown =
                independent ? independent->shown_by(column, row) : kolar->shown_by(column, row);
            std::stable_sort(shown.begin(), shown.end(),
                             [&](const Shown& a, const Shown& b) { return top_of(a) < top_of(b); });
            grid.keep(column, row, std::move(shown));
        }
    return grid;
}

std::span<const Shown> ExchangeLayout::rows_of(std::span<const Shown> shown, std::int64_t first,
                                               std::int64_t last) const {
    const auto begin = std::partition_point(shown.begin(), shown.end(),
                                            [&](const Shown& one) { return top_of(one) + tallest <= first; });
    const auto end =
        std::partition_point(begin, shown.end(), [&](const Shown& one) { return top_of(one) < last; });
    return {begin, end};
}

std::size_t ExchangeLayout::memory_bytes() const noexcept {
    return shapes.memory_bytes() + spans.memory_bytes() + variants.memory_bytes() + joined.memory_bytes() +
           joined_variants.memory_bytes() + (tree ? tree->memory_bytes() : 0);
}

}  // namespace tessera
