#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/blocks/editable_map.h"
#include "shared/result/result.h"

namespace tessera {

struct Scene;
struct Plan;
struct PatternKept;
class KeptFiles;
namespace proto {
class Scene;
}

/// Maps that edits painted into, by block: their entries and sides, which take the place of the block's own.
using PaintedMaps = std::map<std::string, StoredMap, std::less<>>;

/// What a scene that takes edits is compiled from: its file's message, and all that was read and decoded for
/// it, so that it is compiled again without reading a file. Immutable but for what it keeps; all members may
/// be called from any thread.
class SceneDocument {
  public:
    /// `folder`/scene.json holds `message`.
    SceneDocument(std::filesystem::path folder, const proto::Scene& message);
    virtual ~SceneDocument();

    /// As the file says, without its sprites.
    const std::shared_ptr<const proto::Scene>& message() const noexcept { return message_; }

    /// Checks and compiles the decisions of `message`'s blocks. Its texture is a pattern. Error:
    /// invalid_input, io_failure; the message starts with the field's path.
    Result<Plan> plan(const proto::Scene& message, const PaintedMaps& painted) const;

    /// Everything of a scene but its sprites and its names: texture, what moves, clock, editable_maps.
    /// Errors: as of load_scene().
    virtual Result<void> compile(const proto::Scene& message, const PaintedMaps& painted, Scene& scene) const;

  private:
    std::filesystem::path folder_;
    std::shared_ptr<const proto::Scene> message_;
    std::unique_ptr<KeptFiles> files_;
    std::unique_ptr<PatternKept> kept_;
};

/// Whether a loaded scene takes edits at all: it has sprites, targets, a clock, or a block with `editable`.
bool takes_edits(const proto::Scene& message, const Scene& scene);

}  // namespace tessera
