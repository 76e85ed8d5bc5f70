#pragma once

#include <memory>
#include <unordered_map>
#include <vector>

#include "client/link/background_page_client.h"
#include "client/residency/page_source.h"

namespace tessera {

/// Pages without the sprites that a hand has lifted from them, which servers give over HTTP alone. Opens no
/// connection before the first is asked for.
class LiftedPages {
  public:
    LiftedPages(ServerAddress server, SceneInfo scene, ChannelSet channels)
        : server_{std::move(server)},
          scene_{std::move(scene)},
          options_{.format = PageFormat::rgba, .gutter = gutter_texels, .channels = channels} {}

    /// As PageSource's.
    bool request(const PageRequest& request);
    std::vector<ArrivedPage> take_arrived(std::size_t most);
    /// False: no such request is out.
    bool cancel(PageRequestId id);

  private:
    ServerAddress server_;
    SceneInfo scene_;
    FetchOptions options_;
    std::unique_ptr<BackgroundPageClient> client_;
    std::unordered_map<PageRequestId, RequestId> http_ids_;
    std::unordered_map<RequestId, PageRequestId> ids_;
};

}  // namespace tessera
