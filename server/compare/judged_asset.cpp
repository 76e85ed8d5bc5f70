#include "server/compare/judged_asset.h"

#include <chrono>

#include "server/prepare/recorded.h"

namespace tessera {

Result<JudgedAsset> judge(const Rgb8Image& photo, const PrepareOptions& options, Progress& progress) {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    auto prepared = prepare_exchange(photo, options, nullptr, progress);
    if (!prepared) return prepared.error();
    const auto ready = Clock::now();

    JudgedAsset judged;
    judged.asset = std::move(prepared->asset);
    judged.own_seams = prepared->exemplar_sources.empty()
                           ? measure_own_seams(judged.asset.tile, prepared->tile_sources, true)
                           : measure_own_seams(judged.asset.exemplar, prepared->exemplar_sources, false);
    const MeasuredTextures textures = textures_of(judged.asset);
    judged.texture = textures.blended;
    auto quality = measure_quality(judged.asset, textures, {progress, "measuring"});
    if (!quality) return quality.error();
    judged.quality = std::move(*quality);
    judged.prepare_seconds = std::chrono::duration<double>(ready - begin).count();
    judged.measure_seconds = std::chrono::duration<double>(Clock::now() - ready).count();
    return judged;
}

std::vector<TerminalProgress::Share> judge_shares(ExchangeMethod method) {
    constexpr double preparing = 0.9;
    std::vector<TerminalProgress::Share> shares;
    for (const auto& [stage, part] : prepare_shares(method)) shares.push_back({stage, part * preparing});
    shares.push_back({"measuring", 1 - preparing});
    return shares;
}

}  // namespace tessera
