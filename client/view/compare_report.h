#pragma once

#include <filesystem>

#include "proto/accuracy.pb.h"

#include "shared/result/result.h"

namespace tessera {

/// Marks the rows on the Pareto front of error against frame time, and says what the project claims of line
/// integrals and whether it holds, row by row.
void judge(proto::AccuracyReport& report);

/// Writes report.json. Error: io_failure.
Result<void> write_report(const std::filesystem::path& folder, const proto::AccuracyReport& report);

/// For a terminal: a line a row, best first within a situation and texture.
std::string table_of(const proto::AccuracyReport& report);

}  // namespace tessera
