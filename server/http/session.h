#pragma once

#include <chrono>
#include <list>
#include <memory>
#include <string>

#include <boost/asio/awaitable.hpp>

#include "server/http/body_budget.h"
#include "server/http/http_metrics.h"
#include "server/http/request_head.h"
#include "server/http/routes.h"
#include "server/stream/page_socket.h"
#include "server/stream/stream_thread.h"

namespace tessera {

template <class T>
using Task = boost::asio::awaitable<T, IoExecutor>;

class Session;

/// "Date: …\r\n", made anew once a second.
class DateField {
  public:
    std::string_view now();

  private:
    std::int64_t second_ = -1;
    std::string text_;
};

/// What the sessions of one I/O thread share. The references outlive it.
struct SessionContext {
    SessionLimits limits;
    Routes& routes;
    PageService& pages;
    SampleService& samples;
    EditService& edits;
    BodyBudget& bodies;
    HttpMetrics& metrics;
    std::unique_ptr<StreamThread> streams;
    Site site{};                     ///< Replaced on this thread.
    std::list<Session*> sessions{};  ///< Those alive.
    DateField date{};
};

/// Answers one client's requests, in their order, until it leaves. All members are called on the context's
/// thread.
class Session : public std::enable_shared_from_this<Session> {
  public:
    using Clock = std::chrono::steady_clock;

    Session(PageSocket socket, SessionContext& context);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// Runs the session; it lives as long as this does.
    static Task<void> run(std::shared_ptr<Session> self);

    /// Ends what waits longer than it may. Called a few times a second.
    void check_deadline(Clock::time_point now);
    /// Closes an idle connection at once, and a busy one behind its answer.
    void drain();
    /// Closes the connection now.
    void abort();

  private:
    enum class ReadEnd { complete, closed, too_long, too_slow, overloaded };

    Task<void> serve();
    Task<ReadEnd> read_head(std::size_t& head_bytes);
    Task<ReadEnd> read_body(std::size_t head_bytes, const RequestHead& request, BodyBudget::Share& share,
                            std::string& body);
    Task<bool> answer_request(std::size_t head_bytes);
    static Answer body_refusal(ReadEnd end);
    Task<bool> wait_for_edit(PendingEdit pending, const RequestHead& request, std::size_t head_bytes);
    Task<bool> wait_for_samples(PendingSample pending, const RequestHead& request, std::size_t head_bytes);
    Task<bool> wait_for_page(PendingPage pending, const RequestHead& request, bool keep_alive);
    Task<bool> open_stream(const PendingStream& pending, const RequestHead& request, std::size_t head_bytes);
    Task<void> client_leaves();
    Task<bool> send(const Answer& answer, bool with_body, bool keep_alive);
    Task<void> linger();
    void set_deadline(std::chrono::milliseconds from_now) { deadline_ = Clock::now() + from_now; }

    PageSocket socket_;
    SessionContext& context_;
    std::list<Session*>::iterator place_;
    std::shared_ptr<void> connection_;  ///< Counts it until it ends, here or as a stream.
    std::string input_;                 ///< Read and not yet answered; at most limits.head_bytes.
    std::string output_;                ///< The header being sent.
    Clock::time_point deadline_ = Clock::time_point::max();
    bool expired_ = false;    ///< The deadline ended the operation that was waiting.
    bool idle_ = false;       ///< Waits for the first byte of a request.
    bool is_stream_ = false;  ///< The socket is somebody else's now.
};

}  // namespace tessera
