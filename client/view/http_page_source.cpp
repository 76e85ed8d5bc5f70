#include "client/view/http_page_source.h"

#include <algorithm>

namespace tessera {
namespace {

PageClientSettings client_settings(std::size_t connections) {
    PageClientSettings settings;
    settings.connections = connections;
    settings.attempts = 2;  // residency backs off by itself, and asks for what is wanted by then
    return settings;
}

}  // namespace

HttpPageSource::HttpPageSource(const ServerAddress& server, const SceneInfo& scene, ChannelSet channels,
                               std::size_t connections, Accuracy accuracy)
    : client_{server, scene, client_settings(connections)},
      options_{
          .format = PageFormat::rgba, .gutter = gutter_texels, .accuracy = accuracy, .channels = channels} {}

bool HttpPageSource::request(const PageRequest& request) {
    FetchOptions options = options_;
    options.step = request.step;
    const auto id = client_.request(request.page, options);
    if (!id) return false;
    http_ids_[request.id] = *id;
    ids_[*id] = request.id;
    return true;
}

void HttpPageSource::cancel(PageRequestId id) {
    if (const auto found = http_ids_.find(id); found != http_ids_.end()) client_.cancel(found->second);
}

std::vector<ArrivedPage> HttpPageSource::take_arrived(std::size_t most) {
    std::vector<ArrivedPage> arrived;
    for (FinishedPage& finished : client_.take_finished(most)) {
        const auto found = ids_.find(finished.id);
        if (found == ids_.end()) continue;
        ArrivedPage page{.id = found->second, .page = finished.page, .texels = std::string{}};
        http_ids_.erase(found->second);
        ids_.erase(found);
        if (finished.result) {
            page.wire_bytes = finished.result->bytes.size();
            page.version.tag = std::move(finished.result->etag);
            page.texels = std::move(finished.result->bytes);
        } else {
            page.texels = finished.result.error();
        }
        arrived.push_back(std::move(page));
    }
    return arrived;
}

void HttpPageSource::wait(std::chrono::milliseconds timeout) { client_.wait_for_finished(timeout); }

Result<void> check_scene(const SceneInfo& scene) {
    if (scene.max_gutter < gutter_texels)
        return Error{ErrorCode::invalid_input, "scene " + scene.id + ": the server gives a gutter of " +
                                                   std::to_string(scene.max_gutter) + " texels, and " +
                                                   std::to_string(gutter_texels) + " are needed"};
    if (std::ranges::find(scene.formats, "rgba") == scene.formats.end())
        return Error{ErrorCode::invalid_input,
                     "scene " + scene.id + ": the server gives no raw (rgba) pages"};
    return {};
}

}  // namespace tessera
