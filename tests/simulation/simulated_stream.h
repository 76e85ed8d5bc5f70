#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "client/residency/credit_window.h"
#include "client/residency/page_source.h"

namespace tessera::testing {

struct LinkSettings {
    double bytes_per_second = 0;  ///< Downwards; 0: without limit.
    double one_way_ms = 0;
    std::size_t page_bytes = 35'000;  ///< On the wire.
    double loss = 0;           ///< Share of answers that never come; the source says so after a second.
    double duplicates = 0;     ///< Share of answers that come twice.
    double most_delay_ms = 0;  ///< An answer takes up to so much longer: they overtake each other.
};

/// A server of pages that people edit, and the link to it, in one process and on a clock that the test turns:
/// the stream as client/residency sees it. Requests wait at the server by urgency; the downlink carries one
/// answer after the other; an answer holds what was true when it left.
class SimulatedStream : public PageSource {
  public:
    /// Texels of a version of a page; slot_bytes.
    using Paint = std::function<std::string(PageKey, std::uint32_t history, std::uint64_t revision)>;

    SimulatedStream(const LinkSettings& link, Paint paint, unsigned seed = 1)
        : link_{link}, paint_{std::move(paint)}, random_{seed} {}

    // ---- The client's side
    bool request(const PageRequest& request) override;
    void cancel(PageRequestId id) override;
    std::vector<ArrivedPage> take_arrived(std::size_t most) override;
    void allow(std::size_t answers) override { allowed_ = answers; }
    void watch(std::span<const PageWindow> windows, std::uint64_t seen_revision) override;
    SceneNews take_news() override;

    // ---- The test's side
    /// All that happens up to `now`.
    void advance(ClientTime now);
    /// One accepted edit: these pages are others from now on.
    void edit(const std::vector<PageKey>& pages);
    /// The scene is another one; its revisions begin at 0.
    void replace_scene();
    /// All that is under way is lost. `remembers`: the server can tell what changed meanwhile.
    void disconnect(double ms, bool remembers);

    std::uint32_t history() const { return history_; }
    std::uint64_t scene_revision() const { return revision_; }
    std::uint64_t revision_of(PageKey page) const;
    std::size_t under_way() const { return under_way_.size(); }

    Step interval = 0;               ///< Pages change every so many steps; 0: never.
    std::vector<PageRequest> asked;  ///< All requests ever; tests may clear it.
    std::uint64_t pages_sent = 0;
    std::uint64_t bytes_sent = 0;
    std::size_t most_under_way = 0;
    std::size_t duplicate_requests = 0;  ///< Of a page that was under way already.
    std::size_t over_allowance = 0;      ///< Requests beyond what was allowed.

  private:
    struct Message {
        enum class Kind { request, cancel, watch } kind{};
        PageRequest request{};
        PageRequestId id = 0;
        std::vector<PageWindow> windows{};
        std::uint64_t seen = 0;
    };
    struct Answer {
        double at = 0;
        ArrivedPage page;
    };
    struct News {
        double at = 0;
        SceneNews news;
    };
    void take_message(Message& message, double at);
    void send_next();
    void answer(ArrivedPage page, double at);
    void tell(SceneNews news, double at);
    bool is_watched(PageKey page) const;

    LinkSettings link_;
    Paint paint_;
    std::mt19937 random_;
    double now_ = 0;
    double link_free_ = 0;
    double offline_until_ = 0;
    bool is_offline_ = false;
    bool remembers_ = true;
    std::size_t allowed_ = 1000;

    // The truth
    std::uint32_t history_ = 0;
    std::uint64_t revision_ = 0;
    std::map<PageKey, std::uint64_t> revisions_;

    // The server's and the wire's state
    std::deque<std::pair<double, Message>> upwards_;
    std::vector<PageRequest> queue_;
    std::vector<PageWindow> windows_;
    std::optional<Message> windows_to_say_;  ///< When the connection is there again
    std::uint64_t told_ = 0;
    std::vector<Answer> downwards_;
    std::deque<News> news_;

    std::map<PageRequestId, PageKey> under_way_;  ///< As the client sees it
};

}  // namespace tessera::testing
