#pragma once

#include <vector>

#include "client/residency/needed_pages.h"
#include "client/residency/page_source.h"

namespace tessera {

/// Of which pages news are wanted: those that the view samples, their ancestors, and some around them, so
/// that not each step of the camera changes it.
class WatchedWindows {
  public:
    /// True: the windows are others now.
    bool follow(const std::vector<NeededPage>& needed, Extent extent);

    const std::vector<PageWindow>& windows() const { return windows_; }
    bool contains(PageKey page) const { return contains(windows_, page); }
    static bool contains(const std::vector<PageWindow>& windows, PageKey page);

  private:
    std::vector<PageWindow> windows_;  ///< One a level, fine first
};

}  // namespace tessera
