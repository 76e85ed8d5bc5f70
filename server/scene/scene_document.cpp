#include "server/scene/scene_document.h"

#include <algorithm>

#include "proto/scene.pb.h"

#include "server/pattern/pattern_kept.h"
#include "server/pattern/pattern_texture.h"
#include "server/scene/compile_pattern.h"
#include "server/scene/compile_scene.h"
#include "server/scene/kept_files.h"
#include "server/scene/scene.h"

namespace tessera {

namespace {

std::shared_ptr<const proto::Scene> without_sprites(const proto::Scene& message) {
    // There may be very many
    auto kept = std::make_shared<proto::Scene>();
    *kept->mutable_title() = message.title();
    kept->set_extent_log2_pages(message.extent_log2_pages());
    kept->set_attribution(message.attribution());
    if (message.has_view()) *kept->mutable_view() = message.view();
    if (message.has_constant()) *kept->mutable_constant() = message.constant();
    if (message.has_checker()) *kept->mutable_checker() = message.checker();
    if (message.has_content_exchange()) *kept->mutable_content_exchange() = message.content_exchange();
    if (message.has_interchange()) *kept->mutable_interchange() = message.interchange();
    if (message.has_wang()) *kept->mutable_wang() = message.wang();
    if (message.has_pattern()) *kept->mutable_pattern() = message.pattern();
    if (message.has_clock()) *kept->mutable_clock() = message.clock();
    *kept->mutable_targets() = message.targets();
    return kept;
}

}  // namespace

SceneDocument::SceneDocument(std::filesystem::path folder, const proto::Scene& message)
    : folder_{std::move(folder)},
      message_{without_sprites(message)},
      files_{std::make_unique<KeptFiles>(folder_)},
      kept_{std::make_unique<PatternKept>()} {}

SceneDocument::~SceneDocument() = default;

Result<Plan> SceneDocument::plan(const proto::Scene& message, const PaintedMaps& painted) const {
    EditedFiles files{*files_, painted};
    return plan_pattern(message.pattern(), files);
}

Result<void> SceneDocument::compile(const proto::Scene& message, const PaintedMaps& painted,
                                    Scene& scene) const {
    EditedFiles files{*files_, painted};
    return compile_ground(folder_, folder_ / "scene.json", message, files, kept_.get(), scene);
}

bool takes_edits(const proto::Scene& message, const Scene& scene) {
    const auto& blocks = message.pattern().blocks();
    return message.has_sprites() || scene.animated || message.targets_size() > 0 ||
           std::any_of(blocks.begin(), blocks.end(), [](const proto::Block& block) {
               return block.editable_size() > 0 || block.animation_map().has_target_distance();
           });
}

}  // namespace tessera
