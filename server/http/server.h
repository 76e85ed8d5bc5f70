#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <prometheus/registry.h>

#include "server/http/body_budget.h"
#include "server/http/http_metrics.h"
#include "server/http/routes.h"
#include "server/http/server_options.h"
#include "server/http/web_files.h"
#include "server/pages/page_service.h"
#include "server/scene/scene.h"
#include "server/stream/stream_service.h"
#include "shared/result/result.h"

namespace tessera {

class Listener;
struct IoThread;

/// The running server: listens, answers, is given scenes, stops. Its members may be called from any thread.
class Server {
  public:
    /// Binds and starts to answer: /healthz at once, scenes after publish(). Error: io_failure with the
    /// address and what is wrong with it.
    static Result<std::unique_ptr<Server>> start(const ServerOptions& options);
    /// Stops, if stop() was not called.
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// Serves these from now on, in place of what was served before. Returns when every I/O thread does. Does
    /// nothing once the server is stopping.
    void publish(std::shared_ptr<const Catalog> catalog, std::shared_ptr<const WebFiles> web,
                 std::shared_ptr<const Access> access = std::make_shared<const Access>());

    /// Accepts nothing more, lets answers in flight finish within the grace period, ends the rest.
    /// Idempotent.
    void stop();

    std::string address() const;  ///< "http://127.0.0.1:7070"
    std::uint16_t port() const;

    PageService& pages() noexcept { return pages_; }
    SampleService& samples() noexcept { return samples_; }
    EditService& edits() noexcept { return edits_; }
    HttpMetrics& metrics() noexcept { return metrics_; }
    const StreamMetrics& stream_metrics() const noexcept { return streams_.metrics; }

  private:
    explicit Server(const ServerOptions& options);

    /// Runs `job` on every I/O thread with that thread's context, and waits for all.
    template <class Job>
    void on_every_thread(Job job);
    bool sessions_left();

    const ServerOptions options_;
    prometheus::Registry registry_;
    HttpMetrics metrics_;
    PageService pages_;
    SampleService samples_;
    EditService edits_;
    StreamService streams_;
    BodyBudget bodies_;
    Routes routes_;
    std::vector<std::unique_ptr<IoThread>> threads_;
    std::unique_ptr<Listener> listener_;
    std::mutex publishing_;  ///< Held while scenes are handed to the threads: they run until it is released.
    bool stopped_ = false;   ///< Guarded by publishing_.
};

}  // namespace tessera
