#pragma once

#include <memory>
#include <vector>

#include "proto/edit.pb.h"
#include "proto/scene.pb.h"

#include "server/journal/journal.h"
#include "server/scene/scene.h"
#include "server/scene/scene_document.h"
#include "shared/motion/scene_clock.h"
#include "shared/page/texel_box.h"

namespace tessera {

/// What a scene's file says, as edits left it: a value, copied before it is changed. Its sprites are in the
/// SpriteBook.
struct LiveDocument {
    std::shared_ptr<const SceneDocument> source;  ///< Null: only sprites can be edited.
    std::shared_ptr<const proto::Scene> message;  ///< Without sprites, and with painted maps as they were.
    PaintedMaps painted;
    std::shared_ptr<const std::vector<EditableMap>> maps;  ///< Of `message`; null: none.
    Extent extent;
    SceneClock clock;
    bool settled = true;     ///< `message` and `painted` were planned.
    bool maps_known = true;  ///< `maps` is that of `message`.
    bool edited = false;     ///< `message` or `painted` are not as the file says.

    /// Of a loaded scene. Its clock shows step 0 at `now`.
    static LiveDocument of(const Scene& scene, SceneClock::Time now);

    /// The message with painted maps as their blocks' values.
    proto::Scene whole_message() const;
    /// As a snapshot kept it. Error: invalid_input, if its blocks cannot be compiled any more.
    Result<void> restore(const proto::Scene& whole);

    /// Whether the textures of the two are made of the same: targets and clock apart.
    bool same_ground(const LiveDocument& other) const;
};

/// When an edit was accepted, and which step the scene showed.
struct EditInstant {
    SceneClock::Time at{};
    Step step = 0;
};

/// What an edit's changes of anything but sprites did.
struct DocumentEdit {
    std::vector<proto::Change> inverses;  ///< In the order that undoes them.
    std::vector<TexelBox> dirty;
    std::vector<proto::Effect> effects;
};

/// Of the whole scene, on behalf of one edit whose paint follows what it set. Each takes a tenth of a second
/// or so.
inline constexpr int max_plans_of_edit = 32;

/// Whether an edit is followed by a plan of the scene, which says whether it can be shown. A replay of edits
/// that were planned once needs a plan where paint looks at maps, and one behind the last.
enum class Planning : std::uint8_t {
    now,
    in_time,  ///< The same, but no more plans after most_planning_seconds: before an edit is accepted, never
              ///< behind.
    later,
};

/// Of a thread's time, after which an edit gets no further plan: it holds up all edits of blocks.
inline constexpr double most_planning_seconds = 1;

/// Makes all of an edit's changes that are not of sprites, or none. The same edit at the same instant on the
/// same document gives the same document. Error: invalid_input; the message names the change and what is
/// wrong.
Result<DocumentEdit> apply_to_document(const proto::Edit& edit, const EditInstant& instant,
                                       LiveDocument& document, Planning planning = Planning::now,
                                       double planning_seconds = most_planning_seconds);

/// Whether it changes anything but sprites.
bool changes_document(const proto::Edit& edit);

/// Whether the scene has to be planned anew before its maps are looked at again; and whether it looks at
/// them.
bool unsettles_scene(const proto::Edit& edit);
bool looks_at_maps(const proto::Edit& edit);

/// What is wrong with changes[i]: "changes[3].paint_map.block: …", "changes[3].place_sprite: there is …".
Error error_of_change(int i, const proto::Change& change, const Error& error);

// One for each kind of change. `inverse` is what undoes it.
Result<void> paint_map(const proto::MapPaint& paint, LiveDocument& document, proto::Change& inverse,
                       std::vector<TexelBox>& dirty);
Result<void> set_parameter(const proto::ParameterChange& change, LiveDocument& document,
                           proto::Change& inverse, std::vector<TexelBox>& dirty);
Result<void> change_animation(const proto::AnimationChange& change, const EditInstant& instant,
                              LiveDocument& document, proto::Change& inverse, DocumentEdit& edit);
Result<void> set_target(const proto::Target& target, LiveDocument& document, proto::Change& inverse,
                        std::vector<TexelBox>& dirty);
Result<void> remove_target(std::uint64_t id, LiveDocument& document, proto::Change& inverse,
                           std::vector<TexelBox>& dirty);
Result<void> set_clock(const proto::ClockChange& change, const EditInstant& instant, LiveDocument& document,
                       proto::Change& inverse);

/// The block of that name; null: none. `message` is changed then.
proto::Block* find_block(proto::Scene& message, std::string_view name);

/// Compiles the decisions of what was changed, if it was. Error: as of SceneDocument::plan().
Result<void> settle(LiveDocument& document);

}  // namespace tessera
