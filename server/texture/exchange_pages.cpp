#include <algorithm>
#include <memory>

#include "server/texture/exchange_walk.h"
#include "server/texture/kernels.h"
#include "shared/math/srgb.h"

namespace tessera {

ExchangeWalk::ExchangeWalk(const ExchangeLayout& layout, const ExchangeTexels& source, Rgba8Image& codes)
    : layout_{layout}, source_list_{&source}, sources_{source_list_, 1}, codes_{&codes} {}

ExchangeWalk::ExchangeWalk(const ExchangeLayout& layout, std::span<const ExchangeTexels* const> sources,
                           const TakeRow& take_row)
    : layout_{layout}, sources_{sources}, take_row_{&take_row} {}

Result<Evaluation> ExchangeWalk::evaluate(const TexelRegion& region, const Budget& budget) const {
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
            auto part = evaluate_block(block, budget);
            if (!part) return part.error();
            all.method = part->method;
            all.bound_codes = std::max(all.bound_codes, part->bound_codes);
            all.confidence = std::min(all.confidence, part->confidence);
            all.work += part->work;
        }
    return all;
}

Result<Evaluation> ExchangeWalk::evaluate_block(const Block& block, const Budget& budget) const {
    if (block.level == 0 && block.width * block.height == 1 && codes_ != nullptr && layout_.tree)
        return one_texel(block, budget);
    if (block.level == 0) return codes_ != nullptr ? blend_codes(block, budget) : blend_linear(block, budget);
    if (layout_.choice == Choice::typed) {
        if (block.level >= layout_.unit_level) return look_up_nodes(block, budget);
        // The same for all sources: shapes decide how large images are
        const std::vector<VariantImages>& images = sources_[0]->images;
        for (std::size_t i = 0; i < images.size(); ++i)
            if (images[i].level() == block.level) return sum_variants(i, block, budget);
    }
    if (block.level <= layout_.tile_level) return sum_stamps(block, budget);
    return layout_.independent ? enumerate_or_expect(block, budget) : descend_or_expect(block, budget);
}

void ExchangeWalk::put(const Block& block, std::int32_t first, std::int32_t count, SumRows& sums) const {
    for (std::int32_t row = 0; row < count; ++row) {
        const std::int32_t y = block.out_y + first + row;
        if (codes_ != nullptr) {
            kernels().encode(sums.row(0, row), block.width, codes_->row(y) + std::ptrdiff_t{block.out_x} * 4);
            continue;
        }
        const float* values[most_sources] = {};
        for (std::size_t s = 0; s < sources_.size(); ++s) values[s] = sums.row(s, row);
        (*take_row_)(block.out_x, y, block.width, values);
    }
}

double ExchangeWalk::float_bound_codes() const {
    return 255.0 / (1 << 24) *
           (4.0 * static_cast<double>(std::min<std::size_t>(layout_.most_shown, 256)) + 40);
}

namespace {

/// Rows that are summed together: few enough that they stay in a near cache, many enough that a stamp is
/// looked up once for most of its rows, and these are fewer on coarser levels.
constexpr std::int32_t rows_together(int level) { return 16 << std::min(level, 2); }

/// Small stamps lie where no processor guesses them: where one's rows are is fetched first, and then what
/// they hold.
void fetch_spans(const StampSpans::Level& level, std::size_t shape) {
    __builtin_prefetch(level.spans.data() + level.stamps[shape].first_span);
}
void fetch_box(const StampSpans::Level& level, std::size_t shape, const float* values) {
    constexpr std::ptrdiff_t line = 64 / sizeof(float);
    const StampSpans::Stamp& stamp = level.stamps[shape];
    if (!stamp.box) return;
    const StampSpans::Span& span = level.spans[stamp.first_span];
    const float* first = values + std::size_t{span.offset} * StampSpans::row_floats;
    const std::ptrdiff_t floats = std::ptrdiff_t{span.end - span.begin} * 3 * stamp.rows;
    for (std::ptrdiff_t i = 0; i < floats; i += line) __builtin_prefetch(first + i);
}

}  // namespace

Result<Evaluation> ExchangeWalk::sum_stamps(const Block& block, const Budget& budget) const {
    const Kernels& kernel = kernels();
    const StampSpans::Level& spans = layout_.spans.level(block.level);
    const std::int64_t tile_side = std::int64_t{layout_.tile_side} >> block.level;
    const int unit_shift = layout_.unit_level - block.level;
    UnitGrid shown = layout_.shown_at(
        {static_cast<std::uint8_t>(block.level), block.x, block.y, block.width, block.height});
    const std::int32_t band_rows = std::min(rows_together(block.level), block.height);
    SumRows sums{sources_.size(), block.width, band_rows};
    std::uint64_t work = 0;
    for (std::int32_t first = 0; first < block.height; first += band_rows) {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        const std::int32_t count = std::min(band_rows, block.height - first);
        for (std::size_t s = 0; s < sources_.size(); ++s)
            for (std::int32_t row = 0; row < count; ++row)
                sources_[s]->tile_levels.fill(block.level, block.x, block.y + first + row, block.width,
                                              sums.row(s, row));
        for (std::int64_t uy = shown.y; uy < shown.y + shown.height; ++uy)
            for (std::int64_t ux = shown.x; ux < shown.x + shown.width; ++ux) {
                const std::int64_t unit_x = (ux << unit_shift) - block.x;
                const std::int64_t unit_y = (uy << unit_shift) - block.y - first;
                // Coarse texels reach a little further than the shapes in them
                const std::int64_t slack = std::int64_t{1} << block.level;
                const std::span<const Shown> list =
                    layout_.rows_of(shown.at(ux, uy), (-unit_y << block.level) - slack,
                                    ((count - unit_y) << block.level) + slack);
                for (std::size_t i = 0; i < list.size(); ++i) {
                    if (i + 4 < list.size()) fetch_spans(spans, list[i + 4].shape);
                    if (i + 2 < list.size())
                        for (const ExchangeTexels* source : sources_)
                            fetch_box(spans, list[i + 2].shape, source->stamps.values(block.level));
                    const Shown& one = list[i];
                    const StampSpans::Stamp& stamp = spans.stamps[one.shape];
                    const std::int64_t y = unit_y + one.tile_y * tile_side + stamp.y;
                    const std::int64_t from = std::max<std::int64_t>(y, 0);
                    const std::int64_t to = std::min<std::int64_t>(y + stamp.rows, count);
                    if (from >= to) continue;
                    const StampSpans::Span* first_span = spans.spans.data() + stamp.first_span + (from - y);
                    const std::int64_t x = unit_x + one.tile_x * tile_side;
                    const auto rows = static_cast<std::int32_t>(to - from);
                    if (stamp.box && x + first_span->begin >= 0 && x + first_span->end <= block.width) {
                        const std::int32_t across = first_span->end - first_span->begin;
                        for (std::size_t s = 0; s < sources_.size(); ++s)
                            kernel.add_box(
                                sources_[s]->stamps.row(block.level, *first_span),
                                (across * 3 + StampSpans::row_floats - 1) / StampSpans::row_floats, rows,
                                sums.row(s, static_cast<std::int32_t>(from)) + (x + first_span->begin) * 3,
                                sums.stride());
                        work += sources_.size() * std::size_t(across * rows);
                        continue;
                    }
                    for (std::size_t s = 0; s < sources_.size(); ++s)
                        work += kernel.add_spans(first_span, rows, sources_[s]->stamps.values(block.level), x,
                                                 block.width, sums.row(s, static_cast<std::int32_t>(from)),
                                                 sums.stride());
                }
            }
        put(block, first, count, sums);
    }
    return Evaluation{.method = "stamps", .bound_codes = float_bound_codes(), .work = work};
}

Result<Evaluation> ExchangeWalk::sum_variants(std::size_t image, const Block& block,
                                              const Budget& budget) const {
    constexpr std::int32_t band_rows = 16;
    const std::int32_t side = sources_[0]->images[image].unit_side();
    const int shift = layout_.unit_level - block.level;
    const std::int64_t first = (block.x >> shift) - 1, last = (block.x + block.width - 1) >> shift;
    const std::int64_t top = (block.y >> shift) - 1, bottom = (block.y + block.height - 1) >> shift;
    const TypeGrid types = layout_.tree->types_of(0, first, top, static_cast<std::int32_t>(last - first + 1),
                                                  static_cast<std::int32_t>(bottom - top + 1));
    // Room for whole images of the outermost units
    const auto left = static_cast<std::int32_t>(block.x - first * side) * 3;
    const auto image_floats = static_cast<std::int32_t>(sources_[0]->images[image].row_floats());
    SumRows sums{sources_.size(), block.width, std::min(band_rows, block.height), left, image_floats};
    for (std::int32_t row = 0; row < block.height; row += band_rows) {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        const std::int32_t count = std::min(band_rows, block.height - row);
        const std::int64_t y = block.y + row, unit_y = y >> shift;
        for (std::size_t s = 0; s < sources_.size(); ++s) {
            const VariantImages& images = sources_[s]->images[image];
            for (std::int32_t i = 0; i < count; ++i)
                sources_[s]->tile_levels.fill(std::min(block.level, layout_.tile_level), block.x, y + i,
                                              block.width, sums.row(s, i));
            Kernels::VariantBand band;
            band.types = types.row(unit_y) + (first - types.x);
            band.types_stride = types.width;
            band.units_across = static_cast<std::size_t>(last - first + 1);
            band.units_down = static_cast<std::size_t>(((y + count - 1) >> shift) - unit_y + 1);
            band.images = images.row(0, 0);
            band.row_floats = images.row_floats();
            band.unit_side = side;
            band.image_side = images.side();
            band.first = static_cast<std::int32_t>(y - (unit_y << shift));
            band.count = count;
            kernels().add_variants(band, sums.row(s, 0) - left, sums.stride());
        }
        put(block, row, count, sums);
    }
    return Evaluation{.method = "variants",
                      .bound_codes = float_bound_codes(),
                      .work = static_cast<std::uint64_t>((last - first + 1) * (bottom - top + 1))};
}

Result<Evaluation> ExchangeWalk::look_up_nodes(const Block& block, const Budget& budget) const {
    using HangingOver = float[2][4];  // below, below right
    const int height = block.level - layout_.unit_level;
    const TypeGrid types =
        layout_.tree->types_of(height, block.x - 1, block.y - 1, block.width + 1, block.height + 1);
    const std::ptrdiff_t column = block.x - 1 - types.x;
    const std::size_t nodes_across = std::size_t(block.width) + 1;
    SumRows sums{sources_.size(), block.width, 1};
    const auto above = std::make_unique<HangingOver[]>(nodes_across * sources_.size());
    for (std::size_t s = 0; s < sources_.size(); ++s)
        for (std::size_t x = 0; x < nodes_across; ++x)
            std::copy_n(
                &sources_[s]->nodes->at(height)[types.row(block.y - 1)[column + std::ptrdiff_t(x)]].part[2]
                                                                                                        [0],
                8, &above[s * nodes_across + x][0][0]);
    for (std::int32_t row = 0; row < block.height; ++row) {
        if (row % 16 == 0)
            if (auto spent = check_budget(budget); !spent) return spent.error();
        for (std::size_t s = 0; s < sources_.size(); ++s) {
            const ExchangeTexels& source = *sources_[s];
            kernels().add_nodes(source.nodes->at(height), types.row(block.y + row) + column,
                                source.tile_levels.row(layout_.tile_level, 0), &above[s * nodes_across],
                                block.width, sums.row(s, 0));
        }
        put(block, row, 1, sums);
    }
    return Evaluation{.method = "quadtree",
                      .bound_codes = float_bound_codes(),
                      .work = std::uint64_t(block.width) * std::uint64_t(block.height)};
}

/// As far as a texel costs no more than so many look-ups, some 4 ns each. A rule of height and accuracy
/// alone, so that every window shows the same texels.
bool ExchangeWalk::enumerates(int height, Accuracy accuracy) const {
    const std::uint64_t look_ups = accuracy == Accuracy::exact ? 8192 : accuracy == Accuracy::high ? 1024 : 0;
    return height < 10 && (std::uint64_t{layout_.shapes.patch_count()} << (2 * height)) <= look_ups;
}

Result<Evaluation> ExchangeWalk::enumerate_or_expect(const Block& block, const Budget& budget) const {
    const int height = block.level - layout_.tile_level;
    const bool enumerate = enumerates(height, budget.accuracy);
    SumRows rows{sources_.size(), block.width, 1};
    std::vector<double> sums(std::size_t(block.width) * 3);
    for (std::int32_t row = 0; row < block.height; ++row) {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        for (std::size_t s = 0; s < sources_.size(); ++s) {
            const IndependentSums& sums_of = *sources_[s]->independent_sums;
            if (enumerate) {
                std::fill(sums.begin(), sums.end(), 0.0);
                sums_of.add_enumerated(*layout_.independent, height, block.x, block.y + row, block.width,
                                       sums.data());
            } else {
                for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = sums_of.expectation()[i % 3];
            }
            const float* mean = sources_[s]->tile_levels.row(layout_.tile_level, 0);
            float* rgb = rows.row(s, 0);
            for (std::size_t i = 0; i < sums.size(); ++i) rgb[i] = mean[i % 3] + static_cast<float>(sums[i]);
        }
        put(block, row, 1, rows);
    }
    if (enumerate) {
        const double tiles = static_cast<double>(std::int64_t{1} << (2 * height));
        return Evaluation{.method = "enumeration",
                          .bound_codes = float_bound_codes(),
                          .work = static_cast<std::uint64_t>(tiles * block.width * block.height)};
    }
    double off = 0, confidence = 1;
    for (const ExchangeTexels* source : sources_) {
        const auto bound = source->independent_sums->bound(height);
        off = std::max(off, bound.likely);
        if (bound.likely < bound.certain) confidence = IndependentSums::confidence;
    }
    return Evaluation{.method = "expectation",
                      .bound_codes = off / code_in_linear + float_bound_codes(),
                      .confidence = confidence,
                      .work = 1};
}

Result<Evaluation> ExchangeWalk::descend_or_expect(const Block& block, const Budget& budget) const {
    const int height = block.level - layout_.tile_level;
    const int most = budget.accuracy == Accuracy::exact ? 2 : budget.accuracy == Accuracy::high ? 1 : 0;
    SumRows rows{sources_.size(), block.width, 1};
    if (height > most) {
        double worst = 0;
        for (std::size_t s = 0; s < sources_.size(); ++s) {
            const float* mean = sources_[s]->tile_levels.row(layout_.tile_level, 0);
            for (std::int32_t i = 0; i < block.width * 3; ++i) {
                const double expected = double{mean[i % 3]} + sources_[s]->expectation[i % 3];
                worst = std::max({worst, expected, 1 - expected});
                rows.row(s, 0)[i] = static_cast<float>(expected);
            }
        }
        for (std::int32_t row = 0; row < block.height; ++row) put(block, row, 1, rows);
        // Nothing is known of how the formula's draws hang together, so only this is certain: texels are
        // colours
        return Evaluation{.method = "expectation", .bound_codes = worst / code_in_linear, .work = 1};
    }
    // Row by row from where tiles are single texels
    const std::int32_t side = 1 << height;
    const double share = 1.0 / (side * side);
    std::vector<double> sums(sources_.size() * std::size_t(block.width) * 3);
    const TakeRow add = [&](std::int32_t, std::int32_t, std::int32_t width, const float* const* values) {
        for (std::size_t s = 0; s < sources_.size(); ++s)
            for (std::int32_t x = 0; x < width; ++x)
                for (std::int32_t c = 0; c < 3; ++c)
                    sums[(s * std::size_t(block.width) + std::size_t(x / side)) * 3 + std::size_t(c)] +=
                        double{values[s][x * 3 + c]};
    };
    const ExchangeWalk fine{layout_, sources_, add};
    std::uint64_t work = 0;
    for (std::int32_t row = 0; row < block.height; ++row) {
        std::fill(sums.begin(), sums.end(), 0.0);
        const Block below{
            layout_.tile_level, block.x * side, (block.y + row) * side, block.width * side, side, 0, 0};
        const auto summed = fine.sum_stamps(below, budget);
        if (!summed) return summed.error();
        work += summed->work;
        for (std::size_t s = 0; s < sources_.size(); ++s)
            for (std::size_t i = 0; i < std::size_t(block.width) * 3; ++i)
                rows.row(s, 0)[i] = static_cast<float>(sums[s * std::size_t(block.width) * 3 + i] * share);
        put(block, row, 1, rows);
    }
    return Evaluation{.method = "descent", .bound_codes = float_bound_codes(), .work = work};
}

}  // namespace tessera
