#include "client/view/lifted_pages.h"

namespace tessera {

bool LiftedPages::request(const PageRequest& request) {
    if (!client_) {
        PageClientSettings settings;
        settings.connections = 2;
        settings.attempts = 2;
        client_ = std::make_unique<BackgroundPageClient>(server_, scene_, settings);
    }
    FetchOptions options = options_;
    options.without = request.without;
    options.step = request.step;
    const auto id = client_->request(request.page, options);
    if (!id) return false;
    http_ids_[request.id] = *id;
    ids_[*id] = request.id;
    return true;
}

bool LiftedPages::cancel(PageRequestId id) {
    const auto found = http_ids_.find(id);
    if (found == http_ids_.end()) return false;
    client_->cancel(found->second);
    return true;
}

std::vector<ArrivedPage> LiftedPages::take_arrived(std::size_t most) {
    std::vector<ArrivedPage> arrived;
    if (!client_) return arrived;
    for (FinishedPage& finished : client_->take_finished(most)) {
        const auto found = ids_.find(finished.id);
        if (found == ids_.end()) continue;
        ArrivedPage page{.id = found->second, .page = finished.page, .texels = std::string{}};
        http_ids_.erase(found->second);
        ids_.erase(found);
        if (finished.result)
            page.texels = std::move(finished.result->bytes);
        else
            page.texels = finished.result.error();
        arrived.push_back(std::move(page));
    }
    return arrived;
}

}  // namespace tessera
