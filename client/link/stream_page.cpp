#include "client/link/stream_page.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "proto/stream.pb.h"

#include "client/link/page_body.h"

namespace tessera {
namespace {

constexpr std::uint32_t longest_retry_ms = 60'000;
constexpr std::size_t longest_tag = 256;
constexpr std::size_t longest_words = 1000;

std::string name_of(PageKey page) {
    return "page " + std::to_string(page.level) + "/" + std::to_string(page.x) + "/" + std::to_string(page.y);
}

std::size_t raw_bytes(const FetchOptions& options) {
    const auto side = static_cast<std::size_t>(page_side_texels + 2 * options.gutter);
    return 4 * side * side;
}

bool is_key(const proto::StreamPageKey& told, PageKey page) {
    return told.level() == page.level && told.x() == std::int64_t{page.x} && told.y() == std::int64_t{page.y};
}

std::string texels_of_colour(std::uint32_t colour, std::size_t bytes) {
    std::string texels(bytes, '\0');
    for (std::size_t i = 0; i < bytes; ++i) texels[i] = static_cast<char>(colour >> (8 * (i % 4)));
    return texels;
}

/// The texels, or what is wrong with the answer.
Result<std::string> texels_in(const StreamAsk& ask, proto::PageData& data, const FetchOptions& options,
                              const StreamPage& page) {
    const auto wrong = [&](const std::string& what) {
        return Error{ErrorCode::io_failure, name_of(ask.page) + ": the server sent " + what};
    };
    if (!is_key(data.page(), ask.page)) return wrong("another page");
    if (page.scene_revision < ask.least_revision)
        return wrong("revision " + std::to_string(page.scene_revision) + " where " +
                     std::to_string(ask.least_revision) + " was asked for");
    if (page.revision > page.scene_revision) return wrong("a page newer than its scene");
    if (!page.validity.holds(ask.step)) return wrong("texels of other steps");
    if (page.tag.size() > longest_tag) return wrong("a tag of " + std::to_string(page.tag.size()) + " bytes");
    if (data.unchanged()) {
        if (ask.have.empty() || (!page.tag.empty() && page.tag != ask.have))
            return wrong("'unchanged' where the copy is another");
        return std::string{};
    }
    const std::size_t bytes = raw_bytes(options);
    if (data.has_colour()) return texels_of_colour(data.colour(), bytes);
    auto texels = decode_body(std::move(*data.mutable_texels()), "zstd", bytes);
    if (!texels) return Error{texels.error().code, name_of(ask.page) + ": " + texels.error().detail};
    if (texels->size() != bytes)
        return wrong(std::to_string(texels->size()) + " bytes where the page has " + std::to_string(bytes));
    return texels;
}

}  // namespace

StreamPage page_of(const StreamAsk& ask, proto::PageData&& data, const FetchOptions& options,
                   std::size_t wire_bytes) {
    StreamPage page = failed_page(ask, {});
    page.revision = data.revision();
    page.scene_revision = data.scene_revision();
    page.validity = {data.has_from() ? data.from() : always, data.has_until() ? data.until() : never};
    page.tag = data.tag();
    page.bound_codes = std::isfinite(data.bound_codes()) ? std::clamp(data.bound_codes(), 0.0, 255.0) : 255.0;
    page.wire_bytes = wire_bytes;
    page.texels = texels_in(ask, data, options, page);
    page.unchanged = page.texels.has_value() && data.unchanged();
    return page;
}

StreamPage page_of(const StreamAsk& ask, const proto::PageRefusal& refusal) {
    const auto code = [&] {
        switch (refusal.why()) {
            case proto::PageRefusal::wrong:
                return ErrorCode::malformed_request;
            case proto::PageRefusal::cancelled:
                return ErrorCode::cancelled;
            case proto::PageRefusal::overloaded:
            case proto::PageRefusal::not_yet:
                return ErrorCode::overloaded;
            case proto::PageRefusal::timed_out:
                return ErrorCode::timed_out;
            default:
                return ErrorCode::io_failure;
        }
    }();
    StreamPage page =
        failed_page(ask, {code, name_of(ask.page) + ": " + refusal.detail().substr(0, longest_words)});
    page.retry_ms = std::min(refusal.retry_ms(), longest_retry_ms);
    return page;
}

StreamPage failed_page(const StreamAsk& ask, Error why) {
    return {.id = ask.id, .page = ask.page, .texels = std::move(why), .tag = {}};
}

std::vector<StalePageNews> stale_pages_of(const proto::Invalidation& invalidation, Extent extent) {
    std::vector<StalePageNews> pages;
    for (const proto::StalePages& stale : invalidation.stale()) {
        if (stale.level() > extent.n) continue;
        const auto level = static_cast<std::uint8_t>(stale.level());
        const std::int64_t side = extent.side_pages(level);
        for (int i = 0; i < std::min({stale.x_size(), stale.y_size(), stale.revision_size()}); ++i) {
            if (stale.x(i) < 0 || stale.x(i) >= side || stale.y(i) < 0 || stale.y(i) >= side) continue;
            const PageKey page{level, static_cast<std::uint32_t>(stale.x(i)),
                               static_cast<std::uint32_t>(stale.y(i))};
            pages.push_back({page, stale.revision(i)});
        }
    }
    return pages;
}

SceneClock clock_of(const proto::ClockNow& told, SceneClock::Time now) {
    SceneClock clock;
    constexpr double slowest = 1e-6, fastest = 1000;
    const double rate = told.steps_per_second();
    clock.steps_per_second = std::isfinite(rate) ? std::clamp(rate, slowest, fastest) : 10;
    clock.loop_steps = std::max<Step>(0, told.loop_steps());
    clock.playing = told.playing();
    clock.step = std::clamp(told.step(), -max_step, max_step);
    const double part = std::isfinite(told.step_part()) ? std::clamp(told.step_part(), 0.0, 1.0) : 0;
    const double milliseconds_over = clock.playing ? std::min(1e12, part / clock.steps_per_second * 1000) : 0;
    clock.at = now - std::chrono::milliseconds{static_cast<std::int64_t>(milliseconds_over)};
    return clock;
}

}  // namespace tessera
