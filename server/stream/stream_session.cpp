#include "server/stream/stream_session.h"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "proto/stream.pb.h"

#include "server/sprites/sprite_images.h"

namespace tessera {

using proto::Goodbye;

StreamSession::StreamSession(PageSocket socket, StreamThread& thread, StreamOpening opening)
    : thread_{thread},
      service_{thread.service()},
      options_{service_.options},
      place_{thread.sessions_.insert(thread.sessions_.end(), this)},
      admitted_{std::move(opening.place)},
      connection_{std::move(opening.connection)},
      scene_id_{std::move(opening.scene)},
      from_loopback_{opening.from_loopback},
      token_{std::move(opening.token)},
      socket_{std::move(socket), options_},
      pages_{options_},
      windows_{options_.windows, options_.window_pages} {}

StreamSession::~StreamSession() { thread_.sessions_.erase(place_); }

void StreamSession::begin(const StreamSocket::Upgrade& upgrade) {
    hello_by_ = Clock::now() + options_.hello_time;
    socket_.accept(upgrade, shared_from_this());
}

void StreamSession::opened() {
    socket_.read_on();
    send_next();  // the server may be stopping already
}

void StreamSession::ended(std::string_view why, bool cut) {
    if (cut) service_.metrics.streams_cut.Increment();
    spdlog::debug("stream {} of {} ended: {}", session_, scene_id_, why);
    pages_.clear();
    if (!hub_) return;
    std::erase(audience_->sessions, this);
    if (wants_edits_) --hub_->news_readers;
    hub_->presence.leave(session_);
    hub_->wake();
    hub_.reset();
}

void StreamSession::check(Clock::time_point now) {
    socket_.check(now);
    if (!hub_ && !leaving_ && now >= hello_by_)
        goodbye(Goodbye::idle, "the first message is ClientHello, within five seconds", 1008);
    if (hub_ && now >= next_clock_) wake();
}

void StreamSession::drain() {
    goodbye(Goodbye::stopping, "the server is stopping; come back in a moment", 1001);
}

void StreamSession::site_changed() {
    if (!hub_) return;
    if (!scene_now()) return goodbye(Goodbye::scene_gone, "the scene is not served any more", 1000);
    wake();
}

void StreamSession::goodbye(int why, std::string detail, unsigned code) {
    if (std::exchange(leaving_, true)) return;
    if (why == Goodbye::wrong_message || why == Goodbye::too_slow || why == Goodbye::idle)
        service_.metrics.streams_cut.Increment();
    pages_.clear();
    close_code_ = code;
    close_why_ = detail;
    proto::ServerMessage message;
    message.mutable_goodbye()->set_why(static_cast<Goodbye::Why>(why));
    message.mutable_goodbye()->set_detail(std::move(detail));
    answer(message);
}

void StreamSession::wake() {
    start_pages();
    send_next();
}

void StreamSession::woke() {
    wakes_at_ = Clock::time_point::max();
    wake();
}

/// Whether it is `at` already; else this session looks again later.
bool StreamSession::is_time(Clock::time_point at) {
    if (Clock::now() >= at) return true;
    if (at < wakes_at_) {
        wakes_at_ = at;
        thread_.wake_at(at, shared_from_this());
    }
    return false;
}

// ---- Pages

void StreamSession::start_pages() {
    while (hub_ && !leaving_) {
        const auto started = pages_.start();
        if (!started) return;
        start_page(*started);
    }
}

void StreamSession::start_page(const PageFlow::Started& started) {
    using Refusal = proto::PageRefusal;
    const StreamAsk& ask = started.ask;
    const ScenePtr scene = scene_now();
    const auto refuse = [&](Refusal::Why why, std::string detail, std::uint32_t retry_ms = 0) {
        pages_.drop(started);
        refuse_page(ask.id, why, std::move(detail), retry_ms);
    };
    if (!scene) return refuse(Refusal::failed, "the scene is not served any more");
    if (!scene->extent.contains(ask.key)) return refuse(Refusal::wrong, "page: is outside the extent");
    if (scene->texture_of(ask.options->channels) == nullptr)
        return refuse(Refusal::wrong, "options.channels: the scene has " + scene->channel_names());
    if (ask.least_revision > scene->revision)
        return refuse(Refusal::not_yet, "the scene is at revision " + std::to_string(scene->revision), 20);

    PageRequest request{scene, ask.key, *ask.options, ask.urgency};
    request.options.slice = scene->same_slice(request.options.slice);
    request.options.step = scene->same_step(ask.step);
    request.options.parameter = scene->same_parameter(request.options.parameter);
    const auto known = service_.pages.id_of(request);
    if (known) {
        // It is found often, and then costs no other thread anything
        PagePtr page = service_.pages.find(*known, request);
        const bool unchanged = ask.have && ask.have->names(*known);
        if (page || unchanged)
            return pages_.finish(started, {.id = ask.id,
                                           .key = ask.key,
                                           .tag = *known,
                                           .revision = page_revision(*scene, ask.key),
                                           .scene_revision = scene->revision,
                                           .page = std::move(page),
                                           .unchanged = unchanged,
                                           .brief = ask.brief});
    }
    pages_.set_ticket(
        started, service_.pages.request(request, [weak = weak_from_this(), executor = thread_.executor(),
                                                  started, revision = scene->revision](Result<PagePtr> page) {
            boost::asio::post(executor, [weak, started, revision, page = std::move(page)]() mutable {
                if (const auto self = weak.lock()) self->page_done(started, revision, std::move(page));
            });
        }));
}

void StreamSession::page_done(const PageFlow::Started& started, Revision scene_revision,
                              Result<PagePtr> page) {
    using Refusal = proto::PageRefusal;
    if (page) {
        const StreamAsk& ask = started.ask;
        const PageId tag = (*page)->id;
        const Revision revision = (*page)->revision;
        pages_.finish(started, {.id = ask.id,
                                .key = ask.key,
                                .tag = tag,
                                .revision = revision,
                                .scene_revision = scene_revision,
                                .page = std::move(*page),
                                .unchanged = ask.have && ask.have->names(tag),
                                .brief = ask.brief});
    } else if (pages_.drop(started)) {
        const Error& error = page.error();
        const auto why = error.code == ErrorCode::overloaded  ? Refusal::overloaded
                         : error.code == ErrorCode::timed_out ? Refusal::timed_out
                         : error.code == ErrorCode::cancelled ? Refusal::cancelled
                                                              : Refusal::failed;
        if (why == Refusal::failed) spdlog::error("stream of {}: {}", scene_id_, error.detail);
        refuse_page(started.ask.id, why, error.detail, why == Refusal::overloaded ? 1000 : 0);
    }
    wake();
}

void StreamSession::refuse_page(std::uint32_t id, int why, std::string detail, std::uint32_t retry_ms) {
    service_.metrics.pages_refused.Increment();
    proto::ServerMessage message;
    proto::PageRefusal& refusal = *message.mutable_refused();
    refusal.set_id(id);
    refusal.set_why(static_cast<proto::PageRefusal::Why>(why));
    refusal.set_detail(std::move(detail));
    refusal.set_retry_ms(retry_ms);
    answer(message);
}

// ---- What the client is told

void StreamSession::answer(const proto::ServerMessage& message) {
    answers_.push_back(message.SerializeAsString());
    answer_bytes_ += answers_.back().size() + sizeof(std::string);
    send_next();
}

void StreamSession::sent() {
    if (read_paused_ && answer_bytes_ <= options_.answer_bytes / 2) {
        read_paused_ = false;
        socket_.read_on();
    }
    wake();
}

void StreamSession::send(std::string message) {
    service_.metrics.bytes.Increment(static_cast<double>(message.size()));
    socket_.send(std::move(message));
}

void StreamSession::send_next() {
    if (!socket_.ready()) return;
    if (!answers_.empty()) {
        std::string message = std::move(answers_.front());
        answers_.pop_front();
        answer_bytes_ -= message.size() + sizeof(std::string);
        return send(std::move(message));
    }
    if (leaving_) return socket_.close(close_code_, close_why_);
    if (!hub_) return;
    const ScenePtr scene = scene_now();
    if (!scene) return;
    if (auto message = next_replaced(scene)) return send(std::move(*message));
    if (auto message = next_clock(*scene)) return send(std::move(*message));
    if (auto message = next_invalidation(*scene)) return send(std::move(*message));
    if (auto message = next_presence()) return send(std::move(*message));
    if (leaving_) return;
    // By turns: neither many edits nor many pages hold the other up
    news_turn_ = !news_turn_;
    if (news_turn_ ? send_news() || send_page() : send_page() || send_news()) return;
}

std::optional<std::string> StreamSession::next_replaced(const ScenePtr& scene) {
    if (scene->fingerprint == fingerprint_) return std::nullopt;
    windows_.forget(scene->revision);
    told_ = news_told_ = scene->revision;
    proto::ServerMessage message;
    write_hello(*scene, *message.mutable_replaced()->mutable_hello());
    return message.SerializeAsString();
}

namespace {

void write_clock(const SceneClock& clock, proto::ClockNow& message) {
    const auto reading =
        clock.read(std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now()));
    message.set_steps_per_second(clock.steps_per_second);
    message.set_loop_steps(clock.loop_steps);
    message.set_playing(clock.playing);
    message.set_step(reading.step);
    message.set_step_part(reading.part);
}

}  // namespace

std::optional<std::string> StreamSession::next_clock(const Scene& scene) {
    const auto now = Clock::now();
    const SceneClock clock = service_.clock_of(scene);
    if (clock == clock_ && now < next_clock_) return std::nullopt;
    clock_ = clock;
    next_clock_ = now + options_.clock_pause;
    proto::ServerMessage message;
    write_clock(clock, *message.mutable_clock());
    return message.SerializeAsString();
}

std::optional<std::string> StreamSession::next_invalidation(const Scene& scene) {
    const Revision now = scene.revision;
    const bool behind = windows_.behind(now);
    if (!behind && told_ >= now) return std::nullopt;
    if (!is_time(next_invalidation_)) return std::nullopt;
    const auto begun = Clock::now();
    const std::vector<ChangedPage> stale =
        behind ? windows_.take_stale(scene.page_revisions, now) : std::vector<ChangedPage>{};
    // A revision that changed nothing here is told, too, but not each
    if (stale.empty() && (told_ >= now || !is_time(next_revision_))) return std::nullopt;
    // Nobody's windows take more than a fifth of this thread's time
    const auto time = Clock::now();
    next_invalidation_ = time + std::max<Clock::duration>(options_.invalidation_pause, 4 * (time - begun));
    next_revision_ = time + options_.revision_pause;
    if (now > told_ + 1) service_.metrics.revisions_coalesced.Increment(static_cast<double>(now - told_ - 1));
    told_ = now;

    service_.metrics.invalidations.Increment();
    service_.metrics.stale_pages.Increment(static_cast<double>(stale.size()));
    proto::ServerMessage message;
    proto::Invalidation& invalidation = *message.mutable_invalidation();
    invalidation.set_revision(now);
    proto::StalePages* level = nullptr;  // they are in order of levels
    for (const ChangedPage& page : stale) {
        if (level == nullptr || level->level() != page.key.level) {
            level = invalidation.add_stale();
            level->set_level(page.key.level);
        }
        level->add_x(page.key.x);
        level->add_y(page.key.y);
        level->add_revision(page.revision);
    }
    return message.SerializeAsString();
}

std::optional<std::string> StreamSession::next_presence() {
    if (!wants_presence_ || hub_->presence.version() == presence_read_ || !is_time(next_presence_))
        return std::nullopt;
    next_presence_ = Clock::now() + options_.presence_pause;
    const PresenceBoard::News news = hub_->presence.after(presence_read_, session_);
    if (news.lost) {
        goodbye(Goodbye::too_slow, "so many people have left meanwhile that not all can be named", 1008);
        return std::nullopt;
    }
    presence_read_ = news.version;
    if (news.people.empty() && news.left.empty()) return std::nullopt;
    proto::ServerMessage message;
    proto::Present& present = *message.mutable_present();
    for (const auto& person : news.people) present.add_people()->ParseFromString(*person);
    for (const PresenceBoard::Session session : news.left) present.add_left(session);
    return message.SerializeAsString();
}

bool StreamSession::send_news() {
    if (!wants_edits_) return false;
    for (;;) {
        const EditNewsRing::Next next = hub_->news.after(news_told_);
        if (next.missed_to != 0) {
            news_told_ = next.missed_to;
            proto::ServerMessage message;
            message.mutable_edit_done()->mutable_answer()->set_revision(news_told_);
            send(message.SerializeAsString());
            return true;
        }
        if (!next.news) return false;
        news_told_ = next.news->revision;
        if (next.news->session == session_) continue;  // who has been answered
        service_.metrics.bytes.Increment(static_cast<double>(next.news->message.size()));
        const std::string& bytes = next.news->message;
        socket_.send({}, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, next.news);
        return true;
    }
}

bool StreamSession::send_page() {
    const auto page = pages_.take();
    if (!page) return false;
    service_.metrics.pages.Increment();
    if (page->unchanged) service_.metrics.pages_unchanged.Increment();
    PageMessage message = page_message(*page);
    service_.metrics.bytes.Increment(static_cast<double>(message.head.size() + message.texels.size()));
    socket_.send(std::move(message.head), message.texels, page->page);
    return true;
}

void StreamSession::write_hello(const Scene& scene, proto::ServerHello& hello) {
    fingerprint_ = scene.fingerprint;
    hello.set_scene(scene.id);
    hello.set_title(scene.title);
    hello.set_revision(scene.revision);
    hello.set_fingerprint(scene.fingerprint);
    hello.set_extent_log2_pages(scene.extent.n);
    hello.set_session(session_);
    hello.set_animated(scene.animated);
    const auto live = service_.edits.find(scene.id);
    hello.set_takes_edits(live != nullptr);
    if (live) hello.set_lineage(live->lineage());
    const Access::Decision decision = may_edit();
    hello.set_may_edit(live && decision.allowed);
    if (!live)
        hello.set_why_not(
            "the scene takes no edits; give its scene.json \"sprites\", or a block \"editable\"");
    else if (!decision.allowed)
        hello.set_why_not(decision.why);
    clock_ = service_.clock_of(scene);
    next_clock_ = Clock::now() + options_.clock_pause;
    write_clock(clock_, *hello.mutable_clock());
    if (scene.sprite_images) {
        for (std::int32_t i = 0; i < scene.sprite_images->count(); ++i)
            hello.add_patterns("pattern " + std::to_string(i));
        hello.set_pattern_side_texels(static_cast<std::uint32_t>(scene.sprite_images->side()));
    }
    proto::StreamLimits& limits = *hello.mutable_limits();
    limits.set_windows(static_cast<std::uint32_t>(options_.windows));
    limits.set_window_pages(static_cast<std::uint32_t>(options_.window_pages));
    limits.set_asks(static_cast<std::uint32_t>(options_.asks));
    limits.set_credits(static_cast<std::uint32_t>(options_.credits));
    limits.set_message_bytes(static_cast<std::uint32_t>(options_.message_bytes));
}

Access::Decision StreamSession::may_edit() const {
    return thread_.access().may_edit({from_loopback_, token_});
}

}  // namespace tessera
