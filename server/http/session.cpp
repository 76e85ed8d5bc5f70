#include "server/http/session.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <utility>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/basic_waitable_timer.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/status.hpp>
#include <spdlog/spdlog.h>

#include "server/pages/page_fetch.h"
#include "server/sampling/sample_fetch.h"

namespace tessera {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;

constexpr asio::use_awaitable_t<IoExecutor> use_task{};
constexpr auto as_tuple = asio::as_tuple(use_task);
using Timer = asio::basic_waitable_timer<std::chrono::steady_clock,
                                         asio::wait_traits<std::chrono::steady_clock>, IoExecutor>;

constexpr std::size_t read_step_bytes = 2048;
constexpr std::size_t body_step_bytes = 65536;
/// An evaluation looks at its deadline about once a row; a session waits a little longer than that.
constexpr std::chrono::milliseconds deadline_slack{500};

/// After the last answer, of what nobody wanted: up to 64 MiB.
constexpr int most_lingering_reads = 4096;

/// For the disk, before an edit's fate is said to be unknown.
constexpr std::chrono::milliseconds edit_patience{30'000};

struct NoTicket {};

bool is_loopback(const PageSocket& socket) {
    boost::system::error_code failure;
    const auto peer = socket.remote_endpoint(failure);
    return !failure && peer.address().is_loopback();
}

/// Where the first LF without a CR is, from `at` on; npos if there is none.
std::size_t bare_line_end(std::string_view text, std::size_t at) noexcept {
    for (at = text.find('\n', at); at != std::string_view::npos; at = text.find('\n', at + 1))
        if (at == 0 || text[at - 1] != '\r') return at;
    return at;
}

Task<void> pass(std::chrono::milliseconds time) {
    Timer timer{co_await asio::this_coro::executor, time};
    co_await timer.async_wait(as_tuple);
}

}  // namespace

std::string_view DateField::now() {
    const std::time_t now = std::time(nullptr);
    if (now != second_) {
        second_ = now;
        std::tm utc{};
        gmtime_r(&now, &utc);
        char text[64];
        text_.assign(text, std::strftime(text, sizeof text, "Date: %a, %d %b %Y %H:%M:%S GMT\r\n", &utc));
    }
    return text_;
}

Session::Session(PageSocket socket, SessionContext& context)
    : socket_{std::move(socket)},
      context_{context},
      place_{context.sessions.insert(context.sessions.end(), this)},
      connection_{this, [&connections = context.metrics.connections](void*) { connections.Decrement(); }} {}

Session::~Session() { context_.sessions.erase(place_); }

Task<void> Session::run(std::shared_ptr<Session> self) {
    boost::system::error_code ignored;
    self->socket_.set_option(asio::ip::tcp::no_delay{true}, ignored);
    self->socket_.non_blocking(true, ignored);
    co_await self->serve();
    if (!self->is_stream_) co_await self->linger();
}

Task<void> Session::serve() {
    for (;;) {
        std::size_t head_bytes = 0;
        const ReadEnd end = co_await read_head(head_bytes);
        if (end == ReadEnd::closed) co_return;
        if (end == ReadEnd::too_slow || end == ReadEnd::too_long) {
            Refusal refusal{408, "the header did not arrive in time", true};
            if (end == ReadEnd::too_long) {
                const bool in_target = input_.find("\r\n") == std::string::npos;
                refusal = {in_target ? 414u : 431u,
                           in_target ? "the address is too long" : "the header is too long", true};
            }
            co_await send(refusal_answer(refusal), true, false);
            co_return;
        }
        const bool keep_alive = co_await answer_request(head_bytes);
        if (!keep_alive) co_return;
        input_.erase(0, head_bytes);
    }
}

/// Reads until `input_` begins with a whole header, or with one that is none whatever comes: of a length of
/// `head_bytes`.
Task<Session::ReadEnd> Session::read_head(std::size_t& head_bytes) {
    const SessionLimits& limits = context_.limits;
    std::size_t searched = 0;
    bool begun = false;
    for (;;) {
        // Empty lines before a request line are ignored (RFC 9112, 2.2)
        while (input_.starts_with("\r\n")) input_.erase(0, 2);
        const std::size_t end = input_.find("\r\n\r\n", searched);
        if (end != std::string::npos) {
            head_bytes = end + 4;
            co_return ReadEnd::complete;
        }
        // After a line that ends in LF alone nobody knows what will come: RequestHead refuses it as it is
        if (const std::size_t line = bare_line_end(input_, searched); line != std::string::npos) {
            head_bytes = line + 1;
            co_return ReadEnd::complete;
        }
        if (input_.size() >= limits.head_bytes) co_return ReadEnd::too_long;
        searched = input_.size() > 3 ? input_.size() - 3 : 0;
        if (context_.site.draining && input_.empty()) co_return ReadEnd::closed;

        idle_ = input_.empty();
        if (!begun) set_deadline(idle_ ? limits.idle_time : limits.head_time);
        begun = begun || !idle_;
        const std::size_t had = input_.size();
        const std::size_t room = std::min(read_step_bytes, limits.head_bytes - had);
        input_.resize(had + room);
        const auto [failure, count] =
            co_await socket_.async_read_some(asio::buffer(input_.data() + had, room), as_tuple);
        input_.resize(had + count);
        idle_ = false;
        if (std::exchange(expired_, false)) co_return had + count == 0 ? ReadEnd::closed : ReadEnd::too_slow;
        if (failure) co_return ReadEnd::closed;
    }
}

/// Takes the body out of `input_` and then off the socket. `closed` also where the client ends it early.
Task<Session::ReadEnd> Session::read_body(std::size_t head_bytes, const RequestHead& request,
                                          BodyBudget::Share& share, std::string& body) {
    const std::size_t length = request.body_bytes;
    const Clock::time_point last = Clock::now() + context_.limits.body_time;
    const std::size_t here = std::min(length, input_.size() - head_bytes);
    std::size_t room = std::min(length, std::max(here, body_step_bytes));
    if (!share.take(room)) co_return ReadEnd::overloaded;
    body = input_.substr(head_bytes, here);
    input_.erase(head_bytes, here);
    if (request.expects_continue && here == 0 && length != 0) {
        constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";
        set_deadline(context_.limits.write_time);
        const auto [failure, count] =
            co_await asio::async_write(socket_, asio::buffer(go_on.data(), go_on.size()), as_tuple);
        if (std::exchange(expired_, false) || failure) co_return ReadEnd::closed;
    }
    while (body.size() < length) {
        std::size_t at = body.size();
        if (at == room) {
            const std::size_t more = std::min(body_step_bytes, length - at);
            if (!share.take(more)) co_return ReadEnd::overloaded;
            room += more;
        }
        body.resize(room);
        while (at < room) {
            deadline_ = std::min(Clock::now() + context_.limits.write_time, last);
            const auto [failure, count] =
                co_await socket_.async_read_some(asio::buffer(body.data() + at, room - at), as_tuple);
            if (std::exchange(expired_, false)) co_return ReadEnd::too_slow;
            if (failure) co_return ReadEnd::closed;
            at += count;
        }
    }
    co_return ReadEnd::complete;
}

/// True if the connection may go on.
Task<bool> Session::answer_request(std::size_t head_bytes) {
    RequestHead request;
    if (const auto refusal = request.parse(std::string_view{input_}.substr(0, head_bytes), context_.limits)) {
        const bool keep_alive = !refusal->close && request.keep_alive;
        co_return co_await send(refusal_answer(*refusal), !request.is(http::verb::head), keep_alive);
    }
    request.from_loopback =
        is_loopback(socket_) && request["Forwarded"].empty() && request["X-Forwarded-For"].empty();
    Routes::Outcome outcome = context_.routes.route(request, context_.site);
    if (auto* pending = std::get_if<PendingPage>(&outcome))
        co_return co_await wait_for_page(std::move(*pending), request, request.keep_alive);
    if (auto* pending = std::get_if<PendingSample>(&outcome))
        co_return co_await wait_for_samples(std::move(*pending), request, head_bytes);
    if (auto* pending = std::get_if<PendingEdit>(&outcome))
        co_return co_await wait_for_edit(std::move(*pending), request, head_bytes);
    if (auto* pending = std::get_if<PendingStream>(&outcome))
        co_return co_await open_stream(*pending, request, head_bytes);
    Answer& answer = std::get<Answer>(outcome);
    answer.close = answer.close || request.body_bytes != 0;  // which nobody has read
    co_return co_await send(answer, !request.is(http::verb::head), request.keep_alive);
}

/// From here on the socket is the stream's: this session ends.
Task<bool> Session::open_stream(const PendingStream& pending, const RequestHead& request,
                                std::size_t head_bytes) {
    std::string why;
    if (input_.size() != head_bytes)
        why = "a client waits for the answer to its upgrade before it sends more";
    std::shared_ptr<void> place;
    if (why.empty() && !(place = context_.streams->admit())) why = "too many streams; come back in a second";
    if (!why.empty()) {
        const Answer answer = refusal_answer({place || input_.size() != head_bytes ? 400u : 503u, why, true});
        co_return co_await send(answer, true, false);
    }
    context_.metrics.count_answer(101, 0);
    StreamOpening opening;
    opening.scene = pending.scene;
    opening.from_loopback = pending.edits_without_token;
    opening.token = pending.token;
    opening.place = std::move(place);
    opening.connection = connection_;
    is_stream_ = true;
    context_.streams->serve(std::move(socket_), request.message, std::move(opening));
    co_return false;
}

Answer Session::body_refusal(ReadEnd end) {
    return refusal_answer(end == ReadEnd::too_slow
                              ? Refusal{408, "the body did not arrive in time", true}
                              : Refusal{503, "too many large requests at once; ask again in a second", true});
}

/// An edit that was read is made whether the client waits for its answer or not; one that has closed its
/// sending half is answered all the same, for there is nothing left to spare.
Task<bool> Session::wait_for_edit(PendingEdit pending, const RequestHead& request, std::size_t head_bytes) {
    using namespace asio::experimental::awaitable_operators;
    BodyBudget::Share share{context_.bodies};
    std::string body;
    const ReadEnd end = co_await read_body(head_bytes, request, share, body);
    if (end == ReadEnd::closed) co_return false;
    if (end != ReadEnd::complete) {
        const Answer answer = body_refusal(end);
        co_return co_await send(answer, true, false);
    }
    auto edit = Routes::read_edit(body, pending);
    if (!edit) {
        const Answer answer = refusal_answer({400, edit.error().detail, false});
        co_return co_await send(answer, true, request.keep_alive);
    }
    deadline_ = Clock::time_point::max();
    auto outcome = co_await (async_ticketed<EditOutcome, NoTicket>(
                                 socket_.get_executor(),
                                 [this, &pending, &edit](std::function<void(Result<EditOutcome>)> handler) {
                                     context_.edits.edit(pending.scene, std::move(*edit),
                                                         [handler = std::move(handler)](EditOutcome how) {
                                                             handler(std::move(how));
                                                         });
                                     return NoTicket{};
                                 },
                                 use_task) ||
                             pass(edit_patience));
    const EditOutcome how =
        outcome.index() == 0
            ? std::move(std::get<0>(outcome).value())
            : EditRefusal{EditRefusal::Why::unknown,
                          "it takes too long; send the edit again to learn whether it is in", 0};
    const Answer answer = Routes::edit_answer(how, pending.answer_coding);
    co_return co_await send(answer, true, request.keep_alive);
}

/// Reads the body, and then waits as wait_for_page() does.
Task<bool> Session::wait_for_samples(PendingSample pending, const RequestHead& request,
                                     std::size_t head_bytes) {
    using namespace asio::experimental::awaitable_operators;
    BodyBudget::Share share{context_.bodies};
    const ReadEnd end = co_await read_body(head_bytes, request, share, pending.call.body);
    if (end == ReadEnd::closed) co_return false;
    if (end != ReadEnd::complete) {
        const Answer answer = body_refusal(end);
        co_return co_await send(answer, true, false);
    }

    deadline_ = Clock::time_point::max();
    auto outcome =
        co_await (async_sample(context_.samples, std::move(pending.call), socket_.get_executor(), use_task) ||
                  client_leaves() || pass(context_.samples.limits().deadline + deadline_slack));
    if (outcome.index() == 1) co_return false;
    if (outcome.index() == 2) {
        const Error late{ErrorCode::timed_out,
                         "the samples took too long; send fewer footprints, or ask for accuracy=fast"};
        co_return co_await send(error_answer(late), true, request.keep_alive);
    }
    Result<SampleReply>& reply = std::get<0>(outcome);
    if (!reply) {
        if (reply.error().code == ErrorCode::io_failure)
            spdlog::error("{}: {}", std::string{request.path}, reply.error().detail);
        co_return co_await send(error_answer(reply.error()), true, request.keep_alive);
    }
    const Answer answer = Routes::sample_answer(*reply);
    co_return co_await send(answer, true, request.keep_alive);
}

/// Waits for a page, its deadline, or the client's leaving, whichever is first. Leaving this function gives
/// up the place in the line.
Task<bool> Session::wait_for_page(PendingPage pending, const RequestHead& request, bool keep_alive) {
    using namespace asio::experimental::awaitable_operators;
    deadline_ = Clock::time_point::max();
    const auto outcome =
        co_await (async_fetch(context_.pages, std::move(pending.request), socket_.get_executor(), use_task) ||
                  client_leaves() || pass(context_.pages.limits().deadline + deadline_slack));
    if (outcome.index() == 1) co_return false;
    if (outcome.index() == 2) {
        const Error late{ErrorCode::timed_out, "the page took too long; ask again, or with accuracy=fast"};
        co_return co_await send(error_answer(late), true, keep_alive);
    }
    const Result<PagePtr>& page = std::get<0>(outcome);
    if (!page) {
        if (page.error().code == ErrorCode::io_failure)
            spdlog::error("{}: {}", std::string{request.path}, page.error().detail);
        co_return co_await send(error_answer(page.error()), true, keep_alive);
    }
    co_return co_await send(Routes::page_answer(*page, pending), true, keep_alive);
}

/// Returns when the connection ends. A client that closes only its sending half counts as gone: until
/// something is written to it, it looks like one that has closed both, and work for nobody has to stop at
/// once. What the client sends meanwhile is kept as its next requests; when that is as much as may wait, it
/// is not watched any more.
Task<void> Session::client_leaves() {
    co_await asio::this_coro::throw_if_cancelled(false);
    for (;;) {
        const auto cancelled = (co_await asio::this_coro::cancellation_state).cancelled();
        if (cancelled != asio::cancellation_type::none) co_return;
        const std::size_t had = input_.size();
        const std::size_t room = std::min(read_step_bytes, 2 * context_.limits.head_bytes - had);
        if (room == 0) {
            Timer forever{co_await asio::this_coro::executor, Clock::time_point::max()};
            co_await forever.async_wait(as_tuple);
            continue;
        }
        std::array<char, read_step_bytes> block;
        const auto [failure, count] =
            co_await socket_.async_read_some(asio::buffer(block.data(), room), as_tuple);
        input_.append(block.data(), count);
        if (failure) co_return;
    }
}

/// True if the connection may go on: everything is sent and both sides want more.
Task<bool> Session::send(const Answer& answer, bool with_body, bool keep_alive) {
    keep_alive = keep_alive && !answer.close && !context_.site.draining;
    const std::size_t body_bytes = with_body ? answer.body.size() : 0;
    context_.metrics.count_answer(answer.status, body_bytes);

    const auto reason = http::obsolete_reason(static_cast<http::status>(answer.status));
    output_.clear();
    output_ += "HTTP/1.1 ";
    output_ += std::to_string(answer.status);
    output_ += ' ';
    output_.append(reason.data(), reason.size());
    output_ += "\r\n";
    output_ += context_.date.now();
    output_ += keep_alive ? "Connection: keep-alive\r\n" : "Connection: close\r\n";
    output_ += answer.fields;

    std::array<asio::const_buffer, 3> parts{asio::buffer(output_), asio::buffer(answer.prelude),
                                            asio::const_buffer{answer.body.data(), body_bytes}};
    std::size_t left = output_.size() + answer.prelude.size() + body_bytes;
    const Clock::time_point last = Clock::now() + context_.limits.answer_time;
    for (;;) {
        // Most answers fit into the socket's buffer and leave at once
        boost::system::error_code failure;
        std::size_t count = socket_.write_some(parts, failure);
        if (failure == asio::error::would_block) {
            deadline_ = std::min(Clock::now() + context_.limits.write_time, last);
            std::tie(failure) = co_await socket_.async_wait(asio::socket_base::wait_write, as_tuple);
            if (std::exchange(expired_, false) || failure) co_return false;
            continue;
        }
        if (failure) co_return false;
        left -= count;
        if (left == 0) co_return keep_alive;
        for (asio::const_buffer& part : parts) {
            const std::size_t taken = std::min(count, part.size());
            part += taken;
            count -= taken;
        }
    }
}

/// Closes so that the last answer is not lost: a socket closed with unread input resets the connection.
Task<void> Session::linger() {
    boost::system::error_code failure;
    socket_.shutdown(asio::socket_base::shutdown_send, failure);
    set_deadline(context_.limits.linger_time);
    // Whoever sends much at once reads nothing until it is away
    std::array<char, 16384> block;
    for (int i = 0; i < most_lingering_reads && !failure && !expired_; ++i)
        std::tie(failure, std::ignore) = co_await socket_.async_read_some(asio::buffer(block), as_tuple);
    socket_.close(failure);
}

void Session::check_deadline(Clock::time_point now) {
    if (now < deadline_) return;
    deadline_ = Clock::time_point::max();
    expired_ = true;
    boost::system::error_code ignored;
    socket_.cancel(ignored);
}

void Session::drain() {
    if (idle_) abort();
}

void Session::abort() {
    boost::system::error_code ignored;
    socket_.close(ignored);
}

}  // namespace tessera
