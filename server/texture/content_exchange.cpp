#include "server/texture/exchange.h"

#include <iomanip>
#include <sstream>

#include "server/texture/content_exchange_texture.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

ColorSteps mean_of(const Rgb8Image& tile) {
    ColorSteps mean{};
    for (std::size_t i = 0; i < tile.bytes.size(); ++i) mean[i % 3] += srgb_to_steps[tile.bytes[i]];
    for (double& channel : mean) channel /= static_cast<double>(tile.bytes.size() / 3);
    return mean;
}

std::int32_t blend_radius(const ExchangeAsset& asset, const ExchangeOptions& options) {
    return options.blended ? asset.blend_texels / 2 : 0;
}

}  // namespace

ContentExchangeTexture::ContentExchangeTexture(const ExchangeAsset& asset,
                                               const ExchangeOptions& options)
    : map_{asset, blend_radius(asset, options)},
      texels_{asset, map_.radius()},
      mean_{mean_of(asset.tile)},
      stamps_{map_, texels_, mean_},
      level_0_{map_},
      tile_level_{static_cast<int>(map_.levels().size()) - 1} {
    for (std::size_t c = 0; c < 3; ++c) mean_linear_[c] = static_cast<float>(mean_[c]) / linear_one;
    if (options.choice == Choice::independent) {
        independent_.emplace(options.seed, map_, texels_, stamps_);
        return;
    }
    tree_.emplace(options.seed, options.types == 0 ? 4096 : options.types);
    variants_.emplace(options.seed, options.types == 0 ? 4096 : options.types, texels_);
    for (int level = 0; level <= tile_level_; ++level)
        if (map_.levels()[std::size_t(level)].side <= variant_image_side)
            images_.push_back(VariantImages{level, map_, stamps_, *variants_});
    nodes_.emplace(max_level - tile_level_, images_.back(), *tree_);
}

std::size_t ContentExchangeTexture::memory_bytes() const noexcept {
    std::size_t bytes =
        map_.memory_bytes() + texels_.memory_bytes() + stamps_.memory_bytes() + level_0_.memory_bytes();
    if (tree_) bytes += tree_->memory_bytes() + variants_->memory_bytes() + nodes_->memory_bytes();
    for (const VariantImages& images : images_) bytes += images.memory_bytes();
    if (independent_) bytes += independent_->memory_bytes();
    return bytes;
}

std::string ContentExchangeTexture::description() const {
    std::ostringstream text;
    const auto line = [&](std::string_view what, std::size_t bytes) {
        text << "  " << std::left << std::setw(58) << what << std::right << std::setw(9) << std::fixed
             << std::setprecision(1) << double(bytes) / (1 << 20) << " MiB\n";
    };
    std::size_t contents = 0;
    for (std::size_t p = 0; p < texels_.patch_count(); ++p) contents += texels_.content_count(p);
    text << "content exchange: tile of " << map_.side() << " texels, " << texels_.patch_count()
         << " patches, " << contents << " contents, blended over " << 2 * map_.radius() << " texels\n";
    line("level 0: exemplar and tile, as codes and as linear steps", texels_.memory_bytes());
    line("level 0: runs and blending weights", level_0_.memory_bytes());
    line("patch map, all levels", map_.memory_bytes());
    line("stamps, levels 1 to " + std::to_string(tile_level_), stamps_.memory_bytes());
    if (tree_) {
        std::size_t images = 0;
        for (const VariantImages& image : images_) images += image.memory_bytes();
        text << "choice: typed, " << tree_->types() << " types\n";
        line("types of the quadtree", tree_->memory_bytes());
        line("contents of each variant", variants_->memory_bytes());
        line("images of variants, tiles of 8 to 1 texels", images);
        line("sums of nodes, levels " + std::to_string(tile_level_) + " to " + std::to_string(max_level),
             nodes_->memory_bytes());
    } else {
        text << "choice: independent; above level " << tile_level_
             << " enumerated where a texel costs at most 8192 look-ups (exact) or 1024"
                " (high), then expected\n";
        line("sums of contents", independent_->memory_bytes());
    }
    return text.str();
}

std::size_t exchange_bytes(const ExchangeAsset& asset, const ExchangeOptions& options) {
    const auto area = [](std::int32_t width, std::int32_t height) {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    };
    const std::int32_t margin = 2 * blend_radius(asset, options);
    std::size_t bytes = 0;
    std::int32_t reach = 0;
    for (const auto& patch : asset.patches) {
        const std::size_t box = area(patch.width + margin, patch.height + margin);
        reach = std::max({reach, patch.width + margin, patch.height + margin});
        // Weights twice (by patch, and four times over by run), spans; stamps of all levels, a third of the
        // box each and half as much again where boxes round up to whole texels
        bytes += box * 12 + box * (patch.contents.size() + 1) * 6;
    }
    // Codes and linear steps; images of variants and tables of nodes
    bytes += 12 * (area(asset.exemplar.width, asset.exemplar.height) +
                   area(asset.tile_side + reach, asset.tile_side + reach));
    if (options.choice == Choice::typed)
        bytes += (options.types == 0 ? 4096 : options.types) * (asset.patches.size() + 8000);
    else
        bytes += std::size_t{100} * asset.patches.size() * (ExchangeAsset::max_contents + 1);
    return bytes;
}

std::shared_ptr<const ExchangeTexture> make_exchange_texture(const ExchangeAsset& asset,
                                                             const ExchangeOptions& options) {
    return std::make_shared<ContentExchangeTexture>(asset, options);
}

}  // namespace tessera
