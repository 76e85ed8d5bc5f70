#pragma once

#include <filesystem>

#include "proto/accuracy.pb.h"

#include "shared/result/result.h"

namespace tessera {

/// Reads what `tessera-view --headless --compare-filters` wrote. Errors name file and field: io_failure;
/// invalid_input for a row without situation, texture, filter or place, or with the processor's place.
Result<proto::AccuracyReport> read_gpu_rows(const std::filesystem::path& file);

/// Adds its rows, marks the Pareto front among those of one place, and copies the pictures that they name,
/// relative to `file`, into `pictures`. Error: io_failure.
Result<void> add_gpu_rows(proto::AccuracyReport gpu, const std::filesystem::path& file,
                          const std::filesystem::path& pictures, proto::AccuracyReport& report);

}  // namespace tessera
