#include "tests/simulation/streaming/fifo_client.h"

#include <algorithm>

namespace tessera::testing {

FifoClient::Frame FifoClient::update(const PlaneView& view, const Sampling& sampling) {
    Frame frame;
    const std::vector<NeededPage> needed = needed_pages(view, extent_, 0, sampling);
    for (const ArrivedPage& page : stream_.take_arrived(1000)) {
        here_.insert(page.page);
        ++frame.arrived;
        frame.late +=
            std::ranges::none_of(needed, [&](const NeededPage& n) { return n.key == page.page; }) ? 1 : 0;
    }
    double pixels = 0, deficit = 0, sharp = 0;
    for (const NeededPage& page : needed) {
        pixels += page.pixels;
        PageKey shown = page.key;
        while (shown.level < extent_.n && !here_.contains(shown)) shown = parent(shown);
        const int missing = (here_.contains(shown) ? shown.level : extent_.n + 1) - page.key.level;
        deficit += page.pixels * missing;
        if (missing == 0) {
            sharp += page.pixels;
            continue;
        }
        ++frame.missing;
        if (asked_.insert(page.key).second)
            stream_.request({.id = next_id_++, .page = page.key, .urgency = Urgency::sharpen});
    }
    // The coarsest page, so that there is something to show
    const PageKey top{extent_.n, 0, 0};
    if (asked_.insert(top).second)
        stream_.request({.id = next_id_++, .page = top, .urgency = Urgency::sharpen});
    if (pixels > 0) {
        frame.mip_deficit = deficit / pixels;
        frame.sharp_share = sharp / pixels;
    }
    return frame;
}

}  // namespace tessera::testing
