#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/sampling/sample_metrics.h"
#include "server/sampling/sample_request.h"
#include "server/sampling/sampler_store.h"
#include "server/scene/scene.h"
#include "shared/result/result.h"

namespace tessera {

struct SampleServiceLimits {
    std::size_t threads = 1;            ///< That read, sample and write; at least 1.
    std::size_t waiting_requests = 64;  ///< Without an answer; beyond it, overloaded.
    /// Of texels and filters kept between requests. Too little evaluates the same texels again and again.
    std::size_t memory_bytes = std::size_t{512} << 20;
    std::chrono::milliseconds deadline{10'000};  ///< From a request to its last sample.
};

/// A request as it came: its body is read on a thread of the service.
struct SampleCall {
    ScenePtr scene;  ///< Not null.
    std::string body;
    WireCoding coding = WireCoding::protobuf;  ///< Of the body.
    WireCoding answer = WireCoding::protobuf;
};

/// What is sent back.
struct SampleReply {
    std::string body;
    WireCoding coding = WireCoding::protobuf;
    std::chrono::nanoseconds queued{},
        sampled{};  ///< Before the body was read; from there to the last sample.
};

/// Footprints -> colours, on threads of its own. The footprints of a request are dealt to the threads in
/// parts, and the requests take turns, so that a large one does not hold up a small one. A request whose
/// asker has left is dropped after the part that is under way. All members may be called from any thread.
class SampleService {
  public:
    using Handler = std::function<void(Result<SampleReply>)>;

    /// A place in the line. Destroying it gives the place up; the handler may still be called if it is just
    /// being called. The service outlives its tickets.
    class Ticket {
      public:
        Ticket() = default;
        ~Ticket() { leave(); }
        Ticket(Ticket&& other) noexcept
            : service_{std::exchange(other.service_, nullptr)}, job_{std::move(other.job_)} {}
        Ticket& operator=(Ticket&& other) noexcept {
            if (this == &other) return *this;
            leave();
            service_ = std::exchange(other.service_, nullptr);
            job_ = std::move(other.job_);
            return *this;
        }
        void leave();

      private:
        friend class SampleService;
        SampleService* service_ = nullptr;
        std::shared_ptr<struct SampleJob> job_;
    };

    /// `registry` outlives the service.
    SampleService(const SampleServiceLimits& limits, prometheus::Registry& registry,
                  SamplerStore::Makers makers = {});
    ~SampleService() { stop(); }
    SampleService(const SampleService&) = delete;
    SampleService& operator=(const SampleService&) = delete;

    /// Calls `handler` once, on another thread or before returning, with the reply or with malformed_request,
    /// no_such_page (the scene has no such channels), overloaded, timed_out, cancelled or io_failure; not at
    /// all once the ticket is given up.
    [[nodiscard]] Ticket request(SampleCall call, Handler handler);

    /// The scenes served are others from now on: keeps nothing of the old ones.
    void forget_scenes() { store_.forget(); }

    /// Whoever waits gets `cancelled`, as does whoever asks from now on. Returns when the threads have ended.
    /// Idempotent; not to be called twice at a time.
    void stop();

    void update_gauges();
    const SampleMetrics& metrics() const noexcept { return metrics_; }
    const SampleServiceLimits& limits() const noexcept { return limits_; }

  private:
    using JobPtr = std::shared_ptr<SampleJob>;

    void work();
    Result<void> read(SampleJob& job);
    Result<void> sample(SampleJob& job, std::size_t part);
    void end(const JobPtr& job, std::unique_lock<std::mutex>& lock);
    Result<SampleReply> reply_of(SampleJob& job);
    void leave(const JobPtr& job);
    void count_failure(ErrorCode code) noexcept;

    friend struct SampleJob;
    const SampleServiceLimits limits_;
    SampleMetrics metrics_;
    SamplerStore store_;

    std::mutex mutex_;  ///< Guards what follows; never held while sampling or calling a handler.
    std::condition_variable work_arrived_;
    std::deque<JobPtr> begun_;    ///< Their footprints are read, and parts of them not yet taken.
    std::deque<JobPtr> arrived_;  ///< Their bodies are not read yet.
    std::vector<JobPtr> open_;    ///< All that have no answer yet.
    std::size_t in_memory_ = 0;   ///< Requests whose bodies are being read or have been.
    bool stopping_ = false;

    std::vector<std::thread> threads_;  ///< Last: they use everything above.
};

}  // namespace tessera
