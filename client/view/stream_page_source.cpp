#include "client/view/stream_page_source.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "client/link/background_stream_client.h"
#include "client/link/scene_info.h"
#include "client/view/lifted_pages.h"

namespace tessera {
namespace {

constexpr std::uint64_t most_window_pages = 65536;  // what servers let a client watch

StreamSettings stream_settings(ChannelSet channels, const std::string& name, const std::string& token,
                               Accuracy accuracy) {
    StreamSettings settings;
    settings.name = name;
    settings.token = token;
    settings.wants_presence = settings.wants_edits = true;
    settings.options = {
        .format = PageFormat::rgba, .gutter = gutter_texels, .accuracy = accuracy, .channels = channels};
    return settings;
}

}  // namespace

StreamPageSource::StreamPageSource(const ServerAddress& server, const SceneInfo& scene, ChannelSet channels,
                                   const std::string& name, const std::string& token, Accuracy accuracy)
    : client_{std::make_unique<BackgroundStreamClient>(server, scene.id,
                                                       stream_settings(channels, name, token, accuracy))},
      lifted_{std::make_unique<LiftedPages>(server, scene, channels)} {}

StreamPageSource::~StreamPageSource() = default;

bool StreamPageSource::request(const PageRequest& request) {
    if (!request.without.empty()) return lifted_->request(request);
    return client_->ask({.id = request.id,
                         .page = request.page,
                         .step = request.step,
                         .least_revision = request.least_revision,
                         .urgency = static_cast<std::uint32_t>(request.urgency),
                         .have = request.have});
}

void StreamPageSource::cancel(PageRequestId id) {
    if (!lifted_->cancel(id)) client_->cancel(id);
}

std::vector<ArrivedPage> StreamPageSource::take_arrived(std::size_t most) {
    std::vector<ArrivedPage> arrived = lifted_->take_arrived(most);
    most -= arrived.size();
    for (auto& [page, history] : client_->take_pages(most)) {
        PageVersion version{.history = history,
                            .revision = page.revision,
                            .scene_revision = page.scene_revision,
                            .validity = page.validity,
                            .tag = std::move(page.tag),
                            .bound_codes = page.bound_codes};
        arrived.push_back({.id = page.id,
                           .page = page.page,
                           .texels = std::move(page.texels),
                           .unchanged = page.unchanged,
                           .version = std::move(version),
                           .wire_bytes = page.wire_bytes,
                           .retry_ms = page.retry_ms});
    }
    return arrived;
}

void StreamPageSource::allow(std::size_t answers) {
    client_->allow(static_cast<std::uint32_t>(std::min<std::size_t>(answers, 1024)));
}

std::vector<PageWindow> windows_within(std::span<const PageWindow> windows, std::uint64_t most) {
    const auto clipped = [&](std::uint32_t side) {
        std::vector<PageWindow> all;
        for (const PageWindow& window : windows) {
            PageWindow part = window;
            const auto clip = [&](std::uint32_t& low, std::uint32_t& high) {
                if (high - low <= side) return;
                low += (high - low - side) / 2;
                high = low + side;
            };
            clip(part.left, part.right);
            clip(part.top, part.bottom);
            all.push_back(part);
        }
        return all;
    };
    const auto pages = [](const std::vector<PageWindow>& all) {
        std::uint64_t sum = 0;
        for (const PageWindow& window : all)
            sum += std::uint64_t{window.right - window.left} * (window.bottom - window.top);
        return sum;
    };
    constexpr std::uint32_t widest = 4096;
    std::vector<PageWindow> all = clipped(widest);
    for (std::uint32_t side = 128; pages(all) > most && side > 0; side -= side > 32 ? 16 : 4)
        all = clipped(side);
    return all;
}

void StreamPageSource::watch(std::span<const PageWindow> windows, std::uint64_t seen_revision) {
    std::vector<proto::Window> told;
    for (const PageWindow& window : windows_within(windows, most_window_pages)) {
        proto::Window& one = told.emplace_back();
        one.set_level(window.level);
        one.set_x0(window.left);
        one.set_y0(window.top);
        one.set_x1(window.right);
        one.set_y1(window.bottom);
    }
    client_->watch(std::move(told), seen_revision);
}

SceneNews StreamPageSource::take_news() {
    StreamNews heard = client_->take_news();
    SceneNews news{.history = heard.history,
                   .told_revision = heard.told_revision,
                   .stale = {},
                   .unsure_before = heard.unsure_before};
    news.stale.reserve(heard.stale.size());
    for (const StalePageNews& stale : heard.stale) news.stale.push_back({stale.page, stale.revision});
    return news;
}

void StreamPageSource::wait(std::chrono::milliseconds timeout) { client_->wait_for_news(timeout); }

std::uint64_t StreamPageSource::bytes_received() const { return client_->status().statistics.bytes_received; }

ViewSource::State StreamPageSource::state() const {
    const StreamStatus status = client_->status();
    State state;
    state.is_live = status.open;
    state.last_loss = status.last_loss;
    state.others = client_->people().size();
    state.revision = client_->newest_revision();
    state.round_trip_ms = static_cast<double>(status.statistics.round_trip.count()) / 1000;
    if (!status.open && !status.trouble.empty()) {
        char when[48];
        std::snprintf(when, sizeof when, "; trying again in %.1f s",
                      static_cast<double>(status.retry_in.count()) / 1000);
        state.trouble = status.trouble + when;
    }
    return state;
}

ViewSource::SceneTime StreamPageSource::scene_time() const {
    const auto clock = client_->clock();
    if (!clock) return {};
    return {clock->read(BackgroundStreamClient::clock_time()).step,
            clock->playing ? clock->steps_per_second : 0};
}

}  // namespace tessera
