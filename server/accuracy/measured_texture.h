#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "server/accuracy/ground_truth.h"
#include "server/progress/progress.h"
#include "server/scene/image_file.h"

namespace tessera {

/// A texture on which filters are compared.
struct MeasuredTexture {
    std::string name;                          ///< What reports call it, and what its files are named after.
    std::string title;                         ///< For people.
    std::shared_ptr<const LinearImage> image;  ///< Stored: what filters read; null where it is a plan.
    std::shared_ptr<const Texture> texture;    ///< A plan, evaluated page by page; null where it is stored.
    std::shared_ptr<const TwoColorPattern> pattern;  ///< Where the truth can be written down.

    TruthSource truth() const { return {pattern, image, texture}; }
};

/// What a report measures that is told nothing: "photograph", "checker", "text", "content-exchange",
/// "patterns".
const std::vector<std::string_view>& built_in_texture_names();

/// A board of 32-texel squares, black and white, on 512² texels.
MeasuredTexture checker_texture();
/// Lines of small letters, dark on light, on 1024² texels: strokes two texels wide.
MeasuredTexture text_texture();
/// Painted pebbles on 1024² texels, as many of them as were painted before `stop`.
MeasuredTexture photograph_texture(const std::stop_token& stop);
/// One colour.
MeasuredTexture constant_texture();

/// Makes one of built_in_texture_names(). Scenes are made small: by content exchange from painted pebbles,
/// and of pattern blocks, the latter by way of files in `workshop`, a folder. Errors: cancelled, io_failure.
Result<MeasuredTexture> built_in_texture(std::string_view name, const std::filesystem::path& workshop,
                                         Progress& progress);

/// The painted scene of this name (pattern_scenes.h), by way of files in `workshop`.
Result<MeasuredTexture> painted_scene(std::string_view name, const std::filesystem::path& workshop);

/// A scene's folder, or a PNG, JPEG, WebP or TIFF, repeated. Errors name the file.
Result<MeasuredTexture> read_texture(const std::filesystem::path& path, const ImageLimits& limits);

/// The texture of a report called `name`, of letters, digits, '-', '_' and '.'; the rest is replaced.
std::string texture_name_of(std::string_view name);

}  // namespace tessera
