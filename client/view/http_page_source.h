#pragma once

#include <chrono>
#include <unordered_map>

#include "client/link/background_page_client.h"
#include "client/view/view_source.h"

namespace tessera {

/// The pages of a scene over HTTP, raw, with the gutter the cache needs.
class HttpPageSource final : public ViewSource {
  public:
    /// `scene` has these channels, and gives raw pages with a gutter of gutter_texels; see check_scene().
    HttpPageSource(const ServerAddress& server, const SceneInfo& scene, ChannelSet channels,
                   std::size_t connections, Accuracy accuracy = Accuracy::high);

    bool request(const PageRequest& request) override;
    void cancel(PageRequestId id) override;
    std::vector<ArrivedPage> take_arrived(std::size_t most) override;

    void wait(std::chrono::milliseconds timeout) override;
    std::uint64_t bytes_received() const override { return client_.statistics().bytes_received; }

  private:
    BackgroundPageClient client_;
    FetchOptions options_;
    std::unordered_map<PageRequestId, RequestId> http_ids_;
    std::unordered_map<RequestId, PageRequestId> ids_;
};

/// Whether the server gives what this client needs. Error: invalid_input.
Result<void> check_scene(const SceneInfo& scene);

}  // namespace tessera
