#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include <prometheus/registry.h>

#include "server/http/address.h"
#include "server/http/answer.h"
#include "server/http/request_head.h"
#include "server/http/web_files.h"
#include "server/pages/page_service.h"
#include "server/scene/scene.h"

namespace tessera {

/// What is served at one moment: replaced as a whole by a reload, never changed.
struct Site {
    std::shared_ptr<const Catalog> catalog;  ///< Null while the scenes are loading.
    std::shared_ptr<const WebFiles> web;
    bool draining = false;
};

/// A page that has to be waited for.
struct PendingPage {
    PageRequest request;
    bool pinned = false;  ///< Asked for by its immutable address.
};

/// Request -> answer, or the page that will be it. Pure but for counters and the cache: no sockets, nothing
/// that blocks. May be called from any thread.
class Routes {
  public:
    /// Both outlive this.
    Routes(PageService& pages, prometheus::Registry& registry) : pages_{pages}, registry_{registry} {}

    using Outcome = std::variant<Answer, PendingPage>;
    Outcome route(const RequestHead& request, const Site& site);

    /// The answer that a page is; `from_cache` is for Server-Timing alone.
    static Answer page_answer(const PagePtr& page, bool pinned, bool from_cache);

  private:
    Outcome page(const RequestHead& request, const Site& site, const std::vector<std::string>& segments);
    Answer scene_list(const RequestHead& request, const Catalog& catalog);
    Answer tile_json(const RequestHead& request, const Scene& scene);
    Answer readiness(const Site& site);
    Answer metrics();
    Answer web_file(const RequestHead& request, const Site& site, const std::vector<std::string>& segments);

    PageService& pages_;
    prometheus::Registry& registry_;
};

}  // namespace tessera
