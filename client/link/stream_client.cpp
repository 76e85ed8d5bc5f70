#include "client/link/stream_client.h"

#include <algorithm>
#include <utility>

#include <boost/asio/post.hpp>

#include "client/link/stream_client_state.h"
#include "shared/revisions/edit_id.h"

namespace tessera {

namespace asio = boost::asio;

namespace {
constexpr std::uint32_t most_credits = 1024;
constexpr std::size_t longest_name = 64;
constexpr std::size_t most_edit_bytes = 256 * 1024 - 64;  // of a client's message, less its head
}  // namespace

StreamClient::State::State(asio::any_io_executor executor, ServerAddress server, const std::string& scene,
                           StreamSettings settings, StreamListener& listener)
    : executor_{executor},
      server_{std::move(server)},
      target_{scene_target(scene) + "/stream"},
      settings_{std::move(settings)},
      listener_{&listener},
      retry_timer_{executor},
      time_timer_{executor},
      dice_{std::random_device{}()} {
    settings_.options.format = PageFormat::rgba;
    settings_.name.resize(std::min(settings_.name.size(), longest_name));
}

void StreamClient::State::shut_down() {
    is_over_ = true;
    listener_ = nullptr;
    retry_timer_.cancel();
    time_timer_.cancel();
    if (!line_) return;
    line_->wake.cancel();
    line_->socket->close();
}

void StreamClient::State::wake() {
    if (line_) line_->wake.cancel();
}

bool StreamClient::State::ask(const StreamAsk& ask) {
    if (!is_open()) return false;
    if (asks_.size() >= std::min<std::size_t>(settings_.max_asks, line_->limits.asks())) return false;
    if (!asks_.add(ask, Clock::now())) return false;
    wake();
    return true;
}

void StreamClient::State::cancel(std::uint32_t id) {
    switch (asks_.cancel(id)) {
        case StreamAsks::Cancelled::unknown:
            return;
        case StreamAsks::Cancelled::has_to_be_sent:
            if (std::ranges::find(line_->cancels, id) == line_->cancels.end()) line_->cancels.push_back(id);
            return wake();
        case StreamAsks::Cancelled::never_sent:
            break;
    }
    asio::post(executor_, [self = shared_from_this(), id] {
        StreamAsk ask;
        ask.id = id;
        if (self->listener_)
            self->listener_->on_page(
                failed_page(ask, {ErrorCode::cancelled, "the caller cancelled the ask"}));
    });
}

void StreamClient::State::allow(std::uint32_t pages) {
    allowed_ = std::min(pages, most_credits);
    wake();
}

void StreamClient::State::watch(std::vector<proto::Window> windows, std::uint64_t seen_revision) {
    windows_ = std::move(windows);
    windows_seen_ = seen_revision;
    if (line_) line_->tell_windows = true;
    wake();
}

std::string StreamClient::State::edit(proto::Edit edit, PendingEdits::Completion done) {
    if (edits_.size() >= settings_.max_edits) return "";
    if (edit.id().empty()) edit.set_id(to_string(random_edit_id()));
    std::string id = edit.id();
    if (edit.ByteSizeLong() > most_edit_bytes) {
        asio::post(executor_, [self = shared_from_this(), id, done = std::move(done)] {
            proto::EditRefused refusal;
            refusal.set_id(id);
            refusal.set_why(proto::EditRefused::wrong);
            refusal.set_detail("an edit has at most 256 KiB; send several");
            if (!self->is_over_) done(refusal);
        });
        return id;
    }
    edits_.add(std::move(edit), std::move(done), Clock::now());
    wake();
    return id;
}

void StreamClient::State::be_present(const proto::Presence& presence) {
    presence_ = presence;
    is_present_ = true;
    if (line_) line_->tell_presence = true;
    wake();
}

StreamStatistics StreamClient::State::statistics() const {
    StreamStatistics counts = counts_;
    counts.bytes_received = bytes_of_past_lines_ + (line_ ? line_->socket->bytes_received() : 0);
    counts.edits_sent_again = edits_.sent_again();
    counts.asks = asks_.size();
    counts.credits = line_ ? line_->credits : 0;
    return counts;
}

StreamClient::StreamClient(asio::any_io_executor executor, ServerAddress server, const std::string& scene,
                           StreamSettings settings, StreamListener& listener)
    : state_{std::make_shared<State>(std::move(executor), std::move(server), scene, std::move(settings),
                                     listener)} {
    state_->start();
}
StreamClient::~StreamClient() { state_->shut_down(); }

bool StreamClient::is_open() const { return state_->is_open(); }
bool StreamClient::ask(const StreamAsk& ask) { return state_->ask(ask); }
void StreamClient::cancel(std::uint32_t id) { state_->cancel(id); }
void StreamClient::allow(std::uint32_t pages) { state_->allow(pages); }
void StreamClient::watch(std::vector<proto::Window> windows, std::uint64_t seen_revision) {
    state_->watch(std::move(windows), seen_revision);
}
std::string StreamClient::edit(proto::Edit edit, PendingEdits::Completion done) {
    return state_->edit(std::move(edit), std::move(done));
}
void StreamClient::be_present(const proto::Presence& presence) { state_->be_present(presence); }
std::uint64_t StreamClient::newest_revision() const { return state_->newest_revision(); }
StreamStatistics StreamClient::statistics() const { return state_->statistics(); }

}  // namespace tessera
