#include "server/texture/exchange_texture.h"

#include <bit>
#include <iomanip>
#include <sstream>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// What the images of variants may take: beyond, levels are summed stamp by stamp.
constexpr std::size_t max_image_bytes = std::size_t{40} << 20;
/// Tiles that the expectation of `choice: kolar` is the mean of.
constexpr std::int64_t sampled_tiles = 64;

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

ExchangeLayout::ExchangeLayout(const ExchangeAsset& asset, const ExchangeOptions& options)
    : method{asset.method},
      choice{options.choice},
      tile_side{asset.tile_side},
      tile_level{std::countr_zero(static_cast<std::uint32_t>(asset.tile_side))},
      shapes{asset, blend_radius(asset, options)},
      variants{make_variants(asset, shapes, options)} {
    unit_level = tile_level + std::countr_zero(static_cast<std::uint32_t>(variants.unit_tiles));
    if (choice == Choice::typed) tree.emplace(options.seed, types_of(method, options));
    if (choice == Choice::independent) independent.emplace(options.seed, shapes);
    if (choice == Choice::kolar) kolar.emplace(asset, shapes, options.seed);

    variants.sort([&](const Shown& a, const Shown& b) { return top_of(a) < top_of(b); });
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
    if (kolar) overhang = tile_side;  // a rhombus reaches half a tile over, and its blending little more
}

UnitGrid ExchangeLayout::shown_by(std::int64_t x, std::int64_t y, std::int64_t width,
                                  std::int64_t height) const {
    UnitGrid grid{x, y, width, height};
    std::optional<TypeGrid> types;
    if (tree)
        types = tree->types_of(0, x, y, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height));
    for (std::int64_t row = y; row < y + height; ++row)
        for (std::int64_t column = x; column < x + width; ++column) {
            if (types) {
                grid.at(column, row) = variants.of(types->at(column, row));
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
    return shapes.memory_bytes() + variants.memory_bytes() + (tree ? tree->memory_bytes() : 0);
}

CompiledExchange::CompiledExchange(std::shared_ptr<const ExchangeLayout> layout, TexelSource exemplar,
                                   const TexelSource& tile, TexelKind texels)
    : layout_{std::move(layout)},
      kind_of_texels_{texels},
      exemplar_{std::move(exemplar)},
      tile_{tile.repeated(layout_->tile_side + layout_->shapes.widest())},
      tile_levels_{tile},
      stamps_{layout_->shapes, exemplar_, tile_, layout_->tile_level} {
    const int tile_level = layout_->tile_level;
    if (layout_->choice == Choice::typed) {
        const Variants& variants = layout_->variants;
        for (std::uint32_t type = 0; type < variants.types(); ++type)
            most_shown_ = std::max(most_shown_, variants.of(type).size());
        int finest = tile_level;
        while (finest > 1 &&
               VariantImages::bytes(finest - 1, tile_level, stamps_, variants) <= max_image_bytes)
            --finest;
        images_.emplace_back(finest, tile_level, stamps_, variants);
        while (images_.back().unit_side() > 1) images_.push_back(images_.back().halved());
        nodes_.emplace(max_level - layout_->unit_level, images_.back(), *layout_->tree);
    } else if (layout_->independent) {
        independent_sums_.emplace(layout_->shapes, stamps_.level(tile_level));
        most_shown_ = layout_->shapes.patch_count();
    } else {
        most_shown_ = layout_->shapes.size();
        // Parities alternate, so an even square of tiles holds as many of either set
        const Stamps::Level& last = stamps_.level(tile_level);
        UnitGrid grid = layout_->shown_by(0, 0, sampled_tiles, sampled_tiles);
        for (std::int64_t y = 0; y < sampled_tiles; ++y)
            for (std::int64_t x = 0; x < sampled_tiles; ++x)
                for (const Shown& shown : grid.at(x, y)) {
                    const Stamps::Stamp& stamp = last.stamps[shown.shape];
                    for (std::uint32_t row = 0; row < stamp.rows; ++row) {
                        const Stamps::Span& span = last.spans[stamp.first_span + row];
                        for (std::int32_t i = 0; i < (span.end - span.begin) * 3; ++i)
                            expectation_[i % 3] += double{last.row(span)[i]};
                    }
                }
        for (double& channel : expectation_) channel /= double(sampled_tiles * sampled_tiles);
    }
}

std::shared_ptr<const Texture> CompiledExchange::with_texels(const Rgb16Image& exemplar,
                                                             const Rgb16Image& tile) const {
    return std::make_shared<CompiledExchange>(layout_, TexelSource{exemplar}, TexelSource{tile},
                                              TexelKind::data);
}

std::string_view CompiledExchange::kind() const noexcept { return method_name(layout_->method); }

std::size_t CompiledExchange::memory_bytes() const noexcept {
    std::size_t bytes = layout_->memory_bytes() + exemplar_.memory_bytes() + tile_.memory_bytes() +
                        tile_levels_.memory_bytes() + stamps_.memory_bytes();
    for (const VariantImages& images : images_) bytes += images.memory_bytes();
    if (nodes_) bytes += nodes_->memory_bytes();
    if (independent_sums_) bytes += independent_sums_->memory_bytes();
    return bytes;
}

std::string CompiledExchange::description() const {
    std::ostringstream text;
    const auto line = [&](std::string_view what, std::size_t bytes) {
        text << "  " << std::left << std::setw(58) << what << std::right << std::setw(9) << std::fixed
             << std::setprecision(1) << double(bytes) / (1 << 20) << " MiB\n";
    };
    const ExchangeLayout& layout = *layout_;
    text << kind() << ": tile of " << layout.tile_side << " texels, " << layout.shapes.patch_count()
         << " patches, " << layout.shapes.size() << " contents, blended over " << 2 * layout.shapes.radius()
         << " texels\n";
    line("level 0: exemplar and tile", exemplar_.memory_bytes() + tile_.memory_bytes());
    line("level 0: shapes and blending weights", layout.shapes.memory_bytes());
    line("tile, levels 1 to " + std::to_string(layout.tile_level), tile_levels_.memory_bytes());
    line("stamps, levels 1 to " + std::to_string(layout.tile_level), stamps_.memory_bytes());
    if (layout.choice == Choice::typed) {
        std::size_t images = 0;
        for (const VariantImages& image : images_) images += image.memory_bytes();
        text << "choice: typed, " << layout.tree->types() << " types of units of "
             << layout.variants.unit_tiles << "×" << layout.variants.unit_tiles << " tiles\n";
        line("types of the quadtree", layout.tree->memory_bytes());
        line("what each variant shows", layout.variants.memory_bytes());
        line("images of variants, units of " + std::to_string(images_.front().unit_side()) + " to 1 texels",
             images);
        line(
            "sums of nodes, levels " + std::to_string(layout.unit_level) + " to " + std::to_string(max_level),
            nodes_->memory_bytes());
    } else if (independent_sums_) {
        text << "choice: independent; above level " << layout.tile_level
             << " enumerated where a texel costs at most 8192 look-ups (exact) or 1024"
                " (high), then expected\n";
        line("sums of contents", independent_sums_->memory_bytes());
    } else {
        text << "choice: kolar; up to two levels above level " << layout.tile_level
             << " reduced from there, then expected\n";
    }
    return text.str();
}

std::size_t exchange_bytes(const ExchangeAsset& asset, const ExchangeOptions& options) {
    const auto area = [](std::int32_t width, std::int32_t height) {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    };
    const std::int32_t margin = 2 * blend_radius(asset, options);
    std::size_t bytes = 0;
    std::int32_t widest = 0;
    for (const auto& patch : asset.patches) {
        const std::size_t box = area(patch.width + margin, patch.height + margin);
        widest = std::max(widest, patch.width + margin);
        // A weight, and stamps of all levels: a third of the box, and half as much again where boxes round up
        bytes += patch.contents.size() * (box * 8 + std::size_t(patch.height + margin) * 64 + 1024);
    }
    // Codes and linear steps; the tile's levels; images of variants, their lists and tables of nodes
    bytes += 12 * (area(asset.exemplar.width, asset.exemplar.height) +
                   area(asset.tile_side + widest, asset.tile_side));
    bytes += 24 * area(asset.tile_side, asset.tile_side);
    if (options.choice == Choice::typed) {
        const std::size_t types = types_of(asset.method, options);
        // Patches of an interchange unit lie on any of its 16 tiles; images are finer than a unit by a level
        const bool packed = asset.method == ExchangeMethod::interchange;
        const std::size_t tiles = asset.method == ExchangeMethod::content_exchange ? 1 : packed ? 16 : 64;
        const std::size_t unit_texels = area(asset.tile_side, asset.tile_side) * tiles;
        bytes += types * (asset.patches.size() * (packed ? 64 : 4) + 8000);
        bytes += 2 * std::min(max_image_bytes, types * unit_texels * 12);
    }
    return bytes;
}

std::shared_ptr<const ExchangeTexture> make_exchange_texture(const ExchangeAsset& asset,
                                                             const ExchangeOptions& options) {
    return std::make_shared<CompiledExchange>(std::make_shared<const ExchangeLayout>(asset, options),
                                              TexelSource{asset.exemplar}, TexelSource{asset.tile},
                                              TexelKind::color);
}

}  // namespace tessera
