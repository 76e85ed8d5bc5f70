#include "tests/simulation/simulated_stream.h"

#include <algorithm>
#include <tuple>

namespace tessera::testing {

// ---- The client's side

bool SimulatedStream::request(const PageRequest& request) {
    if (is_offline_) return false;
    asked.push_back(request);
    if (std::ranges::any_of(under_way_, [&](const auto& other) { return other.second == request.page; }))
        ++duplicate_requests;
    under_way_[request.id] = request.page;
    most_under_way = std::max(most_under_way, under_way_.size());
    over_allowance += under_way_.size() > allowed_ ? 1 : 0;
    upwards_.push_back({now_ + link_.one_way_ms, {.kind = Message::Kind::request, .request = request}});
    return true;
}

void SimulatedStream::cancel(PageRequestId id) {
    if (!is_offline_)
        upwards_.push_back({now_ + link_.one_way_ms, {.kind = Message::Kind::cancel, .id = id}});
}

void SimulatedStream::watch(std::span<const PageWindow> windows, std::uint64_t seen_revision) {
    Message message;
    message.kind = Message::Kind::watch;
    message.windows.assign(windows.begin(), windows.end());
    message.seen = seen_revision;
    if (is_offline_)
        windows_to_say_ = std::move(message);
    else
        upwards_.push_back({now_ + link_.one_way_ms, std::move(message)});
}

std::vector<ArrivedPage> SimulatedStream::take_arrived(std::size_t most) {
    std::vector<ArrivedPage> arrived;
    std::ranges::stable_sort(downwards_, {}, &Answer::at);
    while (!downwards_.empty() && arrived.size() < most && downwards_.front().at <= now_) {
        ArrivedPage page = std::move(downwards_.front().page);
        downwards_.erase(downwards_.begin());
        under_way_.erase(page.id);
        // Texels are painted when they are taken: those of the version that was sent
        if (page.texels) page.texels = paint_(page.page, page.version.history, page.version.revision);
        arrived.push_back(std::move(page));
    }
    return arrived;
}

SceneNews SimulatedStream::take_news() {
    SceneNews all{.history = 0, .told_revision = 0};
    while (!news_.empty() && news_.front().at <= now_) {
        SceneNews& next = news_.front().news;
        if (next.history > all.history) all = {.history = next.history, .told_revision = 0};
        all.told_revision = std::max(all.told_revision, next.told_revision);
        all.unsure_before = std::max(all.unsure_before, next.unsure_before);
        all.stale.insert(all.stale.end(), next.stale.begin(), next.stale.end());
        news_.pop_front();
    }
    return all;
}

// ---- The server's side

std::uint64_t SimulatedStream::revision_of(PageKey page) const {
    const auto found = revisions_.find(page);
    return found == revisions_.end() ? 0 : found->second;
}

bool SimulatedStream::is_watched(PageKey page) const {
    return std::ranges::any_of(windows_, [&](const PageWindow& window) { return window.contains(page); });
}

void SimulatedStream::tell(SceneNews news, double at) {
    // In order: a message overtakes no other
    at = std::max(at + link_.one_way_ms, news_.empty() ? 0 : news_.back().at);
    news_.push_back({at, std::move(news)});
}

void SimulatedStream::edit(const std::vector<PageKey>& pages) {
    ++revision_;
    SceneNews news{.history = history_, .told_revision = revision_};
    for (const PageKey page : pages) {
        revisions_[page] = revision_;
        if (is_watched(page)) news.stale.push_back({page, revision_});
    }
    if (is_offline_) return;  // told when the connection is there again
    told_ = revision_;
    tell(std::move(news), now_);
}

void SimulatedStream::replace_scene() {
    ++history_;
    revision_ = told_ = 0;
    revisions_.clear();
    if (!is_offline_) tell({.history = history_, .told_revision = 0}, now_);
}

void SimulatedStream::disconnect(double ms, bool remembers) {
    is_offline_ = true;
    remembers_ = remembers;
    offline_until_ = now_ + ms;
    for (const auto& [at, message] : upwards_)
        if (message.kind == Message::Kind::watch) windows_to_say_ = message;
    upwards_.clear();
    queue_.clear();
    downwards_.clear();
    for (const auto& [id, page] : under_way_)
        downwards_.push_back(
            {now_, {.id = id, .page = page, .texels = Error{ErrorCode::io_failure, "connection lost"}}});
}

void SimulatedStream::answer(ArrivedPage page, double at) {
    const double delay = std::uniform_real_distribution{0.0, 1.0}(random_)*link_.most_delay_ms;
    const auto chance = [&](double share) { return std::bernoulli_distribution{share}(random_); };
    if (chance(link_.loss))
        page = {.id = page.id, .page = page.page, .texels = Error{ErrorCode::io_failure, "lost"}}, at += 1000;
    if (chance(link_.duplicates)) downwards_.push_back({at + link_.one_way_ms + 3 * delay, page});
    downwards_.push_back({at + link_.one_way_ms + delay, std::move(page)});
}

void SimulatedStream::take_message(Message& message, double at) {
    switch (message.kind) {
        case Message::Kind::request:
            queue_.push_back(std::move(message.request));
            return;
        case Message::Kind::cancel: {
            const auto found = std::ranges::find(queue_, message.id, &PageRequest::id);
            if (found == queue_.end()) return;
            answer({.id = found->id, .page = found->page, .texels = Error{ErrorCode::cancelled, "cancelled"}},
                   at);
            queue_.erase(found);
            return;
        }
        case Message::Kind::watch: {
            // What changed in windows that are new is told at once
            SceneNews news{.history = history_, .told_revision = told_};
            for (const auto& [page, revision] : revisions_) {
                const auto is_in = [&, key = page](const PageWindow& window) { return window.contains(key); };
                if (revision > message.seen && std::ranges::any_of(message.windows, is_in) &&
                    !is_watched(page))
                    news.stale.push_back({page, revision});
            }
            windows_ = std::move(message.windows);
            tell(std::move(news), at);
        }
    }
}

void SimulatedStream::send_next() {
    // The most urgent; of equals the first
    const auto next = std::ranges::min_element(queue_, {}, &PageRequest::urgency);
    const PageRequest request = *next;
    queue_.erase(next);
    const double begin = std::max(link_free_, now_);
    if (request.least_revision > revision_)
        return answer(
            {.id = request.id, .page = request.page, .texels = Error{ErrorCode::overloaded, "not yet"}},
            begin);
    const double took = link_.bytes_per_second > 0
                            ? 1000.0 * static_cast<double>(link_.page_bytes) / link_.bytes_per_second
                            : 0;
    link_free_ = begin + took;
    Validity validity;
    if (interval > 0) {
        validity.from = request.step - ((request.step % interval) + interval) % interval;
        validity.until = validity.from + interval;
    }
    ++pages_sent;
    bytes_sent += link_.page_bytes;
    answer({.id = request.id,
            .page = request.page,
            .texels = std::string{},
            .version = {.history = history_,
                        .revision = revision_of(request.page),
                        .scene_revision = revision_,
                        .validity = validity},
            .wire_bytes = link_.page_bytes},
           link_free_);
}

void SimulatedStream::advance(ClientTime to) {
    const auto until = static_cast<double>(to.count());
    for (;;) {
        if (is_offline_) {
            if (offline_until_ > until) break;
            now_ = std::max(now_, offline_until_);
            is_offline_ = false;
            SceneNews news{.history = history_, .told_revision = revision_};
            if (!remembers_) news.unsure_before = revision_;
            for (const auto& [page, revision] : revisions_)
                if (remembers_ && revision > told_ && is_watched(page))
                    news.stale.push_back({page, revision});
            told_ = revision_;
            tell(std::move(news), now_);
            if (windows_to_say_) take_message(*windows_to_say_, now_);
            windows_to_say_.reset();
        }
        const double message_at = upwards_.empty() ? 1e300 : upwards_.front().first;
        const double sent_at = queue_.empty() ? 1e300 : std::max(link_free_, now_);
        if (std::min(message_at, sent_at) > until) break;
        now_ = std::max(now_, std::min(message_at, sent_at));
        if (message_at <= sent_at) {
            Message message = std::move(upwards_.front().second);
            upwards_.pop_front();
            take_message(message, now_);
        } else {
            send_next();
        }
    }
    now_ = until;
}

}  // namespace tessera::testing
