#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/link/stream_client.h"

namespace tessera {

/// What was told of pages since the last time.
struct StreamNews {
    /// Counts the histories of the scene: 0 before the first connection, then from 1 on. With a new one, all
    /// that was known of pages may be wrong.
    std::uint32_t history = 0;
    std::uint64_t told_revision =
        0;  ///< All edits up to this one were told, as far as they touch the windows.
    std::uint64_t newest_revision = 0;
    std::vector<StalePageNews> stale;
    /// Copies that have not seen all edits up to this one may be wrong, whether named or not.
    std::uint64_t unsure_before = 0;
};

/// How the stream is.
struct StreamStatus {
    bool open = false;
    std::string trouble;      ///< Why it is not open, in words; empty before the first try ended.
    std::string last_loss{};  ///< The last trouble, whether it is over or not.
    std::chrono::milliseconds retry_in{0};  ///< Until the next try, as of now.
    StreamStatistics statistics;
};

/// A StreamClient on a thread of its own, for callers that must not wait: what is told is kept, merged and
/// bounded until it is taken. Every call is safe from any thread, and none but wait_for_news() waits.
class BackgroundStreamClient {
  public:
    /// `settings.max_asks`: of asks whose pages have not been taken by take_pages() yet.
    BackgroundStreamClient(ServerAddress server, std::string scene, StreamSettings settings);
    ~BackgroundStreamClient();  ///< Closes the stream, forgets what is under way, joins the thread.
    BackgroundStreamClient(const BackgroundStreamClient&) = delete;
    BackgroundStreamClient& operator=(const BackgroundStreamClient&) = delete;

    // As those of StreamClient
    bool ask(const StreamAsk& ask);
    void cancel(std::uint32_t id);
    void allow(std::uint32_t pages);
    void watch(std::vector<proto::Window> windows, std::uint64_t seen_revision);
    void be_present(const proto::Presence& presence);
    /// Its fate comes with take_fates(). Returns the edit's id.
    std::string edit(proto::Edit edit);

    /// A page, and the history that it is of.
    struct Page {
        StreamPage page;
        std::uint32_t history = 0;
    };
    std::vector<Page> take_pages(std::size_t most = static_cast<std::size_t>(-1));
    StreamNews take_news();
    struct Fate {
        std::string id;
        EditFate fate;
    };
    std::vector<Fate> take_fates();
    /// Edits of others, at most the last 1024.
    std::vector<proto::EditDone> take_edits();
    /// Who else is here now, by session.
    std::vector<proto::Present::Person> people() const;
    /// On std::chrono::steady_clock's time in milliseconds; nothing before the first connection.
    std::optional<SceneClock> clock() const;
    static SceneClock::Time clock_time();
    /// The last; nothing before the first connection.
    std::optional<proto::ServerHello> hello() const;
    StreamStatus status() const;
    /// The newest revision of the scene that was heard of.
    std::uint64_t newest_revision() const;

    /// Waits until something was told since the last call, or `timeout` has passed; true in the first case.
    bool wait_for_news(std::chrono::milliseconds timeout);

  private:
    class Worker;
    std::unique_ptr<Worker> worker_;
};

}  // namespace tessera
