#include <algorithm>

#include "server/texture/exchange_texture.h"
#include "shared/math/srgb.h"

namespace tessera {
void CompiledExchange::Rows::put(std::int32_t y, std::int32_t x, const float* rgb, std::int32_t width,
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

Result<Evaluation> CompiledExchange::evaluate(const TexelRegion& region, const Budget& budget,
                                              LinearImage& out) const {
    out = LinearImage{region.width, region.height};
    return evaluate_blocks(region, budget, {.linear = &out});
}

Result<Evaluation> CompiledExchange::evaluate(const TexelRegion& region, const Budget& budget,
                                              Rgba8Image& out) const {
    if (kind_of_texels_ == TexelKind::data) return Texture::evaluate(region, budget, out);
    if (out.width != region.width || out.height != region.height)
        out = Rgba8Image{region.width, region.height};
    return evaluate_blocks(region, budget, {.codes = &out});
}

Result<Evaluation> CompiledExchange::evaluate_blocks(const TexelRegion& region, const Budget& budget,
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

Result<Evaluation> CompiledExchange::evaluate_block(const Block& block, const Budget& budget,
                                                    const Rows& rows) const {
    if (block.level == 0) return blend_texels(block, budget, rows);
    if (layout_->choice == Choice::typed) {
        if (block.level >= layout_->unit_level) return look_up_nodes(block, budget, rows);
        for (const VariantImages& images : images_)
            if (images.level() == block.level) return sum_variants(images, block, budget, rows);
    }
    if (block.level <= layout_->tile_level) return sum_stamps(block, budget, rows);
    return independent_sums_ ? enumerate_or_expect(block, budget, rows)
                             : descend_or_expect(block, budget, rows);
}

UnitGrid CompiledExchange::shown_in(const Block& block) const {
    const int shift = layout_->unit_level - block.level;
    // A texel of the overhang's width before the block may still reach into it
    const std::int64_t overhang = (layout_->overhang + (std::int64_t{1} << block.level) - 1) >> block.level;
    const std::int64_t x = (block.x - overhang) >> shift, y = (block.y - overhang) >> shift;
    const std::int64_t after = layout_->units_after();
    return layout_->shown_by(x, y, ((block.x + block.width - 1) >> shift) + after - x + 1,
                             ((block.y + block.height - 1) >> shift) + after - y + 1);
}

double CompiledExchange::float_bound_codes() const {
    return 255.0 / (1 << 24) * (4.0 * static_cast<double>(std::min<std::size_t>(most_shown_, 256)) + 40);
}

namespace {

/// Rows that are summed together: few enough that they stay in a near cache, many enough that a stamp is
/// looked up once for most of its rows, and these are fewer on coarser levels.
constexpr std::int32_t rows_together(int level) { return 16 << std::min(level, 2); }

}  // namespace

Result<Evaluation> CompiledExchange::sum_stamps(const Block& block, const Budget& budget,
                                                const Rows& rows) const {
    const Kernels& kernel = kernels();
    const ExchangeLayout& layout = *layout_;
    const Stamps::Level& stamps = stamps_.level(block.level);
    const std::int64_t tile_side = tile_levels_.side(block.level);
    const int unit_shift = layout.unit_level - block.level;
    const std::ptrdiff_t stride = std::ptrdiff_t{block.width} * 3;
    UnitGrid shown = shown_in(block);
    const std::int32_t band_rows = rows_together(block.level);
    std::vector<float> rgb(std::size_t(stride) * std::size_t(std::min(band_rows, block.height)) +
                           Stamps::row_floats);
    std::uint64_t work = 0;
    for (std::int32_t first = 0; first < block.height; first += band_rows) {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        const std::int32_t count = std::min(band_rows, block.height - first);
        for (std::int32_t row = 0; row < count; ++row)
            tile_levels_.fill(block.level, block.x, block.y + first + row, block.width,
                              rgb.data() + row * stride);
        for (std::int64_t uy = shown.y; uy < shown.y + shown.height; ++uy)
            for (std::int64_t ux = shown.x; ux < shown.x + shown.width; ++ux) {
                const std::int64_t unit_x = (ux << unit_shift) - block.x;
                const std::int64_t unit_y = (uy << unit_shift) - block.y - first;
                // Coarse texels reach a little further than the shapes in them
                const std::int64_t slack = std::int64_t{1} << block.level;
                for (const Shown& one : layout.rows_of(shown.at(ux, uy), (-unit_y << block.level) - slack,
                                                       ((count - unit_y) << block.level) + slack)) {
                    const Stamps::Stamp& stamp = stamps.stamps[one.shape];
                    const std::int64_t y = unit_y + one.tile_y * tile_side + stamp.y;
                    const std::int64_t from = std::max<std::int64_t>(y, 0);
                    const std::int64_t to = std::min<std::int64_t>(y + stamp.rows, count);
                    if (from >= to) continue;
                    work += kernel.add_spans(stamps.spans.data() + stamp.first_span + (from - y),
                                             static_cast<std::int32_t>(to - from), stamps.values.data(),
                                             unit_x + one.tile_x * tile_side, block.width,
                                             rgb.data() + from * stride, stride);
                }
            }
        for (std::int32_t row = 0; row < count; ++row)
            rows.put(block.out_y + first + row, block.out_x, rgb.data() + row * stride, block.width, kernel);
    }
    return Evaluation{.method = "stamps", .bound_codes = float_bound_codes(), .work = work};
}

Result<Evaluation> CompiledExchange::sum_variants(const VariantImages& images, const Block& block,
                                                  const Budget& budget, const Rows& rows) const {
    const Kernels& kernel = kernels();
    const std::int64_t side = images.unit_side();
    const int shift = layout_->unit_level - block.level;
    const std::int64_t first = (block.x >> shift) - 1, last = (block.x + block.width - 1) >> shift;
    const std::int64_t top = (block.y >> shift) - 1, bottom = (block.y + block.height - 1) >> shift;
    const TypeGrid types = layout_->tree->types_of(0, first, top, static_cast<std::int32_t>(last - first + 1),
                                                   static_cast<std::int32_t>(bottom - top + 1));
    std::vector<float> rgb(std::size_t(block.width) * 3);
    for (std::int32_t row = 0; row < block.height; ++row) {
        if (row % 16 == 0)
            if (auto spent = check_budget(budget); !spent) return spent.error();
        const std::int64_t y = block.y + row, unit_y = y >> shift;
        const auto in_unit = static_cast<std::int32_t>(y & (side - 1));
        Kernels::VariantRow work;
        work.types = types.row(unit_y) + (first - types.x);
        work.types_above = types.row(unit_y - 1) + (first - types.x);
        work.unit_count = static_cast<std::size_t>(last - first + 1);
        work.first_x = first * side - block.x;
        work.image = images.row(0, in_unit);
        work.image_above = in_unit + side < images.side()
                               ? images.row(0, in_unit + static_cast<std::int32_t>(side))
                               : nullptr;
        work.image_side = images.side();
        work.image_stride = std::size_t(images.side()) * std::size_t(images.side()) * 3;
        work.unit_side = images.unit_side();
        work.width = block.width;
        tile_levels_.fill(std::min(block.level, layout_->tile_level), block.x, y, block.width, rgb.data());
        kernel.add_variants(work, rgb.data());
        rows.put(block.out_y + row, block.out_x, rgb.data(), block.width, kernel);
    }
    return Evaluation{.method = "variants",
                      .bound_codes = float_bound_codes(),
                      .work = static_cast<std::uint64_t>((last - first + 1) * (bottom - top + 1))};
}

Result<Evaluation> CompiledExchange::look_up_nodes(const Block& block, const Budget& budget,
                                                   const Rows& rows) const {
    const Kernels& kernel = kernels();
    const int height = block.level - layout_->unit_level;
    const TypeGrid types =
        layout_->tree->types_of(height, block.x - 1, block.y - 1, block.width + 1, block.height + 1);
    const std::ptrdiff_t column = block.x - 1 - types.x;
    std::vector<float> rgb(std::size_t(block.width) * 3);
    for (std::int32_t row = 0; row < block.height; ++row) {
        if (row % 16 == 0)
            if (auto spent = check_budget(budget); !spent) return spent.error();
        tile_levels_.fill(layout_->tile_level, 0, 0, block.width, rgb.data());
        kernel.add_nodes(nodes_->at(height), types.row(block.y + row) + column,
                         types.row(block.y + row - 1) + column, block.width, rgb.data());
        rows.put(block.out_y + row, block.out_x, rgb.data(), block.width, kernel);
    }
    return Evaluation{.method = "quadtree",
                      .bound_codes = float_bound_codes(),
                      .work = std::uint64_t(block.width) * std::uint64_t(block.height)};
}

/// As far as a texel costs no more than so many look-ups, some 4 ns each. A rule of height and accuracy
/// alone, so that every window shows the same texels.
bool CompiledExchange::enumerates(int height, Accuracy accuracy) const {
    const std::uint64_t look_ups = accuracy == Accuracy::exact ? 8192 : accuracy == Accuracy::high ? 1024 : 0;
    return height < 10 && (std::uint64_t{layout_->shapes.patch_count()} << (2 * height)) <= look_ups;
}

Result<Evaluation> CompiledExchange::enumerate_or_expect(const Block& block, const Budget& budget,
                                                         const Rows& rows) const {
    const Kernels& kernel = kernels();
    const IndependentSums& sums_of = *independent_sums_;
    const int height = block.level - layout_->tile_level;
    const bool enumerate = enumerates(height, budget.accuracy);
    const float* mean = tile_levels_.row(layout_->tile_level, 0);
    std::vector<float> rgb(std::size_t(block.width) * 3);
    std::vector<double> sums(rgb.size());
    for (std::int32_t row = 0; row < block.height; ++row) {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        if (enumerate) {
            std::fill(sums.begin(), sums.end(), 0.0);
            sums_of.add_enumerated(*layout_->independent, height, block.x, block.y + row, block.width,
                                   sums.data());
        } else {
            for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = sums_of.expectation()[i % 3];
        }
        for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = mean[i % 3] + static_cast<float>(sums[i]);
        rows.put(block.out_y + row, block.out_x, rgb.data(), block.width, kernel);
    }
    if (enumerate) {
        const double tiles = static_cast<double>(std::int64_t{1} << (2 * height));
        return Evaluation{.method = "enumeration",
                          .bound_codes = float_bound_codes(),
                          .work = static_cast<std::uint64_t>(tiles * block.width * block.height)};
    }
    const auto bound = sums_of.bound(height);
    return Evaluation{.method = "expectation",
                      .bound_codes = bound.likely / code_in_linear + float_bound_codes(),
                      .confidence = bound.likely < bound.certain ? IndependentSums::confidence : 1.0,
                      .work = 1};
}

Result<Evaluation> CompiledExchange::descend_or_expect(const Block& block, const Budget& budget,
                                                       const Rows& rows) const {
    const Kernels& kernel = kernels();
    const int height = block.level - layout_->tile_level;
    const int most = budget.accuracy == Accuracy::exact ? 2 : budget.accuracy == Accuracy::high ? 1 : 0;
    std::vector<float> rgb(std::size_t(block.width) * 3);
    if (height > most) {
        const float* mean = tile_levels_.row(layout_->tile_level, 0);
        double worst = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double expected = double{mean[c]} + expectation_[c];
            worst = std::max({worst, expected, 1 - expected});
        }
        for (std::size_t i = 0; i < rgb.size(); ++i)
            rgb[i] = static_cast<float>(double{mean[i % 3]} + expectation_[i % 3]);
        for (std::int32_t row = 0; row < block.height; ++row)
            rows.put(block.out_y + row, block.out_x, rgb.data(), block.width, kernel);
        // Nothing is known of how the formula's draws hang together, so only this is certain: texels are
        // colours
        return Evaluation{.method = "expectation", .bound_codes = worst / code_in_linear, .work = 1};
    }
    // Row by row from where tiles are single texels
    const std::int32_t side = 1 << height;
    std::uint64_t work = 0;
    for (std::int32_t row = 0; row < block.height; ++row) {
        LinearImage fine{block.width * side, side};
        const Block below{
            layout_->tile_level, block.x * side, (block.y + row) * side, block.width * side, side, 0, 0};
        const auto summed = sum_stamps(below, budget, {.linear = &fine});
        if (!summed) return summed.error();
        work += summed->work;
        for (std::int32_t x = 0; x < block.width; ++x)
            for (std::int32_t c = 0; c < 3; ++c) {
                double sum = 0;
                for (std::int32_t v = 0; v < side; ++v)
                    for (std::int32_t u = 0; u < side; ++u)
                        sum += double{fine.row(v)[(x * side + u) * 4 + c]};
                rgb[std::size_t(x * 3 + c)] = static_cast<float>(sum / (side * side));
            }
        rows.put(block.out_y + row, block.out_x, rgb.data(), block.width, kernel);
    }
    return Evaluation{.method = "descent", .bound_codes = float_bound_codes(), .work = work};
}

}  // namespace tessera
