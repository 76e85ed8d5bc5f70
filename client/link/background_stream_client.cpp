#include "client/link/background_stream_client.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "shared/revisions/edit_id.h"

namespace tessera {

namespace asio = boost::asio;
using std::chrono::milliseconds;

namespace {
constexpr std::size_t most_stale_pages = 65536;
constexpr std::size_t most_edits = 1024;
constexpr std::size_t most_people = 1024;
}  // namespace

class BackgroundStreamClient::Worker final : public StreamListener {
  public:
    Worker(ServerAddress server, std::string scene, StreamSettings settings)
        : max_asks_{settings.max_asks}, work_{context_.get_executor()} {
        client_ = std::make_unique<StreamClient>(context_.get_executor(), std::move(server), scene,
                                                 std::move(settings), *this);
        thread_ = std::thread{[this] { context_.run(); }};
    }
    ~Worker() override {
        asio::post(context_, [this] {
            client_.reset();
            work_.reset();
        });
        thread_.join();  // closed sockets end their operations with an error at once
    }

    bool ask(const StreamAsk& ask) {
        {
            const std::lock_guard lock{mutex_};
            if (!status_.open || asked_.size() + pages_.size() >= max_asks_) return false;
            if (!asked_.insert(ask.id).second) return false;
        }
        asio::post(context_, [this, ask] {
            if (!client_->ask(ask))
                on_page(failed_page(ask, {ErrorCode::io_failure, "the stream takes no asks just now"}));
        });
        return true;
    }
    void cancel(std::uint32_t id) {
        asio::post(context_, [this, id] { client_->cancel(id); });
    }
    void allow(std::uint32_t pages) {
        asio::post(context_, [this, pages] { client_->allow(pages); });
    }
    void watch(std::vector<proto::Window> windows, std::uint64_t seen_revision) {
        asio::post(context_, [this, seen_revision, windows = std::move(windows)]() mutable {
            client_->watch(std::move(windows), seen_revision);
        });
    }
    void be_present(const proto::Presence& presence) {
        asio::post(context_, [this, presence] { client_->be_present(presence); });
    }
    std::string edit(proto::Edit edit) {
        if (edit.id().empty()) edit.set_id(to_string(random_edit_id()));
        std::string id = edit.id();
        asio::post(context_, [this, edit = std::move(edit)]() mutable {
            const std::string edit_id = edit.id();
            const auto done = [this, edit_id](EditFate fate) { ended({edit_id, std::move(fate)}); };
            if (!client_->edit(std::move(edit), done).empty()) return;
            proto::EditRefused refusal;
            refusal.set_id(edit_id);
            refusal.set_why(proto::EditRefused::overloaded);
            refusal.set_detail("too many edits wait for their answers");
            done(refusal);
        });
        return id;
    }

    std::vector<Page> take_pages(std::size_t most) {
        const std::lock_guard lock{mutex_};
        const std::size_t count = std::min(most, pages_.size());
        std::vector<Page> taken;
        taken.reserve(count);
        for (; taken.size() < count; pages_.pop_front()) taken.push_back(std::move(pages_.front()));
        return taken;
    }
    StreamNews take_news() {
        const std::lock_guard lock{mutex_};
        StreamNews news = news_;
        news_.unsure_before = 0;
        news.stale.reserve(stale_.size());
        for (const auto& [page, revision] : stale_) news.stale.push_back({page, revision});
        stale_.clear();
        return news;
    }
    std::vector<Fate> take_fates() {
        const std::lock_guard lock{mutex_};
        return std::exchange(fates_, {});
    }
    std::vector<proto::EditDone> take_edits() {
        const std::lock_guard lock{mutex_};
        std::vector<proto::EditDone> taken{std::make_move_iterator(edits_.begin()),
                                           std::make_move_iterator(edits_.end())};
        edits_.clear();
        return taken;
    }
    std::vector<proto::Present::Person> people() const {
        const std::lock_guard lock{mutex_};
        std::vector<proto::Present::Person> all;
        for (const auto& [session, person] : people_) all.push_back(person);
        return all;
    }
    std::optional<SceneClock> clock() const {
        const std::lock_guard lock{mutex_};
        return clock_;
    }
    std::optional<proto::ServerHello> hello() const {
        const std::lock_guard lock{mutex_};
        return hello_;
    }
    std::uint64_t newest_revision() const {
        const std::lock_guard lock{mutex_};
        return news_.newest_revision;
    }
    StreamStatus status() const {
        const std::lock_guard lock{mutex_};
        StreamStatus now = status_;
        now.retry_in =
            std::max(milliseconds{0},
                     std::chrono::duration_cast<milliseconds>(retry_at_ - std::chrono::steady_clock::now()));
        return now;
    }
    bool wait_for_news(milliseconds timeout) {
        std::unique_lock lock{mutex_};
        const bool told = told_.wait_for(lock, timeout, [&] { return is_told_; });
        is_told_ = false;
        return told;
    }

  private:
    // On the worker's thread, as all of these
    void on_open(const proto::ServerHello& hello) override {
        tell([&] {
            const bool is_known = hello_ && !hello.lineage().empty() &&
                                  hello_->lineage() == hello.lineage() &&
                                  hello_->fingerprint() == hello.fingerprint();
            if (!hello.resumed()) {
                if (!is_known) {
                    ++news_.history;
                    news_.told_revision = 0;
                    stale_.clear();
                }
                news_.unsure_before = is_known ? hello.revision() : 0;
                news_.told_revision = std::max(news_.told_revision, hello.revision());
            }
            news_.newest_revision = hello.revision();
            hello_ = hello;
            people_.clear();
            status_.open = true;
            status_.trouble.clear();
        });
    }
    void on_lost(const Error& why, milliseconds retry_in) override {
        tell([&] {
            status_.open = false;
            status_.trouble = status_.last_loss = why.detail;
            retry_at_ = std::chrono::steady_clock::now() + retry_in;
            people_.clear();
        });
    }
    void on_page(StreamPage page) override {
        tell([&] {
            asked_.erase(page.id);
            news_.newest_revision = std::max(news_.newest_revision, page.scene_revision);
            pages_.push_back({std::move(page), news_.history});
        });
    }
    void on_invalidation(const proto::Invalidation& invalidation) override {
        tell([&] {
            news_.told_revision = std::max(news_.told_revision, invalidation.revision());
            news_.newest_revision = std::max(news_.newest_revision, invalidation.revision());
            const Extent extent{static_cast<std::uint8_t>(hello_->extent_log2_pages())};
            for (const StalePageNews& stale : stale_pages_of(invalidation, extent)) {
                std::uint64_t& revision = stale_[stale.page];
                revision = std::max(revision, stale.revision);
            }
            if (stale_.size() <= most_stale_pages) return;
            stale_.clear();
            news_.unsure_before = news_.told_revision;
        });
    }
    void on_edit(const proto::EditDone& edit) override {
        tell([&] {
            news_.newest_revision = std::max(news_.newest_revision, edit.answer().revision());
            if (edits_.size() >= most_edits) edits_.pop_front();
            edits_.push_back(edit);
        });
    }
    void on_present(const proto::Present& present) override {
        tell([&] {
            for (const std::uint64_t session : present.left()) people_.erase(session);
            for (const auto& person : present.people())
                if (people_.size() < most_people || people_.contains(person.session()))
                    people_[person.session()] = person;
        });
    }
    void on_clock(const proto::ClockNow& told) override {
        tell([&] { clock_ = clock_of(told, clock_time()); });
    }
    void ended(Fate fate) {
        tell([&] { fates_.push_back(std::move(fate)); });
    }

    template <class Change>
    void tell(const Change& change) {
        {
            const std::lock_guard lock{mutex_};
            change();
            if (client_) status_.statistics = client_->statistics();
            is_told_ = true;
        }
        told_.notify_all();
    }

    const std::size_t max_asks_;
    asio::io_context context_{1};
    asio::executor_work_guard<asio::io_context::executor_type> work_;
    std::unique_ptr<StreamClient> client_;  // of the worker's thread alone, once that runs

    mutable std::mutex mutex_;
    std::condition_variable told_;
    bool is_told_ = false;
    std::unordered_set<std::uint32_t> asked_;
    std::deque<Page> pages_;
    StreamNews news_;  // without its stale pages
    std::unordered_map<PageKey, std::uint64_t> stale_;
    std::vector<Fate> fates_;
    std::deque<proto::EditDone> edits_;
    std::map<std::uint64_t, proto::Present::Person> people_;
    std::optional<SceneClock> clock_;
    std::optional<proto::ServerHello> hello_;
    StreamStatus status_;
    std::chrono::steady_clock::time_point retry_at_{};

    std::thread thread_;
};

BackgroundStreamClient::BackgroundStreamClient(ServerAddress server, std::string scene,
                                               StreamSettings settings)
    : worker_{std::make_unique<Worker>(std::move(server), std::move(scene), std::move(settings))} {}
BackgroundStreamClient::~BackgroundStreamClient() = default;

bool BackgroundStreamClient::ask(const StreamAsk& ask) { return worker_->ask(ask); }
void BackgroundStreamClient::cancel(std::uint32_t id) { worker_->cancel(id); }
void BackgroundStreamClient::allow(std::uint32_t pages) { worker_->allow(pages); }
void BackgroundStreamClient::watch(std::vector<proto::Window> windows, std::uint64_t seen_revision) {
    worker_->watch(std::move(windows), seen_revision);
}
void BackgroundStreamClient::be_present(const proto::Presence& presence) { worker_->be_present(presence); }
std::string BackgroundStreamClient::edit(proto::Edit edit) { return worker_->edit(std::move(edit)); }
std::vector<BackgroundStreamClient::Page> BackgroundStreamClient::take_pages(std::size_t most) {
    return worker_->take_pages(most);
}
StreamNews BackgroundStreamClient::take_news() { return worker_->take_news(); }
std::vector<BackgroundStreamClient::Fate> BackgroundStreamClient::take_fates() {
    return worker_->take_fates();
}
std::vector<proto::EditDone> BackgroundStreamClient::take_edits() { return worker_->take_edits(); }
std::vector<proto::Present::Person> BackgroundStreamClient::people() const { return worker_->people(); }
std::optional<SceneClock> BackgroundStreamClient::clock() const { return worker_->clock(); }
SceneClock::Time BackgroundStreamClient::clock_time() {
    return SceneClock::Time{
        std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now().time_since_epoch())};
}
std::optional<proto::ServerHello> BackgroundStreamClient::hello() const { return worker_->hello(); }
std::uint64_t BackgroundStreamClient::newest_revision() const { return worker_->newest_revision(); }
StreamStatus BackgroundStreamClient::status() const { return worker_->status(); }
bool BackgroundStreamClient::wait_for_news(milliseconds timeout) { return worker_->wait_for_news(timeout); }

}  // namespace tessera
