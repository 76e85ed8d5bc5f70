#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/motion/validity.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

inline constexpr std::int32_t gutter_texels = 4;  ///< Around each page in the cache.
inline constexpr std::int32_t slot_side_texels = page_side_texels + 2 * gutter_texels;  ///< 264
inline constexpr std::size_t slot_bytes = std::size_t{4} * slot_side_texels * slot_side_texels;

using PageRequestId = std::uint32_t;

/// How soon a page is worth having. A source with a queue answers the lower ones first.
enum class Urgency : std::uint8_t {
    cover = 0,     ///< One of the coarsest: without it there may be nothing to show.
    missing = 1,   ///< In view, and many levels are missing there.
    sharpen = 2,   ///< In view, and a level or two are missing there.
    renew = 3,     ///< In view, and an older version of it is shown.
    prefetch = 6,  ///< Not in view yet.
};

struct PageRequest {
    PageRequestId id = 0;  ///< The asker's; not one that waits for its answer.
    PageKey page;
    /// Of the scene: the answer has seen all edits up to this one. 0: any will do.
    std::uint64_t least_revision = 0;
    Step step = 0;  ///< Of the animation clock: the answer's validity holds it.
    Urgency urgency = Urgency::sharpen;
    /// Tag of the copy that the asker has, if any: where that is right still, `unchanged` is the answer.
    std::string have{};
    /// Sprites to be left out of the page: a hand has lifted them. With any, the answer says nothing of
    /// versions, and `have` is empty.
    std::vector<std::uint64_t> without{};
};

/// Which texels of a page these are.
struct PageVersion {
    /// Which history of the scene it is of: revisions of one history are in order, those of two are not. A
    /// source counts one more whenever revisions count anew.
    std::uint32_t history = 0;
    std::uint64_t revision = 0;        ///< The page's own: of the last edit that touched it.
    std::uint64_t scene_revision = 0;  ///< All edits up to this one are in it; at least `revision`.
    Validity validity{};               ///< The steps in which the texels stay the same.
    std::string tag{};                 ///< Names these bytes to the source; empty: it has no names for them.
    double bound_codes = 0;  ///< No texel is wrong by more 8-bit codes; 0 where the source does not say.
    bool operator==(const PageVersion&) const = default;
};

/// The answer to a request.
struct ArrivedPage {
    PageRequestId id = 0;
    PageKey page;
    /// The page with its gutter: slot_bytes of RGBA, 8 bits a channel, sRGB-coded, premultiplied, rows from
    /// the top. Empty if `unchanged`. Or why there are none.
    Result<std::string> texels;
    bool unchanged = false;  ///< The copy that the request named is right, and of this version.
    PageVersion version{};
    std::size_t wire_bytes = 0;  ///< That it took to bring; 0: unknown, as many as a page has.
    std::uint32_t retry_ms = 0;  ///< With an error: not to be asked for again sooner.
};

/// A page of which there is a newer version than those before `revision`.
struct StalePage {
    PageKey page;
    std::uint64_t revision = 0;  ///< The page's own.
};

/// What has become of the scene since the last news.
struct SceneNews {
    std::uint32_t history = 0;  ///< See PageVersion. A new one: every copy may be wrong.
    /// Of the scene, in this history: all changes up to it in what is watched have been told. Never less than
    /// before.
    std::uint64_t told_revision = 0;
    std::vector<StalePage> stale{};
    /// Copies that have not seen all edits up to this one may be wrong, though nobody named them: after a
    /// break of which the source could not learn all.
    std::uint64_t unsure_before = 0;
};

/// A rectangle of pages of one level: [left, right) × [top, bottom).
struct PageWindow {
    std::uint8_t level = 0;
    std::uint32_t left = 0;
    std::uint32_t top = 0;
    std::uint32_t right = 0;
    std::uint32_t bottom = 0;
    constexpr bool contains(PageKey page) const noexcept {
        return page.level == level && page.x >= left && page.x < right && page.y >= top && page.y < bottom;
    }
    bool operator==(const PageWindow&) const = default;
};

/// Where pages come from: HTTP, where nothing is told, or a stream that tells what edits make stale. No call
/// waits. Each frame calls take_news() before take_arrived().
class PageSource {
  public:
    virtual ~PageSource() = default;

    /// Asks for a version of a page. Of one page, at most one is under way. False: the source is full, or has
    /// no connection; ask again later.
    virtual bool request(const PageRequest& request) = 0;
    /// Nobody wants the answer any more. It arrives with the error `cancelled`, or with its texels if those
    /// were faster.
    virtual void cancel(PageRequestId id) = 0;
    /// What has come since the last call, at most `most` pages, also after a connection was lost: every
    /// request is answered exactly once. Of requests that were lost, the answer is the error `io_failure`.
    virtual std::vector<ArrivedPage> take_arrived(std::size_t most) = 0;

    /// How many answers may be under way at once from now on: a stream grants its server so many credits.
    virtual void allow(std::size_t /*answers*/) {}

    /// Replaces all windows: news are wanted of pages in these. Pages that the asker has there and that were
    /// in no window before have seen all edits up to `seen_revision`: later ones are told.
    virtual void watch(std::span<const PageWindow> /*windows*/, std::uint64_t /*seen_revision*/) {}
    /// What was told since the last call.
    virtual SceneNews take_news() { return {}; }
};

}  // namespace tessera
