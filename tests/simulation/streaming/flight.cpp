#include "tests/simulation/streaming/flight.h"

#include <cmath>
#include <map>
#include <set>

#include "tests/simulation/streaming/fifo_client.h"

namespace tessera::testing {
namespace {

constexpr int width = 800, height = 700;
constexpr double most_seconds = 60;

std::string blank(PageKey, std::uint32_t, std::uint64_t) { return std::string(slot_bytes, '\0'); }

ClientTime frame_time(int frame) {
    return ClientTime{static_cast<std::int64_t>(std::llround(frame * 1000.0 / 60))};
}

double link_seconds(const LinkSettings& link, double bytes) {
    return bytes / link.bytes_per_second + 2 * link.one_way_ms / 1000;
}

}  // namespace

FlightResult fly(const Flight& flight, const ResidencySettings& settings) {
    SimulatedStream stream{flight.link, blank};
    const Extent extent = flight.extent;
    Residency residency{extent, stream, settings};
    FlightResult result;
    int moving_frames = 0;
    bool is_resting = false;
    double stopped_at = 0;
    std::set<PageKey> unseen;  // arrived, and not sampled yet
    for (int frame = 0;; ++frame) {
        const ClientTime now = frame_time(frame);
        const double seconds = frame / 60.0;
        const PlaneView view{flight.camera(seconds), width, height};
        if (!is_resting && seconds >= flight.moving_seconds) {
            is_resting = true;
            stopped_at = seconds;
            for (const NeededPage& page : needed_pages(view, extent, 0, flight.sampling))
                result.missing_bytes +=
                    residency.cache().find(page.key) ? 0 : static_cast<double>(flight.link.page_bytes);
            result.missing_seconds = link_seconds(flight.link, result.missing_bytes);
        }
        stream.advance(now);
        const ResidencyFrame outcome = residency.update(view, now, flight.sampling);
        for (const SlotUpload& upload : outcome.uploads) unseen.insert(upload.page);
        for (const NeededPage& page : needed_pages(view, extent, outcome.lod_bias, flight.sampling)) {
            const auto shown = residency.table().shown_for(page.key);
            PageKey at = page.key;
            while (shown && at.level < shown->level) at = parent(at);
            unseen.erase(at);
        }
        if (!is_resting) {
            ++moving_frames;
            result.mip_deficit += outcome.mip_deficit;
            result.sharp_share += outcome.resident_share;
        } else if (outcome.is_sharp() || seconds > most_seconds) {
            result.sharp_after_seconds = seconds - stopped_at;
            break;
        }
    }
    if (moving_frames > 0) {
        result.mip_deficit /= moving_frames;
        result.sharp_share /= moving_frames;
    }
    result.pages_sent = stream.pages_sent;
    for (const PageKey page : unseen) result.late += page.level + settings.pinned_levels > extent.n ? 0 : 1;
    result.late += residency.requests().counts().late;
    return result;
}

FlightResult fly_first_in_first_out(const Flight& flight) {
    SimulatedStream stream{flight.link, blank};
    FifoClient client{flight.extent, stream};
    FlightResult result;
    int moving_frames = 0;
    for (int frame = 0;; ++frame) {
        const double seconds = frame / 60.0;
        stream.advance(frame_time(frame));
        const FifoClient::Frame outcome =
            client.update(PlaneView{flight.camera(seconds), width, height}, flight.sampling);
        result.late += outcome.late;
        if (seconds < flight.moving_seconds) {
            ++moving_frames;
            result.mip_deficit += outcome.mip_deficit;
            result.sharp_share += outcome.sharp_share;
        } else if (outcome.missing == 0 || seconds > most_seconds) {
            result.sharp_after_seconds = seconds - flight.moving_seconds;
            break;
        }
    }
    if (moving_frames > 0) {
        result.mip_deficit /= moving_frames;
        result.sharp_share /= moving_frames;
    }
    result.pages_sent = stream.pages_sent;
    return result;
}

}  // namespace tessera::testing
