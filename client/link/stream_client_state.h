#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include "client/link/stream_asks.h"
#include "client/link/stream_client.h"

namespace tessera {

/// What a StreamClient is inside: one loop that connects, reads until the connection is lost and waits to
/// connect again; beside it, one loop for each connection that sends what there is to send, and one that
/// looks at the time.
class StreamClient::State : public std::enable_shared_from_this<State> {
  public:
    State(boost::asio::any_io_executor executor, ServerAddress server, const std::string& scene,
          StreamSettings settings, StreamListener& listener);
    void start();
    void shut_down();

    bool is_open() const noexcept { return line_ && line_->open; }
    bool ask(const StreamAsk& ask);
    void cancel(std::uint32_t id);
    void allow(std::uint32_t pages);
    void watch(std::vector<proto::Window> windows, std::uint64_t seen_revision);
    std::string edit(proto::Edit edit, PendingEdits::Completion done);
    void be_present(const proto::Presence& presence);
    std::uint64_t newest_revision() const noexcept { return newest_revision_; }
    StreamStatistics statistics() const;

  private:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;

    /// One connection and what is to be said on it.
    struct Line {
        Line(boost::asio::any_io_executor executor, ServerAddress server, WebSocketLimits most)
            : socket{std::make_shared<WebSocket>(executor, std::move(server), most)}, wake{executor} {}
        std::shared_ptr<WebSocket> socket;
        boost::asio::steady_timer wake;
        bool open = false;  ///< Both sides have said hello.
        proto::StreamLimits limits;
        std::vector<std::uint32_t> cancels;
        bool tell_windows = false;
        bool tell_presence = false;
        std::uint32_t credits = 0;  ///< That the server has left.
        std::uint32_t mistakes = 0;
        Time next_presence{};
        Time next_ping{};
        std::optional<Time> pinged;
        std::uint64_t ping = 0;
    };
    using LinePtr = std::shared_ptr<Line>;

    boost::asio::awaitable<void> run();
    boost::asio::awaitable<Error> live(LinePtr line);
    boost::asio::awaitable<Result<void>> say_hello(LinePtr line);
    boost::asio::awaitable<void> send(LinePtr line);
    boost::asio::awaitable<void> keep_time();
    void lose(const Error& why, std::chrono::milliseconds retry_in);
    std::chrono::milliseconds next_back_off(const Line& line, bool was_open, Time opened);
    void wake();

    /// What there is to say next; nothing: sleep until `until`.
    std::optional<proto::ClientMessage> next_message(Line& line, Time now, Time& until);
    bool write_windows(Line& line, proto::ClientMessage& message);
    bool write_asks(Line& line, proto::ClientMessage& message);
    bool write_credits(Line& line, proto::ClientMessage& message);

    /// What the server said; an error ends the connection.
    std::optional<Error> hear(Line& line, const std::string& bytes);
    std::optional<Error> open(Line& line, const proto::ServerHello& hello);
    std::optional<Error> hear_page(Line& line, proto::PageData&& data, std::size_t wire_bytes);
    std::optional<Error> hear_refusal(Line& line, const proto::PageRefusal& refusal);
    void hear_edit(const proto::EditDone& done);
    void hear_pong(Line& line, const proto::Pong& pong);
    std::optional<Error> mistake(Line& line, const std::string& what);
    void end(std::vector<PendingEdits::Ended> ended);

    boost::asio::any_io_executor executor_;
    ServerAddress server_;
    std::string target_;
    StreamSettings settings_;
    StreamListener* listener_;  ///< Null when it is over.
    boost::asio::steady_timer retry_timer_, time_timer_;
    std::minstd_rand dice_;
    bool is_over_ = false;
    LinePtr line_;
    int failures_ = 0;  ///< Connections in a row that did not last.

    StreamAsks asks_;
    PendingEdits edits_;
    std::uint32_t allowed_ = 0;
    std::vector<proto::Window> windows_;
    std::uint64_t windows_seen_ = 0;
    proto::Presence presence_;
    bool is_present_ = false;

    // What is known of the scene
    std::string lineage_, fingerprint_, history_;
    std::uint64_t histories_ = 0;
    std::uint64_t told_revision_ = 0;  ///< All edits up to it were told, as far as they touch the windows.
    std::uint64_t newest_revision_ = 0;
    StreamStatistics counts_;
    std::uint64_t bytes_of_past_lines_ = 0;
};

}  // namespace tessera
