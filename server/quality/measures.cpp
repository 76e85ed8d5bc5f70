#include "server/quality/measures.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr double hard_seam_limit = 1.15;
constexpr double blended_seam_limit = 1.02;
constexpr double interchange_repetition_limit = 0.10;
constexpr double repetition_allowance = 0.03;  ///< Beyond what so many contents cannot avoid.

/// Of each patch, on average; dropped ones are never shown.
double contents_a_patch(const ExchangeAsset& asset) {
    double contents = 0;
    for (const auto& patch : asset.patches)
        contents +=
            double(std::count_if(patch.contents.begin(), patch.contents.end(), [](const auto& content) {
                return content.standing != ExchangeAsset::Standing::dropped;
            }));
    return contents / double(std::max<std::size_t>(asset.patches.size(), 1));
}

}  // namespace

std::vector<Gate> gates_of(const ExchangeAsset& asset, const Seams& seams, const Repetition& repetition,
                           const TileShare& share) {
    std::vector<Gate> gates{
        {"seams, mean", seams.hard_ratio.mean, hard_seam_limit},
        {"seams, 99th percentile", seams.hard_ratio.percentile_99, hard_seam_limit},
        {"seams blended, mean", seams.blended_ratio.mean, blended_seam_limit},
        {"seams blended, 99th percentile", seams.blended_ratio.percentile_99, blended_seam_limit},
    };
    const double greatest = repetition.levels.front().greatest.value;
    if (asset.method == ExchangeMethod::content_exchange)
        gates.push_back(
            {"repetition", greatest, 1 / std::max(contents_a_patch(asset), 1.0) + repetition_allowance});
    if (asset.method == ExchangeMethod::interchange) {
        gates.push_back({"repetition", greatest, interchange_repetition_limit});
        gates.push_back({"repetition, counted", share.shifted.value, interchange_repetition_limit});
    }
    return gates;
}

MeasuredTextures textures_of(const ExchangeAsset& asset, std::uint64_t seed) {
    MeasuredTextures textures;
    textures.hard = make_exchange_texture(asset, {.seed = seed, .blended = false});
    textures.blended = make_exchange_texture(asset, {.seed = seed});
    if (asset.method == ExchangeMethod::interchange)
        textures.kolar =
            make_exchange_texture(asset, {.seed = seed, .choice = Choice::kolar, .blended = false});
    return textures;
}

bool Quality::passed() const noexcept {
    return std::all_of(gates.begin(), gates.end(), [](const Gate& gate) { return gate.passed(); });
}

Result<Quality> measure_quality(const ExchangeAsset& asset, const MeasuredTextures& textures,
                                const ProgressPart& progress) {
    Quality quality;
    auto seams = measure_seams(asset, *textures.hard, *textures.blended, progress.part(0, 0.2));
    if (!seams) return seams.error();
    quality.seams = std::move(*seams);
    auto repetition = measure_repetition(*textures.blended, asset.tile_side, progress.part(0.2, 0.6));
    if (!repetition) return repetition.error();
    quality.repetition = std::move(*repetition);
    auto share =
        measure_tile_share(*textures.hard, asset.tile_side, TileSample::rows, progress.part(0.6, 0.75));
    if (!share) return share.error();
    quality.share = std::move(*share);
    if (textures.kolar != nullptr) {
        auto kolar = measure_tile_share(*textures.kolar, asset.tile_side, TileSample::whole_tiles,
                                        progress.part(0.75, 0.9));
        if (!kolar) return kolar.error();
        quality.kolar = std::move(*kolar);
    }
    auto fidelity = measure_fidelity(asset, *textures.blended, progress.part(0.9, 1));
    if (!fidelity) return fidelity.error();
    quality.fidelity = std::move(*fidelity);
    quality.gates = gates_of(asset, quality.seams, quality.repetition, quality.share);
    return quality;
}

}  // namespace tessera
