#include <algorithm>

#include "server/texture/content_exchange_texture.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// A patch that hangs over a border reaches one tile further, never two: see PatchMap.
constexpr std::int64_t reach = 1;

/// Runs of level 0 are short and lie anywhere in the exemplar: no processor guesses what comes next, but it
/// is the same columns some rows further down.
constexpr std::size_t prefetch_rows = 3;
void prefetch(const void* first, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes + 63; i += 64) __builtin_prefetch(static_cast<const char*>(first) + i);
}

}  // namespace

Result<Evaluation> ContentExchangeTexture::evaluate_blocks(const TexelRegion& region, const Budget& budget,
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

Result<Evaluation> ContentExchangeTexture::evaluate_block(const Block& block, const Budget& budget,
                                                          const Rows& rows) const {
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

TileContents ContentExchangeTexture::contents_for(const Block& block, int tile_shift) const {
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

bool ContentExchangeTexture::enumerates(int height, Accuracy accuracy) const {
    const std::uint64_t look_ups = accuracy == Accuracy::exact ? 8192 : accuracy == Accuracy::high ? 1024 : 0;
    return height < 10 && (std::uint64_t{texels_.patch_count()} << (2 * height)) <= look_ups;
}

double ContentExchangeTexture::float_bound_codes() const {
    return 255.0 / (1 << 24) * (4.0 * static_cast<double>(texels_.patch_count()) + 40);
}

void ContentExchangeTexture::fill_with_mean(std::vector<float>& rgb) const {
    for (std::size_t i = 0; i < rgb.size(); i += 3)
        std::copy_n(mean_linear_.begin(), 3, rgb.begin() + std::ptrdiff_t(i));
}

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

}  // namespace tessera
