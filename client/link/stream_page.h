#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "client/link/page_url.h"
#include "shared/motion/scene_clock.h"
#include "shared/motion/validity.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

namespace proto {
class ClockNow;
class Invalidation;
class PageData;
class PageRefusal;
}  // namespace proto

/// A page that is wanted.
struct StreamAsk {
    std::uint32_t id = 0;  ///< The asker's; not one that waits for its answer.
    PageKey page;
    Step step = 0;
    std::uint64_t least_revision = 0;  ///< Of the scene: the answer has seen all edits up to it.
    std::uint32_t urgency = 3;         ///< 0 (first) to 7.
    std::string have;                  ///< Tag of the copy that the asker has; empty: none.
};

/// The answer to an ask, checked.
struct StreamPage {
    std::uint32_t id = 0;
    PageKey page;
    /// Raw texels: 4·(256 + 2·gutter)² bytes of premultiplied sRGB-coded RGBA, rows from the top. Empty if
    /// `unchanged`. Errors: `malformed_request` (asking again does not help), `cancelled`, `overloaded` (ask
    /// again after `retry_ms`), `timed_out`, `io_failure`.
    Result<std::string> texels;
    bool unchanged = false;  ///< The asker's copy is still right.
    std::uint64_t revision = 0;
    std::uint64_t scene_revision = 0;
    Validity validity{};
    std::string tag;
    double bound_codes = 0;
    std::size_t wire_bytes = 0;
    std::uint32_t retry_ms = 0;
};

/// The answer that `data` is to `ask`: unpacked, and an io_failure that says what is wrong with it where the
/// server has mistaken the page, its size, its revision, its step or its texels.
StreamPage page_of(const StreamAsk& ask, proto::PageData&& data, const FetchOptions& options,
                   std::size_t wire_bytes);

StreamPage page_of(const StreamAsk& ask, const proto::PageRefusal& refusal);

/// The answer that an ask gets from this side of the stream.
StreamPage failed_page(const StreamAsk& ask, Error why);

/// A page of which there is a newer version than those before `revision`.
struct StalePageNews {
    PageKey page;
    std::uint64_t revision = 0;
};

/// The pages that are told to be stale; what lies outside the extent is left out.
std::vector<StalePageNews> stale_pages_of(const proto::Invalidation& invalidation, Extent extent);

/// A clock that was told at `now`, by the listener's own time.
SceneClock clock_of(const proto::ClockNow& told, SceneClock::Time now);

}  // namespace tessera
