#include "server/prepare/contents.h"

#include <algorithm>
#include <atomic>

#include "server/prepare/candidate_search.h"
#include "server/prepare/parallel.h"

namespace tessera {
namespace {

/// So many are cut for each that is chosen: of more, such are found that cancel what repeats, so that cuts
/// can be less bound by it.
constexpr int candidates_for_each = 8;
/// How often the chosen ones are cut again.
constexpr int recuts = 6;
/// The part of the repetition that is tolerated, 1 / contents + 3 %, that is aimed at: blending adds to what
/// hard shapes repeat.
constexpr int repetition_percent = 66;

/// What the texels around a patch show.
ColorsBeside colors_beside(const std::vector<PatchContents>& contents, const Segmentation& segmentation,
                           std::int32_t side, std::size_t patch) {
    const std::int32_t wrap = side - 1;
    const PatchGround& ground = contents[patch].ground();
    const auto& box = segmentation.patches[patch];
    ColorsBeside beside;
    for (std::int32_t y = -1; y <= ground.height; ++y)
        for (std::int32_t x = -1; x <= ground.width; ++x) {
            const bool touches = ground.holds(x - 1, y) || ground.holds(x + 1, y) || ground.holds(x, y - 1) ||
                                 ground.holds(x, y + 1);
            if (ground.holds(x, y) || !touches) continue;
            const std::int32_t tile_x = (box.x + x) & wrap, tile_y = (box.y + y) & wrap;
            const std::size_t other = segmentation.labels[static_cast<std::size_t>(tile_y * side + tile_x)];
            const auto& its = segmentation.patches[other];
            beside[ground.index_around(x, y)] =
                contents[other].colors_at((tile_x - its.x) & wrap, (tile_y - its.y) & wrap);
        }
    return beside;
}

}  // namespace

std::vector<std::vector<ShapedContent>> find_contents(const PerceptualImage& photo,
                                                      const PerceptualImage& tile_colors,
                                                      const PeriodicTile& tile,
                                                      const Segmentation& segmentation,
                                                      const ContentSearch& search, Progress& progress) {
    const std::size_t count = segmentation.patches.size();
    const auto wanted = static_cast<std::size_t>(search.contents);
    const std::vector<std::vector<Candidate>> candidates =
        find_candidates(photo, tile_colors, tile, segmentation,
                        {candidates_for_each * wanted, search.blend_texels, search.threads,
                         [&](double done) { progress.advance("contents", 0.3 * done); }},
                        progress);

    // Cut them, and choose
    ChoiceScale scale{photo, segmentation, search.contents};
    std::vector<PatchContents> contents;
    for (std::size_t patch = 0; patch < count; ++patch)
        contents.emplace_back(make_patch_ground(tile_colors, segmentation, patch), photo, scale);
    std::atomic<std::size_t> done{0};
    const auto advance = [&](double from, double to) {
        progress.advance("contents",
                         from + (to - from) * static_cast<double>(++done) / static_cast<double>(count));
    };
    for_each_index(count, search.threads, [&](std::size_t patch) {
        for (const Candidate& candidate : candidates[patch]) {
            if (progress.stop().stop_requested()) return;
            contents[patch].add_candidate(candidate.at);
        }
        advance(0.3, 0.65);
    });
    PhotoUses uses{photo};
    for (std::int32_t round = 0; round < search.contents; ++round)
        for (std::size_t p = 0; p < count; ++p) {
            if (progress.stop().stop_requested()) return {};
            const auto& box = segmentation.patches[p];
            if (contents[p].take_best(distinct_distance(box), uses))
                uses.add(contents[p].contents().back().at, box.width, box.height);
        }
    // Cut them again in view of each other, and weigh repetition against seams until as little repeats as
    // should
    const std::int64_t aim = repetition_percent * (10000 / search.contents + 300) / 100;
    for (int pass = 0; pass < recuts; ++pass) {
        done = 0;
        // All of them against what the others showed before, so that their order does not matter
        std::vector<ColorsBeside> beside(count);
        for (std::size_t patch = 0; patch < count; ++patch)
            beside[patch] = colors_beside(contents, segmentation, tile.side, patch);
        for_each_index(count, search.threads, [&](std::size_t patch) {
            if (progress.stop().stop_requested()) return;
            contents[patch].recut(beside[patch]);
            const double step = 0.35 / recuts;
            advance(0.65 + step * pass, 0.65 + step * (pass + 1));
        });
        ShownSum shown;
        for (const PatchContents& patch : contents) shown.add(patch.shown());
        const std::int64_t repetition = shown.repetition();
        scale.repetition_weight = std::clamp(scale.repetition_weight * repetition * repetition / (aim * aim),
                                             std::max<std::int64_t>(16, scale.repetition_weight / 4),
                                             std::min<std::int64_t>(16 * 256, 4 * scale.repetition_weight));
    }
    std::vector<std::vector<ShapedContent>> found;
    for (const PatchContents& patch : contents) found.push_back(patch.contents());
    return found;
}

}  // namespace tessera
