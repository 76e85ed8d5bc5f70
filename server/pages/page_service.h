#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/pages/encoded_page.h"
#include "server/pages/evaluation_queue.h"
#include "server/pages/one_colour_pages.h"
#include "server/pages/page_cache.h"
#include "server/pages/page_intervals.h"
#include "server/pages/page_metrics.h"
#include "shared/result/result.h"

namespace tessera {

struct PageServiceLimits {
    std::size_t threads = 1;                           ///< That evaluate and encode; at least 1.
    std::size_t queued_pages = 2048;                   ///< That wait for a thread; beyond it, overloaded.
    std::size_t cache_bytes = std::size_t{256} << 20;  ///< 0 keeps nothing.
    std::chrono::milliseconds deadline{10'000};        ///< From the first request for a page to its texels.
};

/// Page request -> encoded page: from the cache, from an evaluation that is under way, or from one that is
/// scheduled on threads of its own. However many ask for a page, it is evaluated once; when the last one of
/// them leaves, it is not evaluated, or its evaluation is stopped. All members may be called from any thread.
class PageService {
  public:
    using Handler = std::function<void(Result<PagePtr>)>;
    /// What a listener says before every copy of a page, made once for each page, on an evaluation thread.
    using MakePrelude = std::function<std::string(const EncodedPage&)>;

    /// A place in the line for one page. Destroying it gives the place up; the handler may still be called
    /// if it is just being called. The service outlives its tickets.
    class Ticket {
      public:
        Ticket() = default;
        ~Ticket() { leave(); }
        Ticket(Ticket&& other) noexcept : service_{std::exchange(other.service_, nullptr)} {
            job_ = std::move(other.job_);
            waiter_ = other.waiter_;
        }
        Ticket& operator=(Ticket&& other) noexcept {
            if (this == &other) return *this;
            leave();
            service_ = std::exchange(other.service_, nullptr);
            job_ = std::move(other.job_);
            waiter_ = other.waiter_;
            return *this;
        }
        void leave();

      private:
        friend class PageService;
        PageService* service_ = nullptr;
        std::shared_ptr<struct PageJob> job_;
        std::uint64_t waiter_ = 0;
    };

    /// `registry` outlives the service.
    PageService(const PageServiceLimits& limits, prometheus::Registry& registry,
                MakePrelude make_prelude = {});
    ~PageService() { stop(); }
    PageService(const PageService&) = delete;
    PageService& operator=(const PageService&) = delete;

    /// Which page answers `request`. Of a scene that moves this is known once a page of an interval that the
    /// step lies in was evaluated. Takes microseconds.
    std::optional<PageId> id_of(const PageRequest& request);

    /// The page of `id`, which is that of `request`, if it is in the cache, else null; counts a hit. Takes
    /// microseconds, never evaluates.
    PagePtr find(PageId id, const PageRequest& request);

    /// Calls `handler` once, on another thread or before returning, with the page or with overloaded,
    /// timed_out, cancelled or io_failure; not at all once the ticket is given up.
    [[nodiscard]] Ticket request(const PageRequest& request, Handler handler);

    /// Stops running evaluations; their waiters, and those in the queue, get `cancelled`, as does whoever
    /// asks from now on. Returns when the threads have ended. Idempotent; not to be called twice at a time.
    void stop();

    /// Brings the gauges of cache and queue up to date, for a scrape.
    void update_gauges();

    const PageMetrics& metrics() const noexcept { return metrics_; }
    PageCache::Usage cache_usage() const { return cache_.usage(); }
    const PageServiceLimits& limits() const noexcept { return limits_; }

  private:
    using JobPtr = std::shared_ptr<PageJob>;
    struct Waiter {
        std::uint64_t number = 0;
        Handler handler;
    };

    void work();
    Result<PagePtr> evaluate_guarded(PageJob& job);
    Result<PagePtr> evaluate(PageJob& job);
    std::vector<Waiter> finish(const JobPtr& job);
    void leave(PageJob& job, std::uint64_t waiter);
    static void answer(std::vector<Waiter>& waiters, const Result<PagePtr>& result);
    void count_failure(ErrorCode code, std::uint8_t level) noexcept;

    friend struct PageJob;
    const PageServiceLimits limits_;
    const MakePrelude make_prelude_;
    PageMetrics metrics_;
    PageCache cache_;
    PageIntervals intervals_;
    OneColourPages one_colour_pages_;

    std::mutex mutex_;  ///< Guards what follows; never held while evaluating or calling a handler.
    std::condition_variable work_arrived_;
    EvaluationQueue<PageJob> queue_;
    std::unordered_map<PageId, JobPtr> in_flight_;  ///< Queued or running, and wanted.
    std::vector<JobPtr> running_;
    std::uint64_t next_number_ = 0;
    bool stopping_ = false;

    std::vector<std::thread> threads_;  ///< Last: they use everything above.
};

}  // namespace tessera
