#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/texture/material.h"
#include "server/texture/texture.h"
#include "shared/motion/scene_clock.h"
#include "shared/page/opening_view.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"
#include "shared/revisions/page_revisions.h"
#include "shared/sprites/positioning_map.h"

namespace tessera {

namespace proto {
class Scene;
}
class SceneDocument;
class SpriteImages;
struct EditableMap;

/// A loaded scene: immutable, shared by everything that answers for it.
struct Scene {
    std::string id;  ///< The folder's name: 1 to 64 of a–z, A–Z, 0–9, '-', '_', '.', not starting with '.'.
    std::string title;
    std::string attribution;
    Extent extent;
    std::optional<OpeningView> view;  ///< As the scene file says; empty: it leaves that to whoever shows it.
    std::uint64_t revision = 0;       ///< Accepted edits so far.
    PageRevisions page_revisions{};   ///< Which of them touched what.
    std::string fingerprint;  ///< 16 hex digits over the scene file, its assets and the evaluator's version.
    std::shared_ptr<const Texture> texture;  ///< The colour: the channel set "albedo".
    std::vector<Channels> channels;          ///< The other sets it has, in the order of ChannelSet.
    /// Slices after which the texture is the same again: 1 without a third dimension, 0 if it never is.
    std::int32_t slices = 1;
    std::shared_ptr<const Texture> ground;  ///< What sprites lie over; null: the scene has none.
    bool ground_animated = false;           ///< Whether it changes with the step by itself.
    /// Whether blocks do, whatever targets there are: with other targets, ground_animated is this, or
    /// moved_by_targets() of with_targets() (server/pattern/targeted_texture.h).
    bool clocked = false;
    std::shared_ptr<const SpriteImages> sprite_images;  ///< What they look like.
    PositioningMap sprites;                             ///< Where they are.
    bool animated = false;                              ///< Whether anything changes with the step.
    std::vector<std::int32_t> parameters;           ///< From which on requests see other frames; see Plan.
    double steps_per_second = 10;                   ///< At which players show it.
    std::int64_t loop_steps = 0;                    ///< After which players begin again at step 0; 0: never.
    std::shared_ptr<const SceneDocument> document;  ///< What edits change; null: it takes none.
    /// What its file says, as edits left it, of a served scene that takes edits of more than sprites.
    std::shared_ptr<const proto::Scene> message{};
    std::shared_ptr<const std::vector<EditableMap>> editable_maps;  ///< Of its pattern; null: none.
    std::optional<SceneClock> clock;  ///< Of a scene that takes edits, as it is served.
    std::string block_list;  ///< Of a pattern, for `tessera check`: a line for each block of the scene file.

    /// The least slice, from 0 on, that looks like this one; the slice itself where none repeats.
    std::int64_t same_slice(std::int64_t slice) const noexcept {
        return slices == 0 ? slice : (slice % slices + slices) % slices;
    }

    /// The step whose pages are those of this one: 0 where nothing moves.
    std::int64_t same_step(std::int64_t step) const noexcept { return animated ? step : 0; }

    /// The least parameter whose pages are those of this one, 0 to 65536: 0 where no request drives anything.
    std::int32_t same_parameter(std::int32_t parameter) const noexcept {
        std::int32_t same = 0;
        for (const std::int32_t from : parameters)
            if (from <= parameter) same = from;
        return same;
    }

    /// Null if the scene has no such set.
    const Texture* texture_of(ChannelSet set) const noexcept {
        if (set == ChannelSet::albedo) return texture.get();
        for (const Channels& other : channels)
            if (other.set == set) return other.texture.get();
        return nullptr;
    }
    /// "albedo, normal, height": for messages.
    std::string channel_names() const {
        std::string names{name_of(ChannelSet::albedo)};
        for (const Channels& other : channels) names.append(", ").append(name_of(other.set));
        return names;
    }
};

using ScenePtr = std::shared_ptr<const Scene>;

/// Whether a scene's folder may have this name.
bool is_scene_id(std::string_view id);

/// Reads `folder`/scene.json and the assets it names, and compiles the texture. Errors: invalid_input,
/// io_failure; the message names file, field and fix.
Result<ScenePtr> load_scene(const std::filesystem::path& folder);

/// A scene that changes while it is served.
class SceneNow {
  public:
    virtual ~SceneNow() = default;
    SceneNow() = default;
    SceneNow(const SceneNow&) = delete;
    SceneNow& operator=(const SceneNow&) = delete;
    /// As it is now, with its revision. Takes no time; from any thread.
    virtual ScenePtr now() const = 0;
};

/// All scenes of a folder of scenes. One broken scene does not stop the others.
struct Catalog {
    struct Problem {
        std::string id;
        std::string message;
        bool passing = false;  ///< Its folder is right: it will be served once those who run it have helped.
    };
    std::map<std::string, ScenePtr, std::less<>> scenes;                         ///< As their folders say.
    std::map<std::string, std::shared_ptr<const SceneNow>, std::less<>> edited;  ///< Those that take edits.
    std::vector<Problem> broken;

    /// The scene as it is now. Null if there is no such scene.
    ScenePtr find(std::string_view id) const;
    /// Why a scene is not served that was to be; null if there is none of that name.
    const Problem* problem_of(std::string_view id) const;
};

/// A scene of a catalog was read, or was found broken.
struct LoadedScene {
    const std::string& id;
    std::chrono::duration<double> time;  ///< That this took.
    std::size_t loaded = 0;              ///< How many are, with this one.
    std::size_t of = 0;
};

/// `folder` holds one folder for each scene; or is itself a scene. Several load at a time; looks at `stop`
/// between scenes. `tell` hears of each scene, from one thread at a time. Errors:
/// io_failure if the folder cannot be read, cancelled.
Result<Catalog> load_catalog(const std::filesystem::path& folder, std::stop_token stop = {},
                             const std::function<void(const LoadedScene&)>& tell = {});

}  // namespace tessera
