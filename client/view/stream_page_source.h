#pragma once

#include <memory>
#include <string>

#include "client/view/view_source.h"
#include "shared/page/accuracy.h"
#include "shared/page/channel_set.h"

namespace tessera {

struct SceneInfo;
struct ServerAddress;
class BackgroundStreamClient;
class LiftedPages;

/// The pages of a scene over its stream: told of what edits make stale, on the scene's own clock, connected
/// again by itself.
class StreamPageSource final : public ViewSource {
  public:
    StreamPageSource(const ServerAddress& server, const SceneInfo& scene, ChannelSet channels,
                     const std::string& name, const std::string& token = {},
                     Accuracy accuracy = Accuracy::high);
    ~StreamPageSource() override;

    bool request(const PageRequest& request) override;
    void cancel(PageRequestId id) override;
    std::vector<ArrivedPage> take_arrived(std::size_t most) override;
    void allow(std::size_t answers) override;
    void watch(std::span<const PageWindow> windows, std::uint64_t seen_revision) override;
    SceneNews take_news() override;

    void wait(std::chrono::milliseconds timeout) override;
    std::uint64_t bytes_received() const override;
    State state() const override;
    SceneTime scene_time() const override;
    BackgroundStreamClient* stream() override { return client_.get(); }

  private:
    std::unique_ptr<BackgroundStreamClient> client_;
    std::unique_ptr<LiftedPages> lifted_;
};

/// The same windows, each no larger than what lets all of them have at most `most` pages: those around the
/// middles stay.
std::vector<PageWindow> windows_within(std::span<const PageWindow> windows, std::uint64_t most);

}  // namespace tessera
