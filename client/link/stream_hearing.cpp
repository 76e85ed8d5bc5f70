// What the server says on a stream, and whether it may.
#include <algorithm>
#include <utility>

#include "client/link/stream_client_state.h"

namespace tessera {
namespace {

constexpr std::uint32_t most_mistakes = 64;
constexpr std::size_t longest_words = 1000;

const char* words_of(proto::Goodbye::Why why) {
    switch (why) {
        case proto::Goodbye::stopping:
            return "the server stops";
        case proto::Goodbye::too_slow:
            return "this client reads too slowly";
        case proto::Goodbye::wrong_message:
            return "the server could not take a message of this client's";
        case proto::Goodbye::scene_gone:
            return "the scene is gone";
        case proto::Goodbye::idle:
            return "the server closes idle streams";
        case proto::Goodbye::too_many:
            return "the server has as many streams as it takes";
        default:
            return "the server says goodbye";
    }
}

Error error_of(const proto::Goodbye& goodbye, const std::string& where) {
    const auto code = goodbye.why() == proto::Goodbye::scene_gone      ? ErrorCode::no_such_scene
                      : goodbye.why() == proto::Goodbye::too_many      ? ErrorCode::overloaded
                      : goodbye.why() == proto::Goodbye::wrong_message ? ErrorCode::malformed_request
                                                                       : ErrorCode::io_failure;
    std::string text = where + ": " + words_of(goodbye.why());
    if (!goodbye.detail().empty()) text += ": " + goodbye.detail().substr(0, longest_words);
    return {code, std::move(text)};
}

}  // namespace

std::optional<Error> StreamClient::State::hear(Line& line, const std::string& bytes) {
    proto::ServerMessage message;
    if (!message.ParseFromString(bytes))
        return Error{ErrorCode::io_failure,
                     server_.url() + target_ + ": the server sent what is no message of proto/stream.proto"};
    using Kind = proto::ServerMessage;
    if (message.message_case() == Kind::kGoodbye) return error_of(message.goodbye(), server_.url() + target_);
    if (message.message_case() == Kind::kHello) {
        if (line.open) return mistake(line, "a second hello");
        return open(line, message.hello());
    }
    if (!line.open)
        return Error{ErrorCode::io_failure, server_.url() + target_ + ": the server began without a hello"};
    switch (message.message_case()) {
        case Kind::kPage:
            return hear_page(line, std::move(*message.mutable_page()), bytes.size());
        case Kind::kRefused:
            return hear_refusal(line, message.refused());
        case Kind::kInvalidation:
            newest_revision_ = std::max(newest_revision_, message.invalidation().revision());
            told_revision_ = std::max(told_revision_, message.invalidation().revision());
            listener_->on_invalidation(message.invalidation());
            return std::nullopt;
        case Kind::kEditDone:
            hear_edit(message.edit_done());
            return std::nullopt;
        case Kind::kEditRefused:
            if (auto ended = edits_.refused(message.edit_refused(), Clock::now()); ended && ended->done)
                ended->done(std::move(ended->fate));
            wake();
            return std::nullopt;
        case Kind::kPresent:
            listener_->on_present(message.present());
            return std::nullopt;
        case Kind::kClock:
            listener_->on_clock(message.clock());
            return std::nullopt;
        case Kind::kReplaced:
            return open(line, message.replaced().hello());
        case Kind::kPong:
            hear_pong(line, message.pong());
            return std::nullopt;
        default:
            return std::nullopt;  // of a newer server
    }
}

std::optional<Error> StreamClient::State::open(Line& line, const proto::ServerHello& hello) {
    if (hello.extent_log2_pages() > max_level)
        return Error{ErrorCode::io_failure, server_.url() + target_ + ": extent_log2_pages is " +
                                                std::to_string(hello.extent_log2_pages()) + ", more than " +
                                                std::to_string(max_level)};
    const bool is_first = !line.open;
    const bool resumed = is_first && histories_ > 0 && hello.resumed();
    if (!resumed) {
        ++histories_;
        // An empty lineage names no history: edits may be kept no longer than the process
        history_ = hello.lineage().empty() ? "#" + std::to_string(histories_) : hello.lineage();
        told_revision_ = newest_revision_ = hello.revision();
        windows_seen_ = hello.revision();
    }
    lineage_ = hello.lineage();
    fingerprint_ = hello.fingerprint();
    newest_revision_ = std::max(newest_revision_, hello.revision());
    line.open = true;
    if (hello.has_limits() || is_first) line.limits = hello.limits();
    line.tell_windows = !windows_.empty();
    windows_seen_ = std::min(windows_seen_, told_revision_);
    if (is_first) {
        line.tell_presence = is_present_;
        ++counts_.connections;
        counts_.resumed += resumed;
        end(edits_.opened(history_));
    }
    if (!listener_) return std::nullopt;
    proto::ServerHello told = hello;
    told.set_resumed(resumed);
    listener_->on_open(told);
    if (hello.has_clock() && listener_) listener_->on_clock(hello.clock());
    wake();
    return std::nullopt;
}

std::optional<Error> StreamClient::State::hear_page(Line& line, proto::PageData&& data,
                                                    std::size_t wire_bytes) {
    const std::uint32_t id = data.id();
    std::optional<Error> over;
    if (line.credits == 0)
        over = mistake(line, "a page without a credit");
    else
        --line.credits;
    newest_revision_ = std::max(newest_revision_, data.scene_revision());
    auto answered = asks_.answered(id);
    if (!answered) return over ? over : mistake(line, "a page that nobody waits for");
    std::erase(line.cancels, id);
    if (answered->wanted) {
        StreamPage page = page_of(answered->ask, std::move(data), settings_.options, wire_bytes);
        ++counts_.pages;
        if (!page.texels && !over) over = mistake(line, page.texels.error().detail);
        listener_->on_page(std::move(page));
    }
    wake();
    return over;
}

std::optional<Error> StreamClient::State::hear_refusal(Line& line, const proto::PageRefusal& refusal) {
    const auto answered = asks_.answered(refusal.id());
    if (!answered) return mistake(line, "a refusal of what nobody asked for");
    std::erase(line.cancels, refusal.id());
    if (refusal.why() != proto::PageRefusal::cancelled) ++counts_.pages_refused;
    if (answered->wanted) listener_->on_page(page_of(answered->ask, refusal));
    wake();
    return std::nullopt;
}

void StreamClient::State::hear_edit(const proto::EditDone& done) {
    newest_revision_ = std::max(newest_revision_, done.answer().revision());
    if (!edits_.waits_for(done.id())) return listener_->on_edit(done);
    if (auto ended = edits_.accepted(done.id(), done.answer()); ended && ended->done)
        ended->done(std::move(ended->fate));
}

void StreamClient::State::hear_pong(Line& line, const proto::Pong& pong) {
    if (!line.pinged || pong.payload() != line.ping) return;
    const Time now = Clock::now();
    const auto took = std::chrono::duration_cast<std::chrono::microseconds>(now - *line.pinged);
    counts_.round_trip = counts_.round_trip.count() == 0 ? took : (counts_.round_trip * 7 + took) / 8;
    line.pinged.reset();
    line.next_ping = now + settings_.ping_every;
    wake();
}

std::optional<Error> StreamClient::State::mistake(Line& line, const std::string& what) {
    ++counts_.mistakes;
    if (++line.mistakes < most_mistakes) return std::nullopt;
    return Error{ErrorCode::io_failure, server_.url() + target_ + ": the server made " +
                                            std::to_string(most_mistakes) + " mistakes; the last: it sent " +
                                            what};
}

}  // namespace tessera
