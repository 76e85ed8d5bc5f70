#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "proto/scene.pb.h"

namespace tessera {

/// Raise it whenever a painter, a scene below or of moving_scenes.h, or an opening view says something else:
/// samples that an earlier version painted are made again. A test holds it to what is painted.
inline constexpr std::uint32_t painting_version = 3;

/// The case studies of Lefebvre & Neyret, section 4, as scenes: names of samples.
const std::vector<std::string_view>& pattern_scene_names();

struct PaintedFile {
    std::string name;  ///< Inside the scene's folder.
    std::vector<std::uint8_t> bytes;
};

/// A scene of pattern blocks with the images that it names.
struct PaintedScene {
    proto::Scene scene;  ///< Without title and attribution.
    std::vector<PaintedFile> files;
    bool on_pebbles = false;  ///< Its ground is the prepared pebbles: a folder `asset` beside its files.
};

/// Paints one of pattern_scene_names(). The same bytes on every machine: integers, +, −, ×, ÷ and square
/// roots only.
PaintedScene paint_pattern_scene(std::string_view name);

}  // namespace tessera
