#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/stream/page_flow.h"
#include "server/stream/page_message.h"
#include "server/stream/page_windows.h"
#include "server/stream/scene_hub.h"
#include "server/stream/stream_service.h"
#include "server/stream/stream_socket.h"
#include "server/stream/stream_thread.h"

namespace tessera {

namespace proto {
class ClientHello;
class ClientMessage;
class Edit;
class PageAsks;
class Presence;
class ServerHello;
class ServerMessage;
class Windows;
}  // namespace proto

/// One client's stream (proto/stream.proto). It keeps no queue of news: what the client has heard of is all
/// that is remembered, and what is new is looked up when the socket can take a message. Everything runs on
/// one I/O thread.
class StreamSession final : public StreamEnd, public std::enable_shared_from_this<StreamSession> {
  public:
    using Clock = StreamThread::Clock;

    StreamSession(PageSocket socket, StreamThread& thread, StreamOpening opening);
    ~StreamSession() override;

    void begin(const StreamSocket::Upgrade& upgrade);
    /// Something may be new: it is told as soon as the socket can take it.
    void wake();
    void woke();
    void site_changed();
    void check(Clock::time_point now);
    void drain();
    void abort() { socket_.abort(); }

  private:
    // StreamEnd
    void opened() override;
    void received(std::string_view bytes) override;
    void sent() override;
    void ended(std::string_view why, bool cut) override;

    // What the client says
    void take(proto::ClientMessage& message);
    void take_hello(const proto::ClientHello& hello);
    void take_windows(const proto::Windows& message);
    void take_asks(const proto::PageAsks& message);
    void take_edit(proto::Edit edit);
    void take_presence(const proto::Presence& presence);
    void edit_answered(const std::string& id, EditOutcome outcome);
    void refuse_edit(const std::string& id, const EditRefusal& refusal, bool forbidden = false);

    // Pages
    void start_pages();
    void start_page(const PageFlow::Started& started);
    void page_done(const PageFlow::Started& started, Revision scene_revision, Result<PagePtr> page);
    void refuse_page(std::uint32_t id, int why, std::string detail, std::uint32_t retry_ms = 0);

    // What the client is told: each gives the next message, or nothing
    void send_next();
    std::optional<std::string> next_replaced(const ScenePtr& scene);
    std::optional<std::string> next_clock(const Scene& scene);
    std::optional<std::string> next_invalidation(const Scene& scene);
    std::optional<std::string> next_presence();
    bool send_news();
    bool send_page();
    void send(std::string message);
    void answer(const proto::ServerMessage& message);
    void write_hello(const Scene& scene, proto::ServerHello& hello);
    void goodbye(int why, std::string detail, unsigned code);
    bool is_time(Clock::time_point at);
    Access::Decision may_edit() const;
    ScenePtr scene_now() const { return thread_.catalog().find(scene_id_); }

    StreamThread& thread_;
    StreamService& service_;
    const StreamOptions& options_;
    std::list<StreamSession*>::iterator place_;
    const std::shared_ptr<void> admitted_, connection_;
    const std::string scene_id_;
    const bool from_loopback_;
    std::string token_, name_;
    StreamSocket socket_;

    std::shared_ptr<SceneHub> hub_;  ///< From the hello on.
    std::shared_ptr<Audience> audience_;
    std::uint64_t session_ = 0;
    std::string fingerprint_;  ///< As the client was told.
    bool wants_presence_ = false, wants_edits_ = false;
    bool leaving_ = false;  ///< Goodbye is the last message.
    unsigned close_code_ = 0;
    std::string close_why_;

    std::deque<std::string> answers_;  ///< To what the client sent; while they are many, nothing is read.
    std::size_t answer_bytes_ = 0;
    bool read_paused_ = false;

    PageFlow pages_;
    PageWindows windows_;
    std::optional<Revision> resumes_;  ///< The revision that the client has seen before a break.
    Revision told_ = 0;                ///< The revision that the client heard last.
    Revision news_told_ = 0;
    PresenceBoard::Version presence_read_ = 0;
    SceneClock clock_;  ///< As the client was told.
    std::size_t edits_under_way_ = 0;
    bool news_turn_ = false;
    Clock::time_point wakes_at_ = Clock::time_point::max();
    Clock::time_point hello_by_{}, next_invalidation_{}, next_revision_{}, next_presence_{}, next_clock_{};
};

}  // namespace tessera
