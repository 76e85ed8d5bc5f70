// Comparisons of what plans do above the tile level and with layers.
#include <bit>

#include "server/accuracy/page_comparisons.h"
#include "server/accuracy/page_measuring.h"
#include "server/texture/exchange.h"

namespace tessera {
namespace {

constexpr std::int32_t compared_side = 64, most_brute_side = 2048;

TexelRegion region_at(int level) {
    return {static_cast<std::uint8_t>(level), 3 * compared_side, -5 * compared_side, compared_side,
            compared_side};
}

/// The region as level `level` − `depth` shows it, asked for in squares that evaluation takes, and reduced.
Result<LinearImage> from_below(const Texture& texture, int level, int depth, const Budget& budget,
                               Evaluation* told = nullptr) {
    const TexelRegion region = region_at(level);
    TexelRegion below{static_cast<std::uint8_t>(level - depth), region.x << depth,
                      region.y * (std::int64_t{1} << depth), region.width << depth, region.height << depth};
    LinearImage image;
    const auto done = texture.evaluate(below, budget, image);
    if (!done) return done.error();
    if (told != nullptr) *told = *done;
    for (int i = 0; i < depth; ++i) image = reduced(image);
    return image;
}

/// Evaluates and times one setting, and adds its row.
Result<void> add(std::string_view comparison, const std::string& name, std::string_view setting,
                 const LinearImage& truth, int level, const std::stop_token& stop,
                 const std::function<Result<LinearImage>(Evaluation&)>& evaluate,
                 std::vector<proto::PageRow>& rows) {
    Evaluation told;
    Result<LinearImage> found = evaluate(told);
    if (!found) return found.error();
    const double time = median_milliseconds([&] { found = evaluate(told); });
    if (!found) return found.error();
    if (stop.stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
    const PageError error = page_error(truth, *found);
    proto::PageRow& row = rows.emplace_back();
    row.set_comparison(std::string{comparison});
    row.set_texture(name);
    row.set_setting(std::string{setting});
    row.set_level(static_cast<std::uint32_t>(level));
    row.set_mse(error.mse);
    row.set_max_error(error.max_linear);
    row.set_bound_codes(told.bound_codes);
    row.set_confidence(told.confidence);
    row.set_milliseconds(time);
    return {};
}

}  // namespace

Result<void> compare_statistics(const ExchangeAsset& asset, const std::stop_token& stop,
                                std::vector<proto::PageRow>& rows) {
    const auto independent = make_exchange_texture(asset, {.seed = 1, .choice = Choice::independent});
    const auto typed = make_exchange_texture(asset, {.seed = 1});
    const int tile_level = std::countr_zero(static_cast<std::uint32_t>(asset.tile_side));
    for (int level = tile_level - 1; level <= tile_level + 4; ++level) {
        // Four levels down the truth is still summed stamp by stamp
        const int depth = std::min(
            {level - tile_level + 1, std::countr_zero(unsigned(most_brute_side / compared_side)), level});
        for (const auto& [name, texture] :
             {std::pair{"independent", independent}, std::pair{"typed", typed}}) {
            const Budget exact{.accuracy = Accuracy::exact, .cancelled = stop};
            const auto truth = from_below(*texture, level, depth, exact);
            if (!truth) return truth.error();
            for (const Accuracy accuracy : accuracies) {
                if (texture == typed && accuracy != Accuracy::exact) continue;
                const auto added = add(
                    "statistical", std::string{name} + " choices", name_of(accuracy), *truth, level, stop,
                    [&, &texture = texture](Evaluation& told) {
                        return from_below(*texture, level, 0, {.accuracy = accuracy, .cancelled = stop},
                                          &told);
                    },
                    rows);
                if (!added) return added;
            }
        }
    }
    return {};
}

Result<void> compare_descents(const std::string& name, const Texture& layers, const std::stop_token& stop,
                              std::vector<proto::PageRow>& rows) {
    for (int level = 1; level <= 5; ++level) {
        const auto truth = from_below(layers, level, level, {.accuracy = Accuracy::exact, .cancelled = stop});
        if (!truth) return truth.error();
        for (int depth = 0; depth <= std::min(level, 3); ++depth) {
            const auto added = add(
                "descent", name, "d = " + std::to_string(depth), *truth, level, stop,
                [&](Evaluation& told) {
                    return from_below(layers, level, depth, {.accuracy = Accuracy::fast, .cancelled = stop},
                                      &told);
                },
                rows);
            if (!added) return added;
        }
        for (const Accuracy accuracy : {Accuracy::high, Accuracy::exact}) {
            const auto added = add(
                "descent", name, std::string{"accuracy="} + std::string{name_of(accuracy)}, *truth, level,
                stop,
                [&](Evaluation& told) {
                    return from_below(layers, level, 0, {.accuracy = accuracy, .cancelled = stop}, &told);
                },
                rows);
            if (!added) return added;
        }
    }
    return {};
}

}  // namespace tessera
