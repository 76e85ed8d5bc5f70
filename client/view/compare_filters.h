#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "proto/accuracy.pb.h"

#include "client/render/filter.h"
#include "client/view/texture_files.h"
#include "shared/result/result.h"

namespace tessera {

struct CompareJob {
    std::vector<CompareTexture> textures;
    int width = 800;  ///< Pixels of each picture, 16 to 8192
    int height = 700;
    std::filesystem::path folder;  ///< Made if need be
    int rounds = 3;                ///< Frames of each filter that are timed, in turn with the others'
    std::string command;           ///< That makes the report again
};

/// Every filter with the settings that are compared, the driver's own only where it has one.
std::vector<FilterChoice> compared_filters();

/// "line-integral-8", "supersample-4x4", "trilinear", …
std::string label_of(const FilterChoice& filter);

/// Draws the three situations on each texture with every filter, compares them with the true area integrals
/// and writes pictures, differences ×8, maps of the texels read, and report.json. Needs a current context.
/// `progress` hears what is being done. Error: io_failure.
Result<proto::AccuracyReport> compare_filters(const CompareJob& job,
                                              const std::function<void(const std::string&)>& progress);

}  // namespace tessera
