#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include <prometheus/registry.h>

#include "server/access/access.h"
#include "server/edits/edit_service.h"
#include "server/http/address.h"
#include "server/http/answer.h"
#include "server/http/request_head.h"
#include "server/http/web_files.h"
#include "server/pages/page_service.h"
#include "server/sampling/sample_service.h"
#include "server/scene/scene.h"

namespace tessera {

/// What is served at one moment: replaced as a whole by a reload, never changed.
struct Site {
    std::shared_ptr<const Catalog> catalog;  ///< Null while the scenes are loading.
    std::shared_ptr<const WebFiles> web;
    std::shared_ptr<const Access> access = std::make_shared<const Access>();
    bool draining = false;
};

/// A page that has to be waited for.
struct PendingPage {
    PageRequest request;
    bool pinned = false;          ///< Asked for by its immutable address.
    std::string if_none_match{};  ///< What its entity tag, not known yet, is to be held against.
};

/// Samples that are asked for by a body, which has to be read first.
struct PendingSample {
    SampleCall call;  ///< Without its body.
};

/// An edit whose body has to be read first.
struct PendingEdit {
    std::string scene;
    WireCoding coding{};  ///< Of the body.
    WireCoding answer_coding{};
    Access::Decision allowed{};
};

/// A stream that may be opened: its address, Origin and handshake are checked.
struct PendingStream {
    std::string scene;
    bool edits_without_token = false;
    std::string token;
};

/// Request -> answer, or the page that will be it. Pure but for counters and the cache: no sockets, nothing
/// that blocks. May be called from any thread.
class Routes {
  public:
    /// All outlive this.
    Routes(PageService& pages, SampleService& samples, EditService& edits, prometheus::Registry& registry)
        : pages_{pages}, samples_{samples}, edits_{edits}, registry_{registry} {}

    using Outcome = std::variant<Answer, PendingPage, PendingSample, PendingEdit, PendingStream>;
    Outcome route(const RequestHead& request, const Site& site);

    /// The answer that a page is; `from_cache` is for Server-Timing alone.
    static Answer page_answer(const PagePtr& page, bool pinned, bool from_cache);
    /// The answer to one that had to be waited for.
    static Answer page_answer(const PagePtr& page, const PendingPage& pending);

    /// Takes the reply's body.
    static Answer sample_answer(SampleReply& reply);

    /// An edit's longest body; more is 413.
    static constexpr std::size_t max_edit_bytes = std::size_t{256} << 10;

    /// The edit in a body, or the answer that says what is wrong with it.
    static Result<proto::Edit> read_edit(const std::string& body, const PendingEdit& pending);
    static Answer edit_answer(const EditOutcome& outcome, WireCoding coding);

  private:
    Outcome edit(const RequestHead& request, const Scene& scene, const Access& access);
    static Outcome stream(const RequestHead& request, const Scene& scene);
    Outcome sample(const RequestHead& request, const ScenePtr& scene);
    /// …/sprites, …/patterns/{index}.png and …/without-{sprite},{sprite}/{z}/{x}/{y}.{format}: what an editor
    /// draws with.
    static bool is_sprite_address(const std::vector<std::string>& segments) noexcept;
    Outcome sprites(const RequestHead& request, const ScenePtr& scene, std::vector<std::string> segments);
    static Answer sprite_list(const RequestHead& request, const Scene& scene);
    static Answer page_not_modified(PageId id, const PageOptions& options, bool pinned);
    Outcome page(const RequestHead& request, const Site& site, const std::vector<std::string>& segments);
    Answer scene_list(const RequestHead& request, const Catalog& catalog);
    Answer tile_json(const RequestHead& request, const Scene& scene);
    Answer readiness(const Site& site);
    Answer metrics();
    Answer web_file(const RequestHead& request, const Site& site, const std::vector<std::string>& segments);

    PageService& pages_;
    SampleService& samples_;
    EditService& edits_;
    prometheus::Registry& registry_;
};

}  // namespace tessera
