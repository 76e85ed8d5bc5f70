#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "client/residency/needed_pages.h"

namespace tessera {

/// Pages that stand for all of `pages`, each of these for itself or an ancestor for it: no more than `most`,
/// and the fewer levels and pixels coarser the better. `fits`: whether a page may stand for others; where
/// that leaves too many, there are more than `most`. Each page is there once, coarse ones first; its pixels
/// are those of all that it stands for.
std::vector<NeededPage> coarse_cover(std::span<const NeededPage> pages, std::size_t most, Extent extent,
                                     const std::function<bool(PageKey)>& fits);

/// Whether `coarse` is `fine` or an ancestor of it.
constexpr bool covers(PageKey coarse, PageKey fine) noexcept {
    const int levels = coarse.level - fine.level;
    return levels >= 0 && fine.x >> levels == coarse.x && fine.y >> levels == coarse.y;
}

}  // namespace tessera
