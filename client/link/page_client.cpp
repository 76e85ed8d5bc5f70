#include "client/link/page_client.h"

#include <algorithm>
#include <charconv>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "client/link/page_body.h"

namespace tessera {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

namespace {

constexpr std::size_t raw_page_bytes(const FetchOptions& options) {
    const auto side = static_cast<std::size_t>(page_side_texels + 2 * options.gutter);
    return 4 * side * side;
}

/// Seconds of a Retry-After field; its other form, a date, counts as absent.
std::optional<milliseconds> retry_after(const HttpReply& reply) {
    const std::string_view text = reply.field("Retry-After");
    std::uint32_t seconds = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
    if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return std::chrono::seconds{seconds};
}

Error error_of_status(unsigned status, const std::string& target) {
    const std::string detail = target + ": status " + std::to_string(status);
    switch (status) {
        case 404:
            return {ErrorCode::no_such_page, detail};
        case 410:
            return {ErrorCode::page_changed, detail};
        case 429:
        case 503:
            return {ErrorCode::overloaded, detail};
        default:
            break;
    }
    return {status >= 400 && status < 500 ? ErrorCode::malformed_request : ErrorCode::io_failure, detail};
}

}  // namespace

class PageClient::State : public std::enable_shared_from_this<State> {
  public:
    State(asio::any_io_executor executor, ServerAddress server, SceneInfo scene, PageClientSettings settings)
        : executor_{std::move(executor)},
          server_{std::move(server)},
          scene_{std::move(scene)},
          settings_{settings} {
        const std::size_t lines = std::max<std::size_t>(1, settings_.connections);
        for (std::size_t i = 0; i < lines; ++i)
            lines_.push_back(std::make_unique<Line>(executor_, server_, settings_));
    }

    RequestId get(PageKey page, const FetchOptions& options, Completion completion);
    void cancel(RequestId id);
    void cancel_all();
    void shut_down();
    PageClientStatistics statistics() const;

  private:
    struct Request {
        PageKey page;
        FetchOptions options;
        Completion completion;
        Clock::time_point asked = Clock::now();
        int attempts = 0;
        std::unique_ptr<asio::steady_timer> back_off;  ///< Set while it waits for its next try.
    };
    /// One connection, and the request that it carries.
    struct Line {
        Line(const asio::any_io_executor& executor, const ServerAddress& server,
             const PageClientSettings& settings)
            : connection{executor, server, settings.limits}, grace{executor} {}
        HttpConnection connection;
        asio::steady_timer grace;
        RequestId carries = 0;
        bool busy = false;
    };

    void start_lines();
    asio::awaitable<void> run(Line& line);
    /// One request's try: what to tell the caller, or nothing if it shall be tried again.
    std::optional<Result<PageReply>> judge(const std::string& target, Request& request,
                                           Result<HttpReply> reply, std::optional<milliseconds>& wait) const;
    void try_again_after(RequestId id, Request& request, milliseconds wait);
    void finish(RequestId id, Result<PageReply> result);
    milliseconds back_off(const Request& request) const;

    asio::any_io_executor executor_;
    ServerAddress server_;
    SceneInfo scene_;
    PageClientSettings settings_;
    std::vector<std::unique_ptr<Line>> lines_;
    std::map<RequestId, Request> requests_;  // all that have not ended
    std::deque<RequestId> queue_;            // those that wait for a line; may name ended ones
    std::size_t queued_ = 0;                 // without the ended ones
    RequestId last_id_ = 0;
    PageClientStatistics counts_;
    bool shut_down_ = false;
};

RequestId PageClient::State::get(PageKey page, const FetchOptions& options, Completion completion) {
    const RequestId id = ++last_id_;
    ++counts_.requested;
    Request& request = requests_.try_emplace(id).first->second;
    request.page = page;
    request.options = options;
    request.completion = std::move(completion);
    const auto refuse = [&](ErrorCode code, const char* why) {
        ++counts_.failed;
        asio::post(executor_,
                   [done = std::move(request.completion), id, error = Error{code, why}] { done(id, error); });
        requests_.erase(id);
        return id;
    };
    if (!scene_.extent.contains(page))
        return refuse(ErrorCode::no_such_page, "the page lies outside the extent");
    if (options.gutter < 0 || options.gutter > scene_.max_gutter)
        return refuse(ErrorCode::malformed_request, "the gutter is wider than the server gives");
    if (queued_ >= settings_.max_queued) return refuse(ErrorCode::overloaded, "the client's queue is full");
    queue_.push_back(id);
    ++queued_;
    start_lines();
    return id;
}

void PageClient::State::start_lines() {
    std::size_t wanted = queued_;
    for (const auto& line : lines_) {
        if (wanted == 0 || shut_down_) return;
        if (line->busy) continue;
        line->busy = true;
        --wanted;
        asio::co_spawn(
            executor_, [self = shared_from_this(), &line = *line] { return self->run(line); },
            [self = shared_from_this()](const std::exception_ptr& failure) {
                if (failure) std::rethrow_exception(failure);  // a bug: errors are values
            });
    }
}

/// Carries requests until none waits. Its caller holds this State alive.
asio::awaitable<void> PageClient::State::run(Line& line) {
    while (!queue_.empty() && !shut_down_) {
        const RequestId id = queue_.front();
        queue_.pop_front();
        const auto found = requests_.find(id);
        if (found == requests_.end()) continue;  // cancelled while it waited
        --queued_;

        Request& request = found->second;
        ++request.attempts;
        if (request.attempts > 1) ++counts_.retried;
        const std::string target = page_target(scene_.id, scene_.extent, request.page, request.options);
        HttpFields fields;
        if (request.options.format == PageFormat::rgba) fields.set("Accept-Encoding", "zstd");
        line.carries = id;
        Result<HttpReply> reply = co_await line.connection.get(target, fields);
        line.grace.cancel();
        line.carries = 0;

        const auto still = requests_.find(id);
        if (still == requests_.end()) continue;  // cancelled on the way
        std::optional<milliseconds> wait;
        auto result = judge(target, still->second, std::move(reply), wait);
        if (result)
            finish(id, std::move(*result));
        else
            try_again_after(id, still->second, *wait);
    }
    line.busy = false;
}

std::optional<Result<PageReply>> PageClient::State::judge(const std::string& target, Request& request,
                                                          Result<HttpReply> reply,
                                                          std::optional<milliseconds>& wait) const {
    const bool may_retry = request.attempts < settings_.attempts;
    if (!reply) {
        if (reply.error().code == ErrorCode::io_failure && may_retry) {
            wait = back_off(request);
            return std::nullopt;
        }
        return Result<PageReply>{reply.error()};
    }
    if (reply->status != 200) {
        Error error = error_of_status(reply->status, target);
        if (error.code == ErrorCode::overloaded && may_retry) {
            wait = std::min(std::max(back_off(request), retry_after(*reply).value_or(milliseconds{0})),
                            settings_.longest_back_off);
            return std::nullopt;
        }
        return Result<PageReply>{std::move(error)};
    }
    const bool is_raw = request.options.format == PageFormat::rgba;
    const std::size_t most =
        is_raw ? raw_page_bytes(request.options) : std::size_t{settings_.limits.body_bytes};
    Result<std::string> bytes = decode_body(std::move(reply->body), reply->field("Content-Encoding"), most);
    if (!bytes) return Result<PageReply>{Error{bytes.error().code, target + ": " + bytes.error().detail}};
    if (is_raw && bytes->size() != most)
        return Result<PageReply>{Error{ErrorCode::io_failure, target + ": " + std::to_string(bytes->size()) +
                                                                  " bytes where the page has " +
                                                                  std::to_string(most)}};
    PageReply page{request.page, request.options, std::move(*bytes), std::string{reply->field("ETag")}, {}};
    page.took = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - request.asked);
    return Result<PageReply>{std::move(page)};
}

milliseconds PageClient::State::back_off(const Request& request) const {
    const int doublings = std::min(request.attempts - 1, 16);
    const milliseconds wait =
        std::min(settings_.first_back_off * (1 << doublings), settings_.longest_back_off);
    // Up to a quarter more, different for each page, so that those refused together do not return together
    const auto spread = static_cast<std::int64_t>(std::hash<PageKey>{}(request.page) % 256);
    return wait + milliseconds{wait.count() * spread / 1024};
}

void PageClient::State::try_again_after(RequestId id, Request& request, milliseconds wait) {
    request.back_off = std::make_unique<asio::steady_timer>(executor_, wait);
    request.back_off->async_wait([self = shared_from_this(), id](boost::system::error_code error) {
        if (error || self->shut_down_) return;
        const auto found = self->requests_.find(id);
        if (found == self->requests_.end()) return;
        found->second.back_off.reset();
        self->queue_.push_front(id);  // it has waited longest
        ++self->queued_;
        self->start_lines();
    });
}

void PageClient::State::finish(RequestId id, Result<PageReply> result) {
    const auto found = requests_.find(id);
    Completion completion = std::move(found->second.completion);
    requests_.erase(found);
    if (result) {
        ++counts_.succeeded;
        counts_.bytes_delivered += result->bytes.size();
    } else {
        ++counts_.failed;
    }
    completion(id, std::move(result));
}

void PageClient::State::cancel(RequestId id) {
    const auto found = requests_.find(id);
    if (found == requests_.end()) return;
    ++counts_.cancelled;
    bool is_queued = found->second.back_off == nullptr;
    for (const auto& line : lines_) {
        if (line->carries != id) continue;
        is_queued = false;
        line->grace.expires_after(settings_.cancel_grace);
        line->grace.async_wait(
            [self = shared_from_this(), &line = *line, id](boost::system::error_code error) {
                if (!error && line.carries == id) line.connection.close();
            });
    }
    if (is_queued) --queued_;
    asio::post(executor_, [done = std::move(found->second.completion), id] {
        done(id, Error{ErrorCode::cancelled, "the caller cancelled the request"});
    });
    requests_.erase(found);
    // Ended ids are skipped when a line meets them; sweep them out before they outnumber the living
    if (queue_.size() > 2 * queued_ + 64)
        queue_.erase(
            std::remove_if(queue_.begin(), queue_.end(), [&](RequestId q) { return !requests_.contains(q); }),
            queue_.end());
}

void PageClient::State::cancel_all() {
    std::vector<RequestId> ids;
    for (const auto& [id, request] : requests_) ids.push_back(id);
    for (const RequestId id : ids) cancel(id);
}

void PageClient::State::shut_down() {
    shut_down_ = true;
    requests_.clear();
    queue_.clear();
    queued_ = 0;
    for (const auto& line : lines_) {
        line->grace.cancel();
        line->connection.close();
    }
}

PageClientStatistics PageClient::State::statistics() const {
    PageClientStatistics counts = counts_;
    for (const auto& line : lines_) {
        counts.connections_opened += line->connection.opened();
        counts.bytes_received += line->connection.bytes_received();
        if (line->carries != 0) ++counts.on_the_wire;
    }
    counts.waiting = requests_.size() - std::min(requests_.size(), counts.on_the_wire);
    return counts;
}

PageClient::PageClient(asio::any_io_executor executor, ServerAddress server, SceneInfo scene,
                       PageClientSettings settings)
    : state_{std::make_shared<State>(std::move(executor), std::move(server), std::move(scene), settings)} {}

PageClient::~PageClient() { state_->shut_down(); }

RequestId PageClient::get(PageKey page, const FetchOptions& options, Completion completion) {
    return state_->get(page, options, std::move(completion));
}
void PageClient::cancel(RequestId id) { state_->cancel(id); }
void PageClient::cancel_all() { state_->cancel_all(); }
PageClientStatistics PageClient::statistics() const { return state_->statistics(); }

}  // namespace tessera
