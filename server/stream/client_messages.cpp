// What a client says, taken by its StreamSession.
#include <cmath>
#include <utility>

#include <boost/asio/post.hpp>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include "proto/stream.pb.h"

#include "server/stream/stream_session.h"

namespace tessera {
namespace {

using proto::Goodbye;

constexpr std::size_t most_name_bytes = 64;
constexpr std::size_t most_token_bytes = 256;
constexpr int most_nesting = 16;

bool parse(std::string_view bytes, proto::ClientMessage& message) {
    google::protobuf::io::CodedInputStream input{reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                                 static_cast<int>(bytes.size())};
    input.SetRecursionLimit(most_nesting);
    return message.ParseFromCodedStream(&input) && input.ConsumedEntireMessage();
}

proto::EditRefused::Why why_of(EditRefusal::Why why) {
    using Refused = proto::EditRefused;
    switch (why) {
        case EditRefusal::Why::wrong:
            return Refused::wrong;
        case EditRefusal::Why::conflict:
            return Refused::conflict;
        case EditRefusal::Why::other_content:
            return Refused::other_content;
        case EditRefusal::Why::too_old:
            return Refused::too_old;
        case EditRefusal::Why::overloaded:
            return Refused::overloaded;
        case EditRefusal::Why::unavailable:
            return Refused::unavailable;
        case EditRefusal::Why::unknown:
            break;
    }
    return Refused::unknown;
}

}  // namespace

void StreamSession::received(std::string_view bytes) {
    if (!leaving_) {
        proto::ClientMessage message;
        if (parse(bytes, message))
            take(message);
        else
            goodbye(Goodbye::wrong_message, "no ClientMessage of proto/stream.proto", 1008);
    }
    // Who does not read what it asked for is not listened to
    if (answer_bytes_ > options_.answer_bytes && !leaving_)
        read_paused_ = true;
    else
        socket_.read_on();
}

void StreamSession::take(proto::ClientMessage& message) {
    using Message = proto::ClientMessage;
    const auto kind = message.message_case();
    if ((kind == Message::kHello) == (hub_ != nullptr))
        return goodbye(Goodbye::wrong_message,
                       hub_ ? "ClientHello is said once" : "the first message is ClientHello", 1008);
    switch (kind) {
        case Message::kHello:
            return take_hello(message.hello());
        case Message::kWindows:
            return take_windows(message.windows());
        case Message::kAsk:
            return take_asks(message.ask());
        case Message::kCancel:
            for (const std::uint32_t id : message.cancel().ids())
                if (pages_.cancel(id)) refuse_page(id, proto::PageRefusal::cancelled, {});
            return wake();
        case Message::kCredits:
            pages_.grant(message.credits().pages());
            return wake();
        case Message::kEdit:
            return take_edit(std::move(*message.mutable_edit()));
        case Message::kPresence:
            return take_presence(message.presence());
        case Message::kPing: {
            proto::ServerMessage pong;
            pong.mutable_pong()->set_payload(message.ping().payload());
            return answer(pong);
        }
        case Message::MESSAGE_NOT_SET:
            break;  // of a newer protocol, perhaps: the hello said what this server knows
    }
}

void StreamSession::take_hello(const proto::ClientHello& hello) {
    if (hello.name().size() > most_name_bytes || hello.token().size() > most_token_bytes)
        return goodbye(Goodbye::wrong_message, "hello: a name has at most 64 bytes, a token 256", 1008);
    if (!scene_now()) return goodbye(Goodbye::scene_gone, "the scene is not served any more", 1000);
    name_ = hello.name();
    if (!hello.token().empty()) token_ = hello.token();
    wants_presence_ = hello.wants_presence();
    wants_edits_ = hello.wants_edits();
    session_ = service_.new_session();
    hub_ = service_.hub(scene_id_);
    audience_ = thread_.audience(hub_);
    audience_->sessions.push_back(this);
    if (wants_edits_) ++hub_->news_readers;
    // What is in this scene is not told; what comes after it is
    const ScenePtr scene = scene_now();
    told_ = news_told_ = scene->revision;

    proto::ServerMessage message;
    proto::ServerHello& answered = *message.mutable_hello();
    write_hello(*scene, answered);
    const bool resumed = !hello.fingerprint().empty() && hello.fingerprint() == answered.fingerprint() &&
                         hello.lineage() == answered.lineage() && hello.seen_revision() <= scene->revision;
    if (resumed) resumes_ = hello.seen_revision();
    answered.set_resumed(resumed);
    answer(message);
    if (!name_.empty()) take_presence({});
}

void StreamSession::take_windows(const proto::Windows& message) {
    const ScenePtr scene = scene_now();
    if (!scene) return;
    std::vector<PageWindows::Asked> asked;
    for (const proto::Window& window : message.windows())
        asked.push_back({window.level(), window.x0(), window.y0(), window.x1(), window.y1()});
    // After a break the client's pages are of what it had heard of then
    auto seen = std::exchange(resumes_, std::nullopt);
    if (message.has_seen_revision()) seen = message.seen_revision();
    if (const auto replaced = windows_.replace(asked, scene->extent, seen, scene->revision); !replaced)
        return goodbye(Goodbye::wrong_message, replaced.error().detail, 1008);
    wake();
}

void StreamSession::take_asks(const proto::PageAsks& message) {
    using Refusal = proto::PageRefusal;
    if (message.asks_size() > static_cast<int>(options_.asks))
        return goodbye(Goodbye::wrong_message, "asks: at most " + std::to_string(options_.asks), 1008);
    const auto options = page_options_of(message.options());
    const auto shared = options ? std::make_shared<const PageOptions>(*options) : nullptr;
    for (const proto::PageAsk& asked : message.asks()) {
        const auto refuse = [&](Refusal::Why why, std::string detail, std::uint32_t retry_ms = 0) {
            refuse_page(asked.id(), why, std::move(detail), retry_ms);
        };
        if (!options) {
            refuse(Refusal::wrong, options.error().detail);
            continue;
        }
        const auto in_range = [](std::int64_t at) { return at >= 0 && at < std::int64_t{1} << max_level; };
        const proto::StreamPageKey& key = asked.page();
        if (key.level() > max_level || !in_range(key.x()) || !in_range(key.y())) {
            refuse(Refusal::wrong, "page: is outside the extent");
            continue;
        }
        if (asked.step() > max_step || asked.step() < -max_step) {
            refuse(Refusal::wrong, "step: an integer from -2^62 to 2^62");
            continue;
        }
        const auto urgency =
            static_cast<std::uint8_t>(std::min<std::uint32_t>(asked.urgency(), Urgency::least));
        switch (pages_.add({.id = asked.id(),
                            .key = {static_cast<std::uint8_t>(key.level()),
                                    static_cast<std::uint32_t>(key.x()), static_cast<std::uint32_t>(key.y())},
                            .step = asked.step(),
                            .least_revision = asked.least_revision(),
                            .urgency = {urgency},
                            .have = read_tag(asked.have()),
                            .brief = message.options().brief(),
                            .options = shared})) {
            case PageFlow::Added::yes:
                break;
            case PageFlow::Added::too_many:
                refuse(Refusal::overloaded, "at most " + std::to_string(options_.asks) + " asks wait", 1000);
                break;
            case PageFlow::Added::twice:
                refuse(Refusal::wrong, "id: an ask of this number waits already");
                break;
        }
    }
    wake();
}

void StreamSession::take_edit(proto::Edit edit) {
    service_.metrics.edits.Increment();
    const std::string id = edit.id();
    const Access::Decision allowed = may_edit();
    if (!allowed.allowed) return refuse_edit(id, {EditRefusal::Why::wrong, allowed.why, told_}, true);
    if (edits_under_way_ >= options_.edits)
        return refuse_edit(id, {EditRefusal::Why::overloaded, "too many edits of this client wait", told_});
    auto author = author_of(edit.author(), allowed);
    if (!author) return refuse_edit(id, {EditRefusal::Why::wrong, author.error().detail, told_});
    edit.set_author(std::move(*author));

    ++edits_under_way_;
    const auto key = edit_id_from(id);
    if (key) hub_->edit_begins(*key, session_);
    service_.edits.edit(
        scene_id_, std::move(edit),
        [weak = weak_from_this(), executor = thread_.executor(), hub = hub_, key, id](EditOutcome outcome) {
            if (key) hub->edit_ends(*key);
            boost::asio::post(executor, [weak, id, outcome = std::move(outcome)]() mutable {
                if (const auto self = weak.lock()) self->edit_answered(id, std::move(outcome));
            });
        });
}

void StreamSession::edit_answered(const std::string& id, EditOutcome outcome) {
    --edits_under_way_;
    if (leaving_ || !hub_) return;
    if (const auto* refusal = std::get_if<EditRefusal>(&outcome)) return refuse_edit(id, *refusal);
    proto::ServerMessage message;
    proto::EditDone& done = *message.mutable_edit_done();
    done.set_id(id);
    *done.mutable_answer() = std::move(std::get<proto::EditAnswer>(outcome));
    done.set_session(session_);
    answer(message);
}

void StreamSession::refuse_edit(const std::string& id, const EditRefusal& refusal, bool forbidden) {
    service_.metrics.edits_refused.Increment();
    proto::ServerMessage message;
    proto::EditRefused& refused = *message.mutable_edit_refused();
    refused.set_id(id);
    refused.set_why(forbidden ? proto::EditRefused::forbidden : why_of(refusal.why));
    refused.set_detail(refusal.detail);
    refused.set_revision(refusal.head);
    answer(message);
}

void StreamSession::take_presence(const proto::Presence& presence) {
    const proto::SpritePlacement& held = presence.held();
    for (const double number : {presence.x(), presence.y(), held.x(), held.y(), held.scale(), held.turn(),
                                held.path().to_x(), held.path().to_y()})
        if (!std::isfinite(number))
            return goodbye(Goodbye::wrong_message, "presence: a number is not finite", 1008);
    if (presence.selected_size() > 64)
        return goodbye(Goodbye::wrong_message, "presence: at most 64 sprites are selected", 1008);
    proto::Present::Person person;
    person.set_session(session_);
    person.set_name(name_);
    person.set_may_edit(may_edit().allowed);
    *person.mutable_presence() = presence;
    person.DiscardUnknownFields();
    hub_->presence.set(session_, person.SerializeAsString());
    hub_->wake();
}

}  // namespace tessera
