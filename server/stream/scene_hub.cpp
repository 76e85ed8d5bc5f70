#include "server/stream/scene_hub.h"

#include <utility>

#include <boost/asio/post.hpp>

#include "proto/stream.pb.h"

#include "server/stream/stream_session.h"

namespace tessera {
namespace {

constexpr std::size_t most_change_bytes = std::size_t{16} << 10;

}  // namespace

void Audience::wake() {
    if (woken_.exchange(true)) return;
    boost::asio::post(executor_, [self = shared_from_this()] {
        self->woken_ = false;
        for (StreamSession* session : self->sessions) session->wake();
    });
}

void SceneHub::follow(const std::shared_ptr<LiveScene>& live) {
    std::shared_ptr<void> before;  // let go without the lock
    const std::lock_guard lock{mutex_};
    if (live_.lock() == live) return;
    live_ = live;
    before = std::exchange(listening_, nullptr);
    if (live)
        listening_ = live->listen([this](const std::vector<LiveScene::Change>& changes) { take(changes); });
}

std::shared_ptr<Audience> SceneHub::add_audience(IoExecutor executor) {
    const std::lock_guard lock{mutex_};
    audiences_.push_back(std::make_shared<Audience>(std::move(executor)));
    return audiences_.back();
}

void SceneHub::wake() {
    const std::lock_guard lock{mutex_};
    for (const auto& audience : audiences_) audience->wake();
}

void SceneHub::edit_begins(const EditId& edit, std::uint64_t session) {
    const std::lock_guard lock{mutex_};
    makers_.emplace(edit, session);
}

void SceneHub::edit_ends(const EditId& edit) {
    const std::lock_guard lock{mutex_};
    makers_.erase(edit);
}

/// On a thread of the journal.
void SceneHub::take(const std::vector<LiveScene::Change>& changes) {
    if (news_readers == 0) {
        if (!changes.empty()) news.skip(changes.back().revision);
    } else {
        for (const LiveScene::Change& change : changes) news.add(news_of(change));
    }
    wake();
}

EditNewsPtr SceneHub::news_of(const LiveScene::Change& change) {
    auto told = std::make_shared<EditNews>();
    told->revision = change.revision;
    proto::ServerMessage message;
    proto::EditDone& done = *message.mutable_edit_done();
    done.mutable_answer()->set_revision(change.revision);
    for (const TexelBox& box : change.dirty) {
        proto::DirtyBox& dirty = *done.mutable_answer()->add_dirty();
        dirty.set_x0(box.x0);
        dirty.set_y0(box.y0);
        dirty.set_x1(box.x1);
        dirty.set_y1(box.y1);
    }
    if (change.edit) {
        done.set_id(change.edit->id());
        done.set_author(change.edit->author());
        if (const auto id = edit_id_from(change.edit->id())) {
            const std::lock_guard lock{mutex_};
            if (const auto maker = makers_.find(*id); maker != makers_.end()) told->session = maker->second;
        }
        done.set_session(told->session);
        if (change.edit->ByteSizeLong() <= most_change_bytes)
            for (const proto::Change& one : change.edit->changes()) *done.add_changes() = one;
    }
    told->message = message.SerializeAsString();
    return told;
}

}  // namespace tessera
