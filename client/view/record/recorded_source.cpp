#include "client/view/record/recorded_source.h"

#include <utility>

#include <xxhash.h>

#include "client/view/record/session.pb.h"

namespace tessera {
namespace {

std::uint64_t name_of(const PageRequest& request) {
    const std::uint64_t words[] = {request.id, request.page.level, request.page.x, request.page.y,
                                   request.without.size()};
    return XXH3_64bits(words, sizeof words);
}

std::uint64_t digest_of(const std::vector<std::uint64_t>& asked) {
    return XXH3_64bits(asked.data(), asked.size() * sizeof asked[0]);
}

void write_key(PageKey page, view::RecordedKey& message) {
    message.set_level(page.level);
    message.set_x(page.x);
    message.set_y(page.y);
}

PageKey read_key(const view::RecordedKey& message) {
    return {static_cast<std::uint8_t>(message.level()), message.x(), message.y()};
}

void write_arrival(const ArrivedPage& page, view::Arrival& message) {
    message.set_id(page.id);
    write_key(page.page, *message.mutable_page());
    if (page.texels) {
        message.set_texels(*page.texels);
    } else {
        message.set_failed(true);
        message.set_error_code(static_cast<std::int32_t>(page.texels.error().code));
        message.set_error(page.texels.error().detail);
    }
    message.set_unchanged(page.unchanged);
    message.set_history(page.version.history);
    message.set_revision(page.version.revision);
    message.set_scene_revision(page.version.scene_revision);
    message.set_valid_from(page.version.validity.from);
    message.set_valid_until(page.version.validity.until);
    message.set_tag(page.version.tag);
    message.set_bound_codes(page.version.bound_codes);
    message.set_wire_bytes(page.wire_bytes);
    message.set_retry_ms(page.retry_ms);
}

ArrivedPage read_arrival(const view::Arrival& message) {
    ArrivedPage page{.id = message.id(), .page = read_key(message.page()), .texels = message.texels()};
    if (message.failed()) {
        const bool is_known =
            message.error_code() >= 0 && message.error_code() <= static_cast<int>(ErrorCode::io_failure);
        page.texels = Error{is_known ? static_cast<ErrorCode>(message.error_code()) : ErrorCode::io_failure,
                            message.error()};
    }
    page.unchanged = message.unchanged();
    page.version = {.history = message.history(),
                    .revision = message.revision(),
                    .scene_revision = message.scene_revision(),
                    .validity = {message.valid_from(), message.valid_until()},
                    .tag = message.tag(),
                    .bound_codes = message.bound_codes()};
    page.wire_bytes = message.wire_bytes();
    page.retry_ms = message.retry_ms();
    return page;
}

}  // namespace

RecordingSource::RecordingSource(PageSource& source)
    : source_{source}, frame_{std::make_unique<view::SourceFrame>()} {}
RecordingSource::~RecordingSource() = default;

bool RecordingSource::request(const PageRequest& request) {
    const bool is_taken = source_.request(request);
    if (!is_taken) frame_->add_refused(frame_->requests());
    frame_->set_requests(frame_->requests() + 1);
    asked_.push_back(name_of(request));
    return is_taken;
}

std::vector<ArrivedPage> RecordingSource::take_arrived(std::size_t most) {
    std::vector<ArrivedPage> arrived = source_.take_arrived(most);
    view::Arrivals& batch = *frame_->add_arrivals();
    for (const ArrivedPage& page : arrived) write_arrival(page, *batch.add_pages());
    return arrived;
}

SceneNews RecordingSource::take_news() {
    SceneNews news = source_.take_news();
    view::RecordedNews& message = *frame_->add_news();
    message.set_history(news.history);
    message.set_told_revision(news.told_revision);
    message.set_unsure_before(news.unsure_before);
    for (const StalePage& stale : news.stale) {
        view::RecordedStalePage& page = *message.add_stale();
        write_key(stale.page, *page.mutable_page());
        page.set_revision(stale.revision);
    }
    return news;
}

view::SourceFrame RecordingSource::take_frame() {
    frame_->set_asked(digest_of(asked_));
    asked_.clear();
    return std::exchange(*frame_, {});
}

PlayedSource::PlayedSource() : frame_{std::make_unique<view::SourceFrame>()} {}
PlayedSource::~PlayedSource() = default;

void PlayedSource::begin_frame(const view::SourceFrame& frame) {
    *frame_ = frame;
    asked_.clear();
    next_news_ = next_arrivals_ = next_refused_ = 0;
}

bool PlayedSource::is_same() const {
    return asked_.size() == frame_->requests() && digest_of(asked_) == frame_->asked() &&
           next_arrivals_ == frame_->arrivals_size() && next_news_ == frame_->news_size();
}

bool PlayedSource::request(const PageRequest& request) {
    const auto index = static_cast<std::uint32_t>(asked_.size());
    asked_.push_back(name_of(request));
    if (next_refused_ >= frame_->refused_size() || frame_->refused(next_refused_) != index) return true;
    ++next_refused_;
    return false;
}

std::vector<ArrivedPage> PlayedSource::take_arrived(std::size_t) {
    std::vector<ArrivedPage> arrived;
    if (next_arrivals_ >= frame_->arrivals_size()) return arrived;
    for (const view::Arrival& page : frame_->arrivals(next_arrivals_++).pages())
        arrived.push_back(read_arrival(page));
    return arrived;
}

SceneNews PlayedSource::take_news() {
    if (next_news_ >= frame_->news_size()) return {};
    const view::RecordedNews& message = frame_->news(next_news_++);
    SceneNews news{.history = message.history(),
                   .told_revision = message.told_revision(),
                   .stale = {},
                   .unsure_before = message.unsure_before()};
    for (const view::RecordedStalePage& page : message.stale())
        news.stale.push_back({read_key(page.page()), page.revision()});
    return news;
}

}  // namespace tessera
