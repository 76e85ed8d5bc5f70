#pragma once

#include <optional>

#include "server/texture/texture.h"
#include "shared/page/error_limit.h"

namespace tessera {

/// An evaluation, the accuracy it was made with, and whether its bound keeps the limit that was asked for.
struct EvaluationWithin {
    Evaluation evaluation;
    Accuracy accuracy = Accuracy::high;
    bool met = true;
};

/// `region` at the cheapest of fast, high and exact whose bound keeps `limit`; at `exact`, and not met, where
/// none does. Without a limit at the budget's own accuracy. `Image`: Rgba8Image or LinearImage.
template <class Image>
Result<EvaluationWithin> evaluate_within(const Texture& texture, const TexelRegion& region,
                                         std::optional<ErrorLimit> limit, const Budget& budget, Image& out) {
    if (!limit) {
        const auto evaluation = texture.evaluate(region, budget, out);
        if (!evaluation) return evaluation.error();
        return EvaluationWithin{*evaluation, budget.accuracy, true};
    }
    EvaluationWithin best;
    double doubted = 0;
    std::uint64_t work = 0;
    Validity validity;
    Budget tried = budget;
    for (const Accuracy accuracy : {Accuracy::fast, Accuracy::high, Accuracy::exact}) {
        tried.accuracy = accuracy;
        const auto evaluation = texture.evaluate(region, tried, out);
        if (!evaluation) return evaluation.error();
        best = {*evaluation, accuracy, limit->allows(evaluation->bound_codes)};
        best.evaluation.work = work += evaluation->work;
        best.evaluation.validity.meet(validity);  // Those that were not taken had a say in it
        validity = best.evaluation.validity;
        // A bound that was chosen among several holds less surely than one that was not
        if (evaluation->confidence < 1) {
            best.evaluation.confidence -= doubted;
            doubted += 1 - evaluation->confidence;
        }
        if (best.met) break;
    }
    return best;
}

}  // namespace tessera
