#pragma once

#include <string>
#include <vector>

#include "proto/accuracy.pb.h"

#include "server/accuracy/filter_measurement.h"

namespace tessera {

/// What the pictures of a view on a texture are called, in the report's folder.
struct PictureNames {
    std::string stem;  ///< "pictures/corridor-text"; empty: there are none.

    PictureNames() = default;
    PictureNames(const View& view, const std::string& texture)
        : stem{"pictures/" + std::string{view.situation.name} + "-" + texture} {}
    std::string truth() const { return stem + "-truth.png"; }
    std::string result(const std::string& filter) const { return stem + "-" + filter + ".png"; }
    std::string error(const std::string& filter) const { return stem + "-" + filter + "-error.png"; }
    std::string texels(const std::string& filter) const { return stem + "-" + filter + "-texels.png"; }
};

inline constexpr const char* on_cpu = "cpu";

/// Adds a row for each measurement, and marks the Pareto front among them.
void add_rows(const View& view, const std::string& texture, const GroundTruth& truth,
              const std::vector<FilterMeasurement>& measured, const PictureNames& names,
              proto::AccuracyReport& report);

}  // namespace tessera
