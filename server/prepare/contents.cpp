#include "server/prepare/contents.h"

#include <atomic>

#include "server/prepare/candidate_search.h"
#include "server/prepare/parallel.h"

namespace tessera {

std::vector<std::vector<ShapedContent>> find_contents(const PerceptualImage& photo,
                                                      const PerceptualImage& tile_colors,
                                                      const PeriodicTile& tile,
                                                      const Segmentation& segmentation,
                                                      const ContentSearch& search, Progress& progress) {
    const std::size_t count = segmentation.patches.size();
    const auto wanted = static_cast<std::size_t>(search.contents);
    const std::vector<std::vector<Candidate>> candidates =
        find_candidates(photo, tile_colors, tile, segmentation,
                        {2 * wanted, search.blend_texels, search.threads,
                         [&](double done) { progress.advance("contents", 0.3 * done); }},
                        progress);

    // Cut them, choose, and cut the chosen ones again in view of each other
    const ChoiceScale scale{photo, segmentation, search.contents};
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
        advance(0.3, 0.7);
    });
    PhotoUses uses{photo};
    for (std::int32_t round = 0; round < search.contents; ++round)
        for (std::size_t p = 0; p < count; ++p) {
            if (progress.stop().stop_requested()) return {};
            const auto& box = segmentation.patches[p];
            if (contents[p].take_best(distinct_distance(box), uses))
                uses.add(contents[p].contents().back().at, box.width, box.height);
        }
    done = 0;
    for_each_index(count, search.threads, [&](std::size_t patch) {
        if (progress.stop().stop_requested()) return;
        contents[patch].recut();
        advance(0.7, 1);
    });
    std::vector<std::vector<ShapedContent>> found;
    for (const PatchContents& patch : contents) found.push_back(patch.contents());
    return found;
}

}  // namespace tessera
