#include "server/sampling/sample_service.h"

#include <algorithm>
#include <optional>
#include <stop_token>

#include "server/sampling/sample_answer.h"
#include "server/sampling/sample_plan.h"

namespace tessera {

using Clock = std::chrono::steady_clock;

/// One request on its way. Guarded by the service's lock, but for what never changes and, while parts are
/// being sampled, each part's own samples.
struct SampleJob {
    SampleCall call;
    Clock::time_point asked, begun, sampled;
    std::stop_source stop;
    SampleService::Handler handler;  ///< Empty once it was called or the asker has left.

    SampleRequest request;
    SamplePlan plan;
    std::vector<FilteredSample> samples;
    std::vector<std::uint8_t> steps_taken;
    std::size_t next_part = 0, parts = 0, parts_running = 0;
    std::optional<Error> failure;  ///< The first one.
};

namespace {

/// As many footprints are a part: enough that taking one costs nothing, few enough to share fairly.
constexpr std::size_t part_footprints = 256;

Error too_many_waiting() {
    return {ErrorCode::overloaded, "too many requests for samples wait; ask again in a second"};
}

}  // namespace

SampleService::SampleService(const SampleServiceLimits& limits, prometheus::Registry& registry,
                             SamplerStore::Makers makers)
    : limits_{limits},
      metrics_{registry},
      store_{{.memory_bytes = limits.memory_bytes, .samplers = std::max<std::size_t>(8, limits.threads + 4)},
             std::move(makers)} {
    for (std::size_t i = 0; i < std::max<std::size_t>(limits.threads, 1); ++i)
        threads_.emplace_back([this] { work(); });
}

void SampleService::stop() {
    std::vector<Handler> handlers;
    {
        const std::lock_guard lock{mutex_};
        stopping_ = true;
        for (const JobPtr& job : open_) {
            job->stop.request_stop();
            if (job->handler) handlers.push_back(std::exchange(job->handler, {}));
        }
        open_.clear();
        arrived_.clear();
        begun_.clear();
    }
    work_arrived_.notify_all();
    for (const Handler& handler : handlers) handler(Error{ErrorCode::cancelled, "the server is stopping"});
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
}

SampleService::Ticket SampleService::request(SampleCall call, Handler handler) {
    Ticket ticket;
    {
        std::unique_lock lock{mutex_};
        if (stopping_ || open_.size() >= limits_.waiting_requests) {
            lock.unlock();
            metrics_.count(SampleResult::overloaded);
            handler(too_many_waiting());
            return ticket;
        }
        const auto job = std::make_shared<SampleJob>();
        job->call = std::move(call);
        job->asked = Clock::now();
        job->handler = std::move(handler);
        open_.push_back(job);
        arrived_.push_back(job);
        ticket.service_ = this;
        ticket.job_ = job;
    }
    work_arrived_.notify_one();
    return ticket;
}

void SampleService::Ticket::leave() {
    if (service_ == nullptr) return;
    std::exchange(service_, nullptr)->leave(job_);
    job_.reset();
}

void SampleService::leave(const JobPtr& job) {
    Handler dropped;  // destroyed after the lock is released: it may own anything
    const std::lock_guard lock{mutex_};
    if (!job->handler) return;  // answered already
    dropped = std::exchange(job->handler, {});
    job->stop.request_stop();
    metrics_.count(SampleResult::cancelled);
    std::erase(open_, job);
    std::erase(arrived_, job);
    if (std::erase(begun_, job) != 0) {
        job->next_part = job->parts;
        if (job->parts_running == 0) --in_memory_;
    }
    work_arrived_.notify_one();
}

void SampleService::work() {
    // So many bodies may be in memory as footprints and messages; the rest waits as it came
    const std::size_t most_in_memory = limits_.threads + 4;
    std::unique_lock lock{mutex_};
    for (;;) {
        work_arrived_.wait(lock, [&] {
            return stopping_ || !begun_.empty() || (!arrived_.empty() && in_memory_ < most_in_memory);
        });
        if (stopping_) return;

        if (!arrived_.empty() && in_memory_ < most_in_memory) {
            const JobPtr job = arrived_.front();
            arrived_.pop_front();
            ++in_memory_;
            job->begun = Clock::now();
            job->parts_running = 1;
            lock.unlock();
            const auto good = read(*job);
            lock.lock();
            job->parts_running = 0;
            if (!good) job->failure = good.error();
            const bool wanted = static_cast<bool>(job->handler) && !job->failure && !stopping_;
            if (!wanted) {
                end(job, lock);
                continue;
            }
            begun_.push_back(job);
            work_arrived_.notify_all();
            continue;
        }

        // The next part of the request whose turn it is, which then goes behind the others
        const JobPtr job = begun_.front();
        begun_.pop_front();
        const std::size_t part = job->next_part++;
        ++job->parts_running;
        if (job->next_part < job->parts) begun_.push_back(job);
        lock.unlock();
        const auto good = sample(*job, part);
        lock.lock();
        --job->parts_running;
        if (!good && !job->failure) {
            job->failure = good.error();
            job->next_part = job->parts;
            std::erase(begun_, job);
        }
        if (job->parts_running == 0 && job->next_part == job->parts) end(job, lock);
    }
}

/// Answers whoever still waits. The lock is held, and given up meanwhile.
void SampleService::end(const JobPtr& job, std::unique_lock<std::mutex>& lock) {
    const bool wanted = static_cast<bool>(job->handler);
    lock.unlock();
    Result<SampleReply> reply = Error{ErrorCode::cancelled, "nobody waits for these samples any more"};
    if (wanted) reply = reply_of(*job);
    lock.lock();
    --in_memory_;
    std::erase(open_, job);
    const Handler handler = std::exchange(job->handler, {});
    lock.unlock();
    work_arrived_.notify_one();
    if (handler) {
        if (reply) {
            metrics_.count(SampleResult::answered);
            metrics_.request_seconds.Observe(
                std::chrono::duration<double>(Clock::now() - job->asked).count());
        } else {
            count_failure(reply.error().code);
        }
        handler(std::move(reply));
    }
    lock.lock();
}

/// Body -> footprints and plan. A request that does not fit into memory costs its own asker an error, and
/// nobody else anything.
Result<void> SampleService::read(SampleJob& job) {
    if (const auto spent = check_budget({.deadline = job.asked + limits_.deadline}); !spent) return spent;
    try {
        auto request = read_sample_request(job.call.body, job.call.coding);
        job.call.body = {};
        if (!request) return request.error();
        const Scene& scene = *job.call.scene;
        if (scene.texture_of(request->channels) == nullptr)
            return Error{ErrorCode::no_such_page, "channels: the scene has no \"" +
                                                      std::string{name_of(request->channels)} +
                                                      "\"; it has " + scene.channel_names()};
        const std::int64_t slice = scene.same_slice(request->slice);
        for (Footprint& footprint : request->footprints) footprint.slice = slice;
        request->time = {scene.same_step(request->time.step), scene.same_parameter(request->time.parameter)};
        job.plan = choose_filter(request->filter, request->accuracy, request->max_error);
        job.samples.resize(request->footprints.size());
        job.steps_taken.resize(request->footprints.size());
        job.parts = (request->footprints.size() + part_footprints - 1) / part_footprints;
        job.request = std::move(*request);
        return {};
    } catch (const std::exception& failure) {
        return Error{ErrorCode::io_failure, std::string{"the request could not be read: "} + failure.what()};
    }
}

Result<void> SampleService::sample(SampleJob& job, std::size_t part) {
    const std::size_t first = part * part_footprints;
    const std::size_t count = std::min(part_footprints, job.samples.size() - first);
    Budget budget{.deadline = job.asked + limits_.deadline, .cancelled = job.stop.get_token()};
    const auto run = [&](const SampleStep& step, std::span<const Footprint> footprints,
                         std::span<FilteredSample> samples) -> Result<void> {
        budget.accuracy = step.texels;
        if (const auto spent = check_budget(budget); !spent) return spent;
        const Clock::time_point begun = Clock::now();
        const auto sampler = store_.borrow(job.call.scene, job.request.channels, step, job.request.time);
        const auto done = sampler->sample(footprints, budget, samples);
        std::uint64_t texels = 0;
        for (const FilteredSample& sample : samples) texels += sample.texels;
        metrics_.count(step.filter.kind, footprints.size(), texels, Clock::now() - begun);
        return done;
    };
    try {
        return sample_by(job.plan, std::span{job.request.footprints}.subspan(first, count), run,
                         std::span{job.samples}.subspan(first, count),
                         std::span{job.steps_taken}.subspan(first, count));
    } catch (const std::exception& failure) {
        return Error{ErrorCode::io_failure, std::string{"sampling failed: "} + failure.what()};
    }
}

Result<SampleReply> SampleService::reply_of(SampleJob& job) {
    if (job.failure && job.failure->code == ErrorCode::timed_out)
        return Error{ErrorCode::timed_out,
                     "the samples took too long; send fewer footprints, or ask for accuracy=fast"};
    if (job.failure) return *job.failure;
    job.sampled = Clock::now();
    try {
        return SampleReply{
            write_sample_answer(job.plan, job.samples, job.steps_taken, job.call.scene->revision,
                                job.sampled - job.asked, job.call.answer),
            job.call.answer, job.begun - job.asked, job.sampled - job.begun};
    } catch (const std::exception& failure) {
        return Error{ErrorCode::io_failure,
                     std::string{"the answer could not be written: "} + failure.what()};
    }
}

void SampleService::count_failure(ErrorCode code) noexcept {
    switch (code) {
        case ErrorCode::malformed_request:
        case ErrorCode::no_such_page:
            return metrics_.count(SampleResult::malformed);
        case ErrorCode::timed_out:
            return metrics_.count(SampleResult::timed_out);
        case ErrorCode::cancelled:
            return metrics_.count(SampleResult::cancelled);
        default:
            return metrics_.count(SampleResult::failed);
    }
}

void SampleService::update_gauges() {
    metrics_.page_bytes.Set(static_cast<double>(store_.page_bytes()));
    metrics_.samplers.Set(static_cast<double>(store_.idle_samplers()));
    const std::lock_guard lock{mutex_};
    metrics_.waiting.Set(static_cast<double>(open_.size()));
}

}  // namespace tessera
