#pragma once

#include <filesystem>
#include <string>

#include "proto/accuracy.pb.h"

#include "shared/result/result.h"

namespace tessera {

/// The rows as a table: a line of names, then a line for each row.
std::string report_csv(const proto::AccuracyReport& report);

/// Writes report.json, report.csv, plot.png and index.html beside the pictures in `folder`. Error:
/// io_failure, which names the file.
Result<void> write_report_files(const std::filesystem::path& folder, const proto::AccuracyReport& report);

/// A place for a report: `folder` does not exist, is empty, or holds an earlier report. Errors:
/// invalid_input, io_failure.
Result<void> check_report_folder(const std::filesystem::path& folder);

}  // namespace tessera
