#pragma once

#include <chrono>
#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <boost/asio/basic_waitable_timer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include "server/access/access.h"
#include "server/scene/scene.h"
#include "server/stream/page_socket.h"
#include "server/stream/scene_hub.h"

namespace tessera {

class StreamService;
class StreamSession;

/// Who opens a stream, and to what. The address, the Origin and the handshake are checked.
struct StreamOpening {
    std::string scene;
    bool from_loopback = false;        ///< And so without a token. Not what a page of somebody else's opened.
    std::string token;                 ///< In the header; ClientHello may bring another.
    std::shared_ptr<void> place;       ///< From StreamService::admit().
    std::shared_ptr<void> connection;  ///< Counts the connection until it ends.
};

/// The streams of one I/O thread. All members are called on it.
class StreamThread {
  public:
    using Clock = std::chrono::steady_clock;
    using Upgrade = boost::beast::http::request<boost::beast::http::empty_body>;

    /// `service` outlives this.
    explicit StreamThread(StreamService& service);
    ~StreamThread();
    StreamThread(const StreamThread&) = delete;
    StreamThread& operator=(const StreamThread&) = delete;

    /// Before anything else. Sessions that are cut off end with the thread's io_context, for which this
    /// object still has to be there; but it must have nothing of the io_context's then.
    void attach(IoExecutor executor);
    void detach();

    /// StreamService::admit().
    std::shared_ptr<void> admit();

    /// Takes the socket over; it lives until the stream ends.
    void serve(PageSocket socket, const Upgrade& upgrade, StreamOpening opening);

    /// What is served from now on.
    void publish(std::shared_ptr<const Catalog> catalog, std::shared_ptr<const Access> access);

    /// Ends what waits longer than it may. Called a few times a second.
    void check_deadlines(Clock::time_point now);
    /// Tells everybody goodbye.
    void drain();
    void abort();
    std::size_t size() const noexcept { return sessions_.size(); }

    // For the sessions
    StreamService& service() noexcept { return service_; }
    const IoExecutor& executor() const noexcept { return *executor_; }
    const Catalog& catalog() const noexcept { return *catalog_; }
    const Access& access() const noexcept { return *access_; }
    std::shared_ptr<Audience> audience(const std::shared_ptr<SceneHub>& hub);
    /// woke() is called then, or a few milliseconds later.
    void wake_at(Clock::time_point time, const std::shared_ptr<StreamSession>& session);

  private:
    friend class StreamSession;
    void wait();

    using Timer = boost::asio::basic_waitable_timer<Clock, boost::asio::wait_traits<Clock>, IoExecutor>;

    std::optional<IoExecutor> executor_;
    StreamService& service_;
    std::shared_ptr<const Catalog> catalog_;
    std::shared_ptr<const Access> access_;
    std::list<StreamSession*> sessions_;  ///< Those alive; they take themselves out.
    std::map<std::shared_ptr<SceneHub>, std::shared_ptr<Audience>> audiences_;
    std::multimap<Clock::time_point, std::weak_ptr<StreamSession>> sleepers_;
    std::optional<Timer> timer_;
    Clock::time_point wakes_at_ = Clock::time_point::max();
};

}  // namespace tessera
