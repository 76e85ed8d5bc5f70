#include "server/texture/content_exchange.h"

#include <algorithm>
#include <bit>
#include <iomanip>
#include <optional>
#include <sstream>

#include "server/texture/independent_choice.h"
#include "server/texture/kernels.h"
#include "server/texture/level_0.h"
#include "server/texture/variants.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// Tiles of at most this many texels are summed from one image a tile instead of one stamp a patch.
constexpr std::int32_t variant_image_side = 8;

/// A patch that hangs over a border reaches one tile further, never two: see PatchMap.
constexpr std::int64_t reach = 1;

/// Runs of level 0 are short and lie anywhere in the exemplar: no processor guesses what comes next, but it
/// is the same columns some rows further down.
constexpr std::size_t prefetch_rows = 3;
void prefetch(const void* first, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes + 63; i += 64) __builtin_prefetch(static_cast<const char*>(first) + i);
}

/// Where finished rows go: as linear texels, or as the codes that pages carry.
struct Rows {
    LinearImage* linear = nullptr;
    Rgba8Image* codes = nullptr;

    void put(std::int32_t y, std::int32_t x, const float* rgb, std::int32_t width,
             const Kernels& kernels) const {
        if (codes != nullptr) {
            kernels.encode(rgb, width, codes->row(y) + x * 4);
            return;
        }
        float* out = linear->row(y) + std::ptrdiff_t(x) * 4;
        for (std::int32_t i = 0; i < width; ++i) {
            std::copy_n(rgb + i * 3, 3, out + i * 4);
            out[i * 4 + 3] = 1.0F;
        }
    }
};

ColorSteps mean_of(const Rgb8Image& tile) {
    ColorSteps mean{};
    for (std::size_t i = 0; i < tile.bytes.size(); ++i) mean[i % 3] += srgb_to_steps[tile.bytes[i]];
    for (double& channel : mean) channel /= static_cast<double>(tile.bytes.size() / 3);
    return mean;
}

std::int32_t blend_radius(const ContentExchangeAsset& asset, const ContentExchangeOptions& options) {
    return options.blended ? asset.blend_texels / 2 : 0;
}

/// Contents of all patches for a rectangle of tiles.
class TileContents {
  public:
    TileContents(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height)
        : x_{x}, y_{y}, width_{width}, tiles_(static_cast<std::size_t>(width * height)) {}

    const std::uint8_t*& at(std::int64_t x, std::int64_t y) {
        return tiles_[static_cast<std::size_t>((y - y_) * width_ + (x - x_))];
    }
    std::vector<std::uint8_t>& storage() { return storage_; }

  private:
    std::int64_t x_, y_, width_;
    std::vector<const std::uint8_t*> tiles_;
    std::vector<std::uint8_t> storage_;  ///< Where contents are made for this page and not kept in a table.
};

class ContentExchangeTexture final : public Texture {
  public:
    ContentExchangeTexture(const ContentExchangeAsset& asset, const ContentExchangeOptions& options)
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
        tree_.emplace(options.seed, options.types);
        variants_.emplace(options.seed, options.types, texels_);
        for (int level = 0; level <= tile_level_; ++level)
            if (map_.levels()[std::size_t(level)].side <= variant_image_side)
                images_.push_back(VariantImages{level, map_, stamps_, *variants_});
        nodes_.emplace(max_level - tile_level_, images_.back(), *tree_);
    }

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        out = LinearImage{region.width, region.height};
        return evaluate_blocks(region, budget, {.linear = &out});
    }
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                Rgba8Image& out) const override {
        if (out.width != region.width || out.height != region.height)
            out = Rgba8Image{region.width, region.height};
        return evaluate_blocks(region, budget, {.codes = &out});
    }

    std::string_view kind() const noexcept override { return "content_exchange"; }
    std::string description() const override;
    std::size_t memory_bytes() const noexcept override {
        std::size_t bytes =
            map_.memory_bytes() + texels_.memory_bytes() + stamps_.memory_bytes() + level_0_.memory_bytes();
        if (tree_) bytes += tree_->memory_bytes() + variants_->memory_bytes() + nodes_->memory_bytes();
        for (const VariantImages& images : images_) bytes += images.memory_bytes();
        if (independent_) bytes += independent_->memory_bytes();
        return bytes;
    }

  private:
    /// A block of the region: its first texel, its place in the output.
    struct Block {
        int level = 0;
        std::int64_t x = 0, y = 0;
        std::int32_t width = 0, height = 0;
        std::int32_t out_x = 0, out_y = 0;
    };

    /// Blocks bound what an evaluation holds beside its answer, whatever the region.
    Result<Evaluation> evaluate_blocks(const TexelRegion& region, const Budget& budget,
                                       const Rows& rows) const {
        constexpr std::int32_t block_side = page_side_texels + 2 * max_gutter_texels;
        Evaluation all;
        for (std::int32_t y = 0; y < region.height; y += block_side)
            for (std::int32_t x = 0; x < region.width; x += block_side) {
                const Block block{region.level,
                                  region.x + x,
                                  region.y + y,
                                  std::min(block_side, region.width - x),
                                  std::min(block_side, region.height - y),
                                  x,
                                  y};
                auto part = evaluate_block(block, budget, rows);
                if (!part) return part.error();
                all.method = part->method;
                all.bound_codes = std::max(all.bound_codes, part->bound_codes);
                all.confidence = std::min(all.confidence, part->confidence);
                all.work += part->work;
            }
        return all;
    }

    Result<Evaluation> evaluate_block(const Block& block, const Budget& budget, const Rows& rows) const {
        if (block.level == 0) return blend_exemplar(block, budget, rows);
        if (independent_) {
            if (block.level <= tile_level_) return sum_stamps(block, budget, rows);
            return enumerate_or_expect(block, budget, rows);
        }
        if (block.level >= tile_level_) return look_up_nodes(block, budget, rows);
        if (map_.levels()[std::size_t(block.level)].side <= variant_image_side)
            return sum_variants(block, budget, rows);
        return sum_stamps(block, budget, rows);
    }

    /// The contents of the tiles that a block meets, with the tiles before them, whose patches hang over into
    /// it.
    TileContents contents_for(const Block& block, int tile_shift) const {
        const std::int64_t x = (block.x >> tile_shift) - reach, y = (block.y >> tile_shift) - reach;
        const std::int64_t width = ((block.x + block.width - 1) >> tile_shift) - x + 1;
        const std::int64_t height = ((block.y + block.height - 1) >> tile_shift) - y + 1;
        TileContents contents{x, y, width, height};
        if (independent_) {
            contents.storage().resize(static_cast<std::size_t>(width * height) * texels_.patch_count());
            std::uint8_t* next = contents.storage().data();
            for (std::int64_t row = y; row < y + height; ++row)
                for (std::int64_t column = x; column < x + width; ++column, next += texels_.patch_count()) {
                    independent_->contents_of(column, row, next);
                    contents.at(column, row) = next;
                }
            return contents;
        }
        const TypeGrid types =
            tree_->types_of(0, x, y, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height));
        for (std::int64_t row = y; row < y + height; ++row)
            for (std::int64_t column = x; column < x + width; ++column)
                contents.at(column, row) = variants_->contents(types.at(column, row));
        return contents;
    }

    /// Whether choices under texels of 2^height tiles are summed one by one: as far as a texel costs no more
    /// than so many look-ups, some 4 ns each. A rule of height and accuracy alone, so that every window shows
    /// the same texels.
    bool enumerates(int height, Accuracy accuracy) const {
        const std::uint64_t look_ups = accuracy == Accuracy::exact  ? 8192
                                       : accuracy == Accuracy::high ? 1024
                                                                    : 0;
        return height < 10 && (std::uint64_t{texels_.patch_count()} << (2 * height)) <= look_ups;
    }

    /// Rounding of floats of magnitude one, a sum for each patch that a texel may meet, in codes of linear
    /// light.
    double float_bound_codes() const {
        return 255.0 / (1 << 24) * (4.0 * static_cast<double>(texels_.patch_count()) + 40);
    }

    void fill_with_mean(std::vector<float>& rgb) const {
        for (std::size_t i = 0; i < rgb.size(); i += 3)
            std::copy_n(mean_linear_.begin(), 3, rgb.begin() + std::ptrdiff_t(i));
    }

    Result<Evaluation> blend_exemplar(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> sum_stamps(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> sum_variants(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> look_up_nodes(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> enumerate_or_expect(const Block&, const Budget&, const Rows&) const;

    PatchMap map_;
    ExemplarTexels texels_;
    ColorSteps mean_;
    std::array<float, 3> mean_linear_{};
    Stamps stamps_;
    Level0 level_0_;
    int tile_level_;  ///< Where the tile is one texel.

    // choice: typed
    std::optional<TypedQuadtree> tree_;
    std::optional<Variants> variants_;
    std::vector<VariantImages>
        images_;  ///< Of the levels where the tile is variant_image_side, …, 2, 1 texels.
    std::optional<NodeTables> nodes_;
    // choice: independent
    std::optional<IndependentChoice> independent_;
};

Result<Evaluation> ContentExchangeTexture::blend_exemplar(const Block& block, const Budget& budget,
                                                          const Rows& rows) const {
    const Kernels& kernel = kernels();
    const int shift = tile_level_;
    const std::int64_t side = map_.side();
    TileContents contents = contents_for(block, shift);
    std::vector<std::uint32_t> sums(std::size_t(block.width + 16) * 4);
    std::vector<Kernels::BlendTerm> terms(texels_.patch_count());
    std::uint64_t work = 0;

    for (std::int32_t row = 0; row < block.height; ++row) {
        if (row % 16 == 0)
            if (auto spent = check_budget(budget); !spent) return spent.error();
        const std::int64_t y = block.y + row, tile_y = y >> shift;
        const auto runs = level_0_.row(static_cast<std::int32_t>(y & (side - 1)));
        for (std::int64_t tile_x = block.x >> shift; tile_x <= (block.x + block.width - 1) >> shift;
             ++tile_x) {
            // Column of the tile under the block's first column
            const std::int64_t origin = block.x - tile_x * side;
            auto run = std::partition_point(runs.begin(), runs.end(),
                                            [&](const Level0::Run& r) { return r.end <= origin; });
            for (; run != runs.end() && run->begin < origin + block.width; ++run, ++work) {
                const std::int32_t skip =
                    static_cast<std::int32_t>(std::max<std::int64_t>(origin - run->begin, 0));
                const std::int32_t at = static_cast<std::int32_t>(run->begin + skip - origin);
                const std::int32_t width = std::min(run->end - run->begin - skip, block.width - at);
                const Level0::Term* term = level_0_.terms(*run);
                const auto source_of = [&](const Level0::Term& t) {
                    const std::uint8_t content = contents.at(tile_x - t.left, tile_y - t.above)[t.patch];
                    const auto& from = texels_.content(t.patch, content);
                    return std::pair{from.source, from.offset +
                                                      std::size_t(t.y) * std::size_t(from.source->width) +
                                                      std::size_t(t.x + skip)};
                };
                if (run->terms == 1 && rows.codes != nullptr) {
                    const auto [source, offset] = source_of(*term);
                    prefetch(source->codes.data() + (offset + prefetch_rows * std::size_t(source->width)) * 4,
                             std::size_t(width) * 4);
                    std::copy_n(source->codes.data() + offset * 4, width * 4,
                                rows.codes->row(block.out_y + row) + std::ptrdiff_t(block.out_x + at) * 4);
                    continue;
                }
                static constexpr std::uint16_t whole[] = {PatchMap::weight_one};
                for (std::uint32_t t = 0; t < run->terms; ++t) {
                    const auto [source, offset] = source_of(term[t]);
                    terms[t].steps = source->steps.data() + offset * 4;
                    prefetch(source->steps.data() + (offset + prefetch_rows * std::size_t(source->width)) * 4,
                             std::size_t(width) * 8);
                    terms[t].weights =
                        run->terms == 1 ? whole : level_0_.weights(term[t]) + std::ptrdiff_t(skip) * 4;
                }
                if (run->terms == 1) {
                    for (std::int32_t i = 0; i < width * 4; ++i)
                        sums[std::size_t(i)] = std::uint32_t{terms[0].steps[i]} * PatchMap::weight_one;
                } else {
                    kernel.blend(terms.data(), run->terms, width, sums.data());
                }
                if (rows.codes != nullptr) {
                    kernel.encode_sums(
                        sums.data(), width,
                        rows.codes->row(block.out_y + row) + std::ptrdiff_t(block.out_x + at) * 4);
                } else {
                    float* out = rows.linear->row(block.out_y + row) + std::ptrdiff_t(block.out_x + at) * 4;
                    for (std::int32_t i = 0; i < width * 4; ++i)
                        out[i] =
                            static_cast<float>(sums[std::size_t(i)]) / (linear_one * PatchMap::weight_one);
                }
            }
        }
    }
    return Evaluation{.method = "exemplar", .work = work};
}

Result<Evaluation> ContentExchangeTexture::sum_stamps(const Block& block, const Budget& budget,
                                                      const Rows& rows) const {
    const Kernels& kernel = kernels();
    const PatchMap::Level& level = map_.levels()[std::size_t(block.level)];
    const Stamps::Level& stamps = stamps_.level(block.level);
    const int shift = tile_level_ - block.level;
    TileContents contents = contents_for(block, shift);
    std::vector<Kernels::StampTile> tiles;
    std::vector<float> rgb(std::size_t(block.width) * 3);
    std::uint64_t work = 0;

    for (std::int32_t row = 0; row < block.height; ++row) {
        if (row % 16 == 0)
            if (auto spent = check_budget(budget); !spent) return spent.error();
        const std::int64_t y = block.y + row, tile_y = y >> shift;
        if (tiles.empty() || (y & (level.side - 1)) == 0) {
            tiles.clear();
            for (std::int64_t x = (block.x >> shift) - reach; x <= (block.x + block.width - 1) >> shift; ++x)
                tiles.push_back(
                    {x * level.side - block.x, contents.at(x, tile_y), contents.at(x, tile_y - 1)});
        }
        const auto spans = level.row(static_cast<std::int32_t>(y & (level.side - 1)));
        const auto above = level.row(static_cast<std::int32_t>(y & (level.side - 1)) + level.side);
        fill_with_mean(rgb);
        work += kernel.add_stamps({.tiles = tiles.data(),
                                   .tile_count = tiles.size(),
                                   .spans = spans.data(),
                                   .spans_end = spans.data() + spans.size(),
                                   .spans_above = above.data(),
                                   .spans_above_end = above.data() + above.size(),
                                   .values = stamps.values.data(),
                                   .patch_begin = stamps.patch_begin.data(),
                                   .content_stride = stamps.content_stride.data(),
                                   .width = block.width},
                                  rgb.data());
        rows.put(block.out_y + row, block.out_x, rgb.data(), block.width, kernel);
    }
    return Evaluation{.method = "stamps", .bound_codes = float_bound_codes(), .work = work};
}

Result<Evaluation> ContentExchangeTexture::sum_variants(const Block& block, const Budget& budget,
                                                        const Rows& rows) const {
    const Kernels& kernel = kernels();
    const VariantImages& images =
        *std::find_if(images_.begin(), images_.end(), [&](const VariantImages& candidate) {
            return candidate.tile_side() == map_.levels()[std::size_t(block.level)].side;
        });
    const std::int64_t side = images.tile_side();
    const int shift = tile_level_ - block.level;
    const std::int64_t first = (block.x >> shift) - reach, last = (block.x + block.width - 1) >> shift;
    const std::int64_t top = (block.y >> shift) - reach, bottom = (block.y + block.height - 1) >> shift;
    const TypeGrid types = tree_->types_of(0, first, top, static_cast<std::int32_t>(last - first + 1),
                                           static_cast<std::int32_t>(bottom - top + 1));
    std::vector<float> rgb(std::size_t(block.width) * 3);
    for (std::int32_t row = 0; row < block.height; ++row) {
        if (row % 16 == 0)
            if (auto spent = check_budget(budget); !spent) return spent.error();
        const std::int64_t y = block.y + row, tile_y = y >> shift;
        const auto in_tile = static_cast<std::int32_t>(y & (side - 1));
        Kernels::VariantRow work;
        work.types = types.row(tile_y) + (first - types.x);
        work.types_above = types.row(tile_y - 1) + (first - types.x);
        work.tile_count = static_cast<std::size_t>(last - first + 1);
        work.first_x = first * side - block.x;
        work.image = images.row(0, in_tile);
        work.image_above = in_tile + side < images.side()
                               ? images.row(0, in_tile + static_cast<std::int32_t>(side))
                               : nullptr;
        work.image_side = images.side();
        work.image_stride = std::size_t(images.side()) * std::size_t(images.side()) * 3;
        work.tile_side = images.tile_side();
        work.width = block.width;
        fill_with_mean(rgb);
        kernel.add_variants(work, rgb.data());
        rows.put(block.out_y + row, block.out_x, rgb.data(), block.width, kernel);
    }
    return Evaluation{.method = "variants",
                      .bound_codes = float_bound_codes(),
                      .work = static_cast<std::uint64_t>((last - first + 1) * (bottom - top + 1))};
}

Result<Evaluation> ContentExchangeTexture::look_up_nodes(const Block& block, const Budget& budget,
                                                         const Rows& rows) const {
    const Kernels& kernel = kernels();
    const int height = block.level - tile_level_;
    const TypeGrid types =
        tree_->types_of(height, block.x - reach, block.y - reach, block.width + 1, block.height + 1);
    const std::ptrdiff_t column = block.x - reach - types.x;
    std::vector<float> rgb(std::size_t(block.width) * 3);
    for (std::int32_t row = 0; row < block.height; ++row) {
        if (row % 16 == 0)
            if (auto spent = check_budget(budget); !spent) return spent.error();
        fill_with_mean(rgb);
        kernel.add_nodes(nodes_->at(height), types.row(block.y + row) + column,
                         types.row(block.y + row - 1) + column, block.width, rgb.data());
        rows.put(block.out_y + row, block.out_x, rgb.data(), block.width, kernel);
    }
    return Evaluation{.method = "quadtree",
                      .bound_codes = float_bound_codes(),
                      .work = std::uint64_t(block.width) * std::uint64_t(block.height)};
}

Result<Evaluation> ContentExchangeTexture::enumerate_or_expect(const Block& block, const Budget& budget,
                                                               const Rows& rows) const {
    const Kernels& kernel = kernels();
    const int height = block.level - tile_level_;
    const bool enumerate = enumerates(height, budget.accuracy);
    std::vector<float> rgb(std::size_t(block.width) * 3);
    std::vector<double> sums(rgb.size());
    for (std::int32_t row = 0; row < block.height; ++row) {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        if (enumerate) {
            std::fill(sums.begin(), sums.end(), 0.0);
            independent_->add_enumerated(height, block.x, block.y + row, block.width, sums.data());
        } else {
            for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = independent_->expectation()[i % 3];
        }
        for (std::size_t i = 0; i < rgb.size(); ++i)
            rgb[i] = mean_linear_[i % 3] + static_cast<float>(sums[i]);
        rows.put(block.out_y + row, block.out_x, rgb.data(), block.width, kernel);
    }
    if (enumerate) {
        const double tiles = static_cast<double>(std::int64_t{1} << (2 * height));
        return Evaluation{.method = "enumeration",
                          .bound_codes = float_bound_codes(),
                          .work = static_cast<std::uint64_t>(tiles * block.width * block.height)};
    }
    const auto bound = independent_->bound(height);
    return Evaluation{.method = "expectation",
                      .bound_codes = bound.likely / code_in_linear + float_bound_codes(),
                      .confidence = bound.likely < bound.certain ? IndependentChoice::confidence : 1.0,
                      .work = 1};
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

}  // namespace

std::size_t content_exchange_bytes(const ContentExchangeAsset& asset, const ContentExchangeOptions& options) {
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
        bytes += options.types * (asset.patches.size() + 8000);
    else
        bytes += std::size_t{100} * asset.patches.size() * (ContentExchangeAsset::max_contents + 1);
    return bytes;
}

std::shared_ptr<const Texture> make_content_exchange_texture(const ContentExchangeAsset& asset,
                                                             const ContentExchangeOptions& options) {
    return std::make_shared<ContentExchangeTexture>(asset, options);
}

}  // namespace tessera
