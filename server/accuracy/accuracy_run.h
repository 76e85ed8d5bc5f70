#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "proto/accuracy.pb.h"

#include "server/accuracy/filter_measurement.h"
#include "server/accuracy/measured_texture.h"
#include "server/progress/progress.h"
#include "server/progress/terminal_progress.h"

namespace tessera {

struct AccuracyOptions {
    std::vector<std::string> textures;  ///< Built-in names, scene folders, image files; empty: all built in.
    std::int32_t width = 208, height = 182;  ///< Pixels of the situations. MS-SSIM wants 176 for all scales.
    std::size_t truth_samples = 16384;       ///< A pixel of stored images, where truth is sampled.
    std::size_t scene_truth_samples = 4096;  ///< The same of scenes.
    MeasureOptions measure;
    double scene_picture_seconds = 0.8;   ///< As MeasureOptions::picture_seconds, of scenes.
    bool every_filter_on_scenes = false;  ///< Else one setting of each method, or a few.
    std::size_t threads = 2;
    int most_column_log2 = 22;  ///< Of the stability curves.
    bool pages = true;          ///< The comparisons of pages, too.
    bool pictures = true;
    ImageLimits limits;
    std::filesystem::path gpu_rows;  ///< What `tessera-view --compare-filters` wrote; empty: nothing.
    std::string made_by;             ///< The command line.
};

/// The run's stages and their parts of the time.
std::vector<TerminalProgress::Share> accuracy_shares();

/// Measures everything and writes the pictures into `folder`/pictures. `folder` is there and empty; what the
/// run needs in between is gone from it at the end. Errors name what is wrong with the input; cancelled.
Result<proto::AccuracyReport> run_accuracy(const AccuracyOptions& options,
                                           const std::filesystem::path& folder, Progress& progress);

/// Reads the textures that the options name, or all built-in ones.
Result<std::vector<MeasuredTexture>> measured_textures(const AccuracyOptions& options,
                                                       const std::filesystem::path& workshop,
                                                       Progress& progress);

}  // namespace tessera
