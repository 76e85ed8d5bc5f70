#include "server/texture/exchange_texture.h"

#include <iomanip>
#include <sstream>

#include "server/texture/exchange_walk.h"

namespace tessera {

CompiledExchange::CompiledExchange(std::shared_ptr<const ExchangeLayout> layout, TexelSource exemplar,
                                   const TexelSource& tile)
    : layout_{std::move(layout)}, texels_{*layout_, std::move(exemplar), tile} {}

Result<Evaluation> CompiledExchange::evaluate(const TexelRegion& region, const Budget& budget,
                                              LinearImage& out) const {
    out = LinearImage{region.width, region.height};
    const ExchangeTexels* const source = &texels_;
    const ExchangeData::TakeRow take = [&](std::int32_t x, std::int32_t y, std::int32_t width,
                                           const float* const* rgb) {
        float* rgba = out.row(y) + std::ptrdiff_t{x} * 4;
        for (std::int32_t i = 0; i < width; ++i) {
            std::copy_n(rgb[0] + i * 3, 3, rgba + i * 4);
            rgba[i * 4 + 3] = 1.0F;
        }
    };
    return ExchangeWalk{*layout_, {&source, 1}, take}.evaluate(region, budget);
}

Result<Evaluation> CompiledExchange::evaluate(const TexelRegion& region, const Budget& budget,
                                              Rgba8Image& out) const {
    if (out.width != region.width || out.height != region.height)
        out = Rgba8Image{region.width, region.height};
    return ExchangeWalk{*layout_, texels_, out}.evaluate(region, budget);
}

Result<std::vector<std::uint32_t>> CompiledExchange::sources(const TexelRegion& region) const {
    if (region.level != 0) return Error{ErrorCode::invalid_input, "only level 0 shows one source a texel"};
    const ExchangeLayout& layout = *layout_;
    UnitGrid shown = layout.shown_at(region);
    std::vector<std::uint32_t> out(std::size_t(region.width) * std::size_t(region.height));
    for (std::int64_t uy = shown.y; uy < shown.y + shown.height; ++uy)
        for (std::int64_t ux = shown.x; ux < shown.x + shown.width; ++ux)
            for (const Shown& one : shown.at(ux, uy)) {
                const Shapes::Shape& shape = layout.shapes[one.shape];
                const std::int64_t x = (ux << layout.unit_level) - region.x +
                                       std::int64_t{one.tile_x} * layout.tile_side + shape.x;
                const std::int64_t y = (uy << layout.unit_level) - region.y +
                                       std::int64_t{one.tile_y} * layout.tile_side + shape.y;
                for (std::int64_t row = std::max<std::int64_t>(y, 0);
                     row < std::min<std::int64_t>(y + shape.height, region.height); ++row)
                    for (const Shapes::Segment& segment :
                         layout.shapes.row(shape, static_cast<std::int32_t>(row - y))) {
                        for (std::int32_t column = segment.begin; column < segment.end; ++column) {
                            const bool most = segment.weights == Shapes::Segment::all_one ||
                                              layout.shapes.weights(segment)[column - segment.begin] >
                                                  Shapes::weight_one / 2;
                            if (most && x + column >= 0 && x + column < region.width)
                                out[std::size_t(row) * std::size_t(region.width) + std::size_t(x + column)] =
                                    1u + one.shape;
                        }
                    }
            }
    return out;
}

std::shared_ptr<const ExchangeData> CompiledExchange::with_texels(std::span<const DataImages> images) const {
    return std::make_shared<CompiledData>(layout_, images);
}

CompiledData::CompiledData(std::shared_ptr<const ExchangeLayout> layout, std::span<const DataImages> images)
    : layout_{std::move(layout)} {
    for (const DataImages& image : images)
        texels_.emplace_back(*layout_, TexelSource{image.exemplar}, TexelSource{image.tile});
}

Result<Evaluation> CompiledData::evaluate(const TexelRegion& region, const Budget& budget,
                                          std::span<const std::size_t> sources,
                                          const TakeRow& take_row) const {
    const ExchangeTexels* asked[ExchangeWalk::most_sources] = {};
    for (std::size_t i = 0; i < sources.size(); ++i) asked[i] = &texels_[sources[i]];
    return ExchangeWalk{*layout_, {asked, sources.size()}, take_row}.evaluate(region, budget);
}

std::size_t CompiledData::memory_bytes() const noexcept {
    std::size_t bytes = 0;
    for (const ExchangeTexels& texels : texels_) bytes += texels.memory_bytes();
    return bytes;
}

std::string_view CompiledExchange::kind() const noexcept { return method_name(layout_->method); }

std::size_t CompiledExchange::memory_bytes() const noexcept {
    return layout_->memory_bytes() + texels_.memory_bytes();
}

std::string CompiledExchange::description() const {
    std::ostringstream text;
    const auto line = [&](std::string_view what, std::size_t bytes) {
        text << "  " << std::left << std::setw(58) << what << std::right << std::setw(9) << std::fixed
             << std::setprecision(1) << double(bytes) / (1 << 20) << " MiB\n";
    };
    const ExchangeLayout& layout = *layout_;
    const ExchangeTexels& texels = texels_;
    text << kind() << ": tile of " << layout.tile_side << " texels, " << layout.shapes.patch_count()
         << " patches, " << layout.shapes.size() << " contents, blended over " << 2 * layout.shapes.radius()
         << " texels\n";
    line("level 0: exemplar and tile", texels.exemplar.memory_bytes() + texels.tile.memory_bytes());
    line("level 0: shapes and blending weights", layout.shapes.memory_bytes());
    line("level 0: blended codes", texels.edges.memory_bytes());
    line("tile, levels 1 to " + std::to_string(layout.tile_level), texels.tile_levels.memory_bytes());
    line("stamps, levels 1 to " + std::to_string(layout.tile_level), texels.stamps.memory_bytes());
    if (layout.choice == Choice::typed) {
        std::size_t images = 0;
        for (const VariantImages& image : texels.images) images += image.memory_bytes();
        text << "choice: typed, " << layout.tree->types() << " types of units of "
             << layout.variants.unit_tiles << "×" << layout.variants.unit_tiles << " tiles\n";
        line("types of the quadtree", layout.tree->memory_bytes());
        line("what each variant shows", layout.variants.memory_bytes());
        line("images of variants, units of " + std::to_string(texels.images.front().unit_side()) +
                 " to 1 texels",
             images);
        line(
            "sums of nodes, levels " + std::to_string(layout.unit_level) + " to " + std::to_string(max_level),
            texels.nodes->memory_bytes());
    } else if (texels.independent_sums) {
        text << "choice: independent; above level " << layout.tile_level
             << " enumerated where a texel costs at most 8192 look-ups (exact) or 1024"
                " (high), then expected\n";
        line("sums of contents", texels.independent_sums->memory_bytes());
    } else {
        text << "choice: kolar; up to two levels above level " << layout.tile_level
             << " reduced from there, then expected\n";
    }
    return text.str();
}

namespace {

/// Texels from the first to the last of each row of a shape.
std::size_t spanned_texels(const BitMask& shape) {
    std::size_t texels = 0;
    for (std::int32_t y = 0; y < shape.height; ++y) {
        std::int32_t begin = 0, end = shape.width;
        while (begin < end && !shape.at(begin, y)) ++begin;
        while (end > begin && !shape.at(end - 1, y)) --end;
        texels += static_cast<std::size_t>(end - begin);
    }
    return texels;
}

}  // namespace

std::size_t exchange_bytes(const ExchangeAsset& asset, const ExchangeOptions& options) {
    const auto area = [](std::int32_t width, std::int32_t height) {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    };
    const std::int32_t margin = 2 * blend_radius(asset, options);
    std::size_t bytes = 0, alone = 0;
    std::int32_t widest = 0;
    for (const auto& patch : asset.patches) {
        const std::size_t box = area(patch.width + margin, patch.height + margin);
        const std::size_t rim = area(margin, patch.width + patch.height + margin);
        widest = std::max(widest, patch.width + margin);
        alone += patch.group == 0;
        // A weight, and stamps of all levels: a third of the texels, and half as much again where rows round
        // up. Patches of groups are thousands, and many of them far smaller than their boxes
        for (const auto& content : patch.contents) {
            const std::size_t texels = patch.group == 0 ? box : spanned_texels(content.shape) + rim;
            bytes += texels * 8 + std::size_t(patch.height + margin) * 64 + 1024;
        }
    }
    // Codes and linear steps; the tile's levels; images of variants, their lists and tables of nodes
    bytes += 12 * (area(asset.exemplar.width, asset.exemplar.height) +
                   area(asset.tile_side + widest, asset.tile_side));
    bytes += 24 * area(asset.tile_side, asset.tile_side);
    if (options.choice == Choice::typed) {
        const std::size_t types = types_of(asset.method, options);
        // Patches lie on any of the 16 tiles of an interchange unit, those of groups where their group does;
        // images are finer than a unit by a level
        const bool packed = asset.method == ExchangeMethod::interchange;
        const std::size_t tiles = asset.method == ExchangeMethod::content_exchange ? 1 : packed ? 16 : 64;
        const std::size_t unit_texels = area(asset.tile_side, asset.tile_side) * tiles;
        bytes += types * (alone * (packed ? 64 : 4) + (asset.patches.size() - alone) * 4 + 8000);
        bytes += 2 * std::min(max_image_bytes, types * unit_texels * 12);
    }
    return bytes;
}

std::shared_ptr<const ExchangeTexture> make_exchange_texture(const ExchangeAsset& asset,
                                                             const ExchangeOptions& options) {
    return std::make_shared<CompiledExchange>(std::make_shared<const ExchangeLayout>(asset, options),
                                              TexelSource{asset.exemplar}, TexelSource{asset.tile});
}

}  // namespace tessera
