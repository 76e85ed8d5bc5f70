// The loops of a stream: connecting again and again, sending, looking at the time.
#include <algorithm>
#include <utility>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "client/link/stream_client_state.h"

namespace tessera {

namespace asio = boost::asio;
using std::chrono::milliseconds;

namespace {

constexpr auto as_result = asio::as_tuple(asio::use_awaitable);
constexpr milliseconds tick{100};
constexpr milliseconds between_presences{34};  // the server tells at most 30 a second
constexpr std::size_t most_asks_a_message = 512;

}  // namespace

void StreamClient::State::start() {
    const auto self = shared_from_this();
    asio::co_spawn(
        executor_, [self] { return self->run(); }, asio::detached);
    asio::co_spawn(
        executor_, [self] { return self->keep_time(); }, asio::detached);
}

asio::awaitable<void> StreamClient::State::run() {
    const auto self = shared_from_this();
    while (!is_over_) {
        const LinePtr line = std::make_shared<Line>(executor_, server_, settings_.limits);
        line_ = line;
        const Time began = Clock::now();
        const Error why = co_await live(line);
        const bool was_open = line->open;
        line->open = false;
        line->socket->close();
        line->wake.cancel();
        if (is_over_) co_return;
        bytes_of_past_lines_ += line->socket->bytes_received();
        line_.reset();
        const milliseconds wait = next_back_off(*line, was_open, began);
        lose(why, wait);
        if (is_over_) co_return;  // the listener may have ended it
        retry_timer_.expires_after(wait);
        co_await retry_timer_.async_wait(as_result);
    }
}

milliseconds StreamClient::State::next_back_off(const Line& line, bool was_open, Time opened) {
    if (was_open && Clock::now() - opened >= settings_.steady_after) failures_ = 0;
    const int doublings = std::min(failures_++, 16);
    const milliseconds wait =
        std::min(settings_.first_back_off * (1 << doublings), settings_.longest_back_off);
    // Up to a quarter more, so that those lost together do not come back together
    const milliseconds spread{wait.count() * static_cast<std::int64_t>(dice_() % 256) / 1024};
    return std::max(wait + spread, line.socket->retry_after());
}

asio::awaitable<Error> StreamClient::State::live(LinePtr line) {
    const auto opened = co_await line->socket->open(target_, "tessera.stream.1");
    if (!opened) co_return opened.error();
    const auto greeted = co_await say_hello(line);
    if (!greeted) co_return greeted.error();
    asio::co_spawn(
        executor_, [self = shared_from_this(), line] { return self->send(line); }, asio::detached);
    while (!is_over_) {
        const auto bytes = co_await line->socket->read();
        if (!bytes) co_return bytes.error();
        if (is_over_) break;
        if (auto wrong = hear(*line, *bytes)) co_return std::move(*wrong);
    }
    co_return Error{ErrorCode::cancelled, "the stream is not wanted any more"};
}

asio::awaitable<Result<void>> StreamClient::State::say_hello(LinePtr line) {
    proto::ClientMessage message;
    proto::ClientHello& hello = *message.mutable_hello();
    hello.set_name(settings_.name);
    hello.set_token(settings_.token);
    hello.set_wants_presence(settings_.wants_presence);
    hello.set_wants_edits(settings_.wants_edits);
    if (histories_ > 0) {
        hello.set_lineage(lineage_);
        hello.set_fingerprint(fingerprint_);
        hello.set_seen_revision(told_revision_);
    }
    const std::string bytes = message.SerializeAsString();
    const auto sent = co_await line->socket->write(bytes);
    if (!sent) co_return sent.error();

    // The first answer is the server's hello, or a goodbye
    asio::steady_timer patience{executor_, settings_.hello_timeout};
    patience.async_wait([line, this, self = shared_from_this()](boost::system::error_code error) {
        if (!error && !line->open)
            line->socket->fail(
                {ErrorCode::timed_out, server_.url() + target_ + ": the server said no hello"});
    });
    const auto answer = co_await line->socket->read();
    if (!answer) co_return answer.error();
    if (is_over_) co_return Error{ErrorCode::cancelled, "the stream is not wanted any more"};
    if (auto wrong = hear(*line, *answer)) co_return std::move(*wrong);
    if (!line->open)
        co_return Error{ErrorCode::io_failure,
                        server_.url() + target_ + ": the server began without a hello"};
    co_return Result<void>{};
}

void StreamClient::State::lose(const Error& why, milliseconds retry_in) {
    // Answers cannot come any more
    for (const StreamAsk& ask : asks_.take_all())
        if (listener_) listener_->on_page(failed_page(ask, {ErrorCode::io_failure, why.detail}));
    if (listener_) listener_->on_lost(why, retry_in);
}

asio::awaitable<void> StreamClient::State::send(LinePtr line) {
    const auto self = shared_from_this();
    while (!line->socket->is_over() && !is_over_) {
        Time until = Time::max();
        const auto message = next_message(*line, Clock::now(), until);
        if (!message) {
            line->wake.expires_at(until);
            co_await line->wake.async_wait(as_result);
            continue;
        }
        const std::string bytes = message->SerializeAsString();
        const auto sent = co_await line->socket->write(bytes);
        if (!sent) co_return;  // the reading side ends with the cause
    }
}

std::optional<proto::ClientMessage> StreamClient::State::next_message(Line& line, Time now, Time& until) {
    proto::ClientMessage message;
    if (!line.cancels.empty()) {
        for (const std::uint32_t id : line.cancels) message.mutable_cancel()->add_ids(id);
        line.cancels.clear();
        return message;
    }
    if (write_windows(line, message) || write_credits(line, message) || write_asks(line, message))
        return message;
    if (const proto::Edit* edit = edits_.take_due(now, newest_revision_)) {
        *message.mutable_edit() = *edit;
        return message;
    }
    if (line.tell_presence && line.next_presence <= now) {
        line.tell_presence = false;
        line.next_presence = now + between_presences;
        *message.mutable_presence() = presence_;
        return message;
    }
    if (!line.pinged && line.next_ping <= now) {
        line.pinged = now;
        message.mutable_ping()->set_payload(++line.ping);
        return message;
    }
    if (line.tell_presence) until = std::min(until, line.next_presence);
    if (!line.pinged) until = std::min(until, line.next_ping);
    if (const auto due = edits_.next_due()) until = std::min(until, *due);
    return std::nullopt;
}

bool StreamClient::State::write_windows(Line& line, proto::ClientMessage& message) {
    if (!line.tell_windows) return false;
    line.tell_windows = false;
    proto::Windows& told = *message.mutable_windows();
    std::uint64_t pages = 0;
    for (const proto::Window& window : windows_) {
        const std::int64_t width = window.x1() - window.x0(), height = window.y1() - window.y0();
        if (width <= 0 || height <= 0) continue;
        // Windows lie in an extent of at most 2^30 pages a side
        pages += static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
        if (pages > line.limits.window_pages() ||
            static_cast<std::uint32_t>(told.windows_size()) >= line.limits.windows())
            break;
        *told.add_windows() = window;
    }
    told.set_seen_revision(windows_seen_);
    return true;
}

bool StreamClient::State::write_credits(Line& line, proto::ClientMessage& message) {
    // A few at a time: each grant is a message
    const std::uint32_t wanted = std::min(allowed_, line.limits.credits());
    if (line.credits >= wanted || (line.credits > wanted / 2 && wanted - line.credits < 4)) return false;
    message.mutable_credits()->set_pages(wanted - line.credits);
    line.credits = wanted;
    return true;
}

bool StreamClient::State::write_asks(Line& line, proto::ClientMessage& message) {
    if (!asks_.has_unsent()) return false;
    proto::PageAsks& asks = *message.mutable_ask();
    const FetchOptions& options = settings_.options;
    asks.mutable_options()->set_format("rgba");
    asks.mutable_options()->set_gutter(static_cast<std::uint32_t>(options.gutter));
    if (options.accuracy != Accuracy::high)
        asks.mutable_options()->set_accuracy(std::string{name_of(options.accuracy)});
    if (options.channels != ChannelSet::albedo)
        asks.mutable_options()->set_channels(std::string{name_of(options.channels)});
    constexpr std::uint32_t longest_ask = 320;
    const std::size_t fitting = std::max(1u, line.limits.message_bytes() / longest_ask);
    for (const StreamAsk& ask : asks_.take_unsent(std::min(most_asks_a_message, fitting))) {
        proto::PageAsk& wanted = *asks.add_asks();
        wanted.set_id(ask.id);
        wanted.mutable_page()->set_level(ask.page.level);
        wanted.mutable_page()->set_x(ask.page.x);
        wanted.mutable_page()->set_y(ask.page.y);
        wanted.set_step(ask.step);
        wanted.set_least_revision(ask.least_revision);
        wanted.set_urgency(std::min(ask.urgency, 7u));
        wanted.set_have(ask.have);
    }
    return true;
}

asio::awaitable<void> StreamClient::State::keep_time() {
    const auto self = shared_from_this();
    while (!is_over_) {
        time_timer_.expires_after(tick);
        co_await time_timer_.async_wait(as_result);
        if (is_over_) co_return;
        const Time now = Clock::now();
        if (settings_.edit_patience) end(edits_.give_up(now - *settings_.edit_patience));
        if (!is_open()) continue;
        // While the server has no credits, it must not answer
        const LinePtr line = line_;
        if (allowed_ == 0) continue;
        for (const StreamAsk& ask : asks_.give_up(now - settings_.answer_timeout, now)) {
            if (is_over_) co_return;
            line->cancels.push_back(ask.id);
            listener_->on_page(failed_page(ask, {ErrorCode::timed_out, "the server did not answer in time"}));
        }
        wake();
        // A server that is merely slow answers at once that it has dropped them
        if (2 * asks_.given_up_before(now - settings_.cancel_timeout) >= settings_.max_asks)
            line->socket->fail({ErrorCode::timed_out,
                                server_.url() + ": the server leaves most asks for pages without an answer"});
    }
}

void StreamClient::State::end(std::vector<PendingEdits::Ended> ended) {
    for (PendingEdits::Ended& edit : ended)
        if (!is_over_ && edit.done) edit.done(std::move(edit.fate));
}

}  // namespace tessera
