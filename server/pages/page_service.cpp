#include "server/pages/page_service.h"

#include <algorithm>
#include <stop_token>
#include <utility>

#include "server/pages/evaluate_within.h"

namespace tessera {

using Clock = std::chrono::steady_clock;

/// One page on its way. Its members are guarded by the service's lock, but for what never changes.
struct PageJob {
    PageRequest request;
    PageId id;
    Clock::time_point asked;
    std::stop_source stop;
    EvaluationQueue<PageJob>::Place place;
    bool queued = true;
    std::vector<PageService::Waiter> waiters;
};

namespace {

double to_seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

Error too_many_waiting() {
    return {ErrorCode::overloaded, "too many pages wait to be evaluated; ask again in a second"};
}

}  // namespace

PageService::PageService(const PageServiceLimits& limits, prometheus::Registry& registry,
                         MakePrelude make_prelude)
    : limits_{limits},
      make_prelude_{std::move(make_prelude)},
      metrics_{registry},
      cache_{limits.cache_bytes},
      queue_{limits.queued_pages} {
    for (std::size_t i = 0; i < std::max<std::size_t>(limits.threads, 1); ++i)
        threads_.emplace_back([this] { work(); });
}

void PageService::stop() {
    std::vector<Waiter> waiters;
    {
        const std::lock_guard lock{mutex_};
        stopping_ = true;
        while (!queue_.empty())
            for (Waiter& waiter : finish(queue_.take_most_urgent())) waiters.push_back(std::move(waiter));
        for (const JobPtr& job : running_) job->stop.request_stop();
    }
    work_arrived_.notify_all();
    answer(waiters, Error{ErrorCode::cancelled, "the server is stopping"});
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
}

std::optional<PageId> PageService::id_of(const PageRequest& request) {
    const PageId line = page_id(request);
    if (!request.scene->animated) return line;
    const auto interval = intervals_.find(line, request.options.step);
    if (!interval) return std::nullopt;
    return page_id(line, interval->from);
}

PagePtr PageService::find(PageId id, const PageRequest& request) {
    PagePtr page = cache_.find(id);
    if (page) {
        metrics_.count(PageResult::cached, request.key.level);
        metrics_.count(request.options.channels);
    }
    return page;
}

PageService::Ticket PageService::request(const PageRequest& request, Handler handler) {
    // What is asked for: of a scene that moves, the step counts until the page's interval is known
    const PageId line = page_id(request);
    const PageId id = request.scene->animated ? page_id(line, request.options.step) : line;
    const std::uint8_t level = request.key.level;
    metrics_.count(request.options.channels);
    Ticket ticket;
    JobPtr pushed_out;
    std::vector<Waiter> turned_away;
    {
        std::unique_lock lock{mutex_};
        // A finished page enters the cache before it leaves in_flight_, so under the lock it is in one of
        // them
        const auto flying = in_flight_.find(id);
        if (flying == in_flight_.end()) {
            const auto known = id_of(request);
            if (PagePtr page = known ? cache_.find(*known) : nullptr) {
                lock.unlock();
                metrics_.count(PageResult::cached, level);
                handler(std::move(page));
                return ticket;
            }
        }

        JobPtr job;
        if (flying != in_flight_.end()) {
            job = flying->second;
            metrics_.count(PageResult::coalesced, level);
            if (job->queued && request.urgency < job->place.urgency) {
                queue_.erase(job->place);
                job->place.urgency = request.urgency;
                queue_.push(job->place, job);
            }
        } else {
            // A full queue gives up what is less urgent than this, or else this
            const bool room = !queue_.full();
            const bool push_out = !room && !queue_.empty() && request.urgency < queue_.least_urgent().urgency;
            if (stopping_ || (!room && !push_out)) {
                lock.unlock();
                metrics_.count(PageResult::overloaded, level);
                handler(too_many_waiting());
                return ticket;
            }
            if (push_out) {
                pushed_out = queue_.take_least_urgent();
                turned_away = finish(pushed_out);
            }
            job = std::make_shared<PageJob>();
            job->request = request;
            job->id = id;
            job->asked = Clock::now();
            job->place = {request.urgency, level, next_number_++};
            queue_.push(job->place, job);
            in_flight_.emplace(id, job);
            metrics_.count(PageResult::evaluated, level);
            work_arrived_.notify_one();
        }
        ticket.service_ = this;
        ticket.job_ = job;
        ticket.waiter_ = next_number_++;
        job->waiters.push_back({ticket.waiter_, std::move(handler)});
    }
    for (std::size_t i = 0; i < turned_away.size(); ++i)
        metrics_.count(PageResult::overloaded, pushed_out->request.key.level);
    answer(turned_away, too_many_waiting());
    return ticket;
}

void PageService::Ticket::leave() {
    if (service_ == nullptr) return;
    std::exchange(service_, nullptr)->leave(*job_, waiter_);
    job_.reset();
}

void PageService::leave(PageJob& job, std::uint64_t waiter) {
    Handler dropped;  // destroyed after the lock is released: it may own anything
    const std::lock_guard lock{mutex_};
    const auto found = std::find_if(job.waiters.begin(), job.waiters.end(),
                                    [waiter](const Waiter& w) { return w.number == waiter; });
    if (found == job.waiters.end()) return;  // answered already
    dropped = std::move(found->handler);
    job.waiters.erase(found);
    metrics_.count(PageResult::cancelled, job.request.key.level);
    if (!job.waiters.empty()) return;

    // Nobody waits any more: whoever asks from now on starts afresh
    metrics_.evaluations_abandoned.Increment();
    if (job.queued) queue_.erase(job.place);
    job.stop.request_stop();
    if (const auto flying = in_flight_.find(job.id);
        flying != in_flight_.end() && flying->second.get() == &job)
        in_flight_.erase(flying);
}

/// Takes `job` out of in_flight_, and its waiters out of it. The lock is held.
std::vector<PageService::Waiter> PageService::finish(const JobPtr& job) {
    job->queued = false;
    const auto flying = in_flight_.find(job->id);
    if (flying != in_flight_.end() && flying->second == job) in_flight_.erase(flying);
    return std::exchange(job->waiters, {});
}

void PageService::answer(std::vector<Waiter>& waiters, const Result<PagePtr>& result) {
    for (Waiter& waiter : waiters) waiter.handler(result);
}

void PageService::work() {
    std::unique_lock lock{mutex_};
    for (;;) {
        work_arrived_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
        if (stopping_) return;
        const JobPtr job = queue_.take_most_urgent();
        job->queued = false;
        running_.push_back(job);
        lock.unlock();

        const Result<PagePtr> page = evaluate_guarded(*job);
        if (page) {
            cache_.insert(*page);
            if (job->request.scene->animated)
                intervals_.insert(page_id(job->request), (*page)->evaluation.validity);
        }

        lock.lock();
        std::erase(running_, job);
        std::vector<Waiter> waiters = finish(job);
        lock.unlock();
        if (!page)
            for (std::size_t i = 0; i < waiters.size(); ++i)
                count_failure(page.error().code, job->request.key.level);
        answer(waiters, page);
        waiters.clear();
        lock.lock();
    }
}

/// A page that does not fit into memory costs its own askers an error, and nobody else anything.
Result<PagePtr> PageService::evaluate_guarded(PageJob& job) {
    try {
        return evaluate(job);
    } catch (const std::exception& failure) {
        return Error{ErrorCode::io_failure, std::string{"the evaluation failed: "} + failure.what()};
    }
}

Result<PagePtr> PageService::evaluate(PageJob& job) {
    const PageRequest& request = job.request;
    const Clock::time_point begun = Clock::now();
    const Budget budget{request.options.accuracy, job.asked + limits_.deadline, job.stop.get_token()};
    metrics_.queue_seconds.Observe(to_seconds(begun - job.asked));
    if (const auto spent = check_budget(budget); !spent) return spent.error();

    metrics_.evaluations.Increment();
    Rgba8Image image;
    const Texture* const texture = request.scene->texture_of(request.options.channels);
    if (texture == nullptr) return Error{ErrorCode::malformed_request, "the scene has no such channels"};
    TexelRegion region = region_of(request.key, request.options.gutter);
    region.slice = request.options.slice;
    region.step = request.options.step;
    region.parameter = request.options.parameter;
    const auto evaluated_within = evaluate_within(*texture, region, request.options.max_error, budget, image);
    if (!evaluated_within) return evaluated_within.error();
    const Clock::time_point evaluated = Clock::now();
    metrics_.evaluate_seconds.Observe(to_seconds(evaluated - begun));

    auto page = std::make_shared<EncodedPage>();
    page->id = request.scene->animated ? page_id(page_id(request), evaluated_within->evaluation.validity.from)
                                       : job.id;
    page->key = request.key;
    page->options = request.options;
    page->revision = page_revision(*request.scene, request.key);
    page->evaluation = evaluated_within->evaluation;
    page->accuracy = evaluated_within->accuracy;
    page->within_limit = evaluated_within->met;
    if (is_one_colour(image)) {
        const std::uint8_t* const texel = image.bytes.data();
        page->colour = std::uint32_t{texel[0]} | std::uint32_t{texel[1]} << 8 |
                       std::uint32_t{texel[2]} << 16 | std::uint32_t{texel[3]} << 24;
        auto shared = one_colour_pages_.encode(image, texture->texel_kind(), request.options.format,
                                               request.options.coding);
        if (!shared) return shared.error();
        page->bytes = *shared;
    } else {
        auto bytes =
            encode_body(image, texture->texel_kind(), request.options.format, request.options.coding);
        if (!bytes) return bytes.error();
        bytes->shrink_to_fit();
        page->bytes = std::make_shared<const EncodedBytes>(std::move(*bytes));
    }
    const Clock::time_point encoded = Clock::now();
    metrics_.encode_seconds.Observe(to_seconds(encoded - evaluated));
    page->queued = begun - job.asked;
    page->evaluated = evaluated - begun;
    page->encoded = encoded - evaluated;
    if (make_prelude_) page->prelude = make_prelude_(*page);
    return PagePtr{std::move(page)};
}

void PageService::count_failure(ErrorCode code, std::uint8_t level) noexcept {
    metrics_.count(code == ErrorCode::timed_out   ? PageResult::timed_out
                   : code == ErrorCode::cancelled ? PageResult::cancelled
                                                  : PageResult::failed,
                   level);
}

void PageService::update_gauges() {
    const PageCache::Usage usage = cache_.usage();
    metrics_.cache_bytes.Set(static_cast<double>(usage.bytes));
    metrics_.cache_pages.Set(static_cast<double>(usage.pages));
    metrics_.cache_evictions.Set(static_cast<double>(usage.evictions));
    const std::lock_guard lock{mutex_};
    metrics_.queued.Set(static_cast<double>(queue_.size()));
    metrics_.running.Set(static_cast<double>(running_.size()));
}

}  // namespace tessera
