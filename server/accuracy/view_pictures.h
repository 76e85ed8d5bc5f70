#pragma once

#include <filesystem>
#include <stop_token>
#include <vector>

#include "server/accuracy/report_rows.h"

namespace tessera {

/// Writes the PNGs that the rows name: the truth, and for each measurement with a picture result, error and
/// texel counts. `folder` is the report's folder of pictures. Errors: io_failure, which names the file;
/// cancelled.
Result<void> write_view_pictures(const std::filesystem::path& folder, const PictureNames& names,
                                 const View& view, const GroundTruth& truth,
                                 const std::vector<FilterMeasurement>& measured, std::size_t threads,
                                 const std::stop_token& stop);

}  // namespace tessera
