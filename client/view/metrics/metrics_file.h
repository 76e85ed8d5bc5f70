#pragma once

#include <filesystem>
#include <fstream>
#include <optional>

#include "client/residency/credit_window.h"
#include "shared/result/result.h"

namespace tessera {

class SessionMetrics;

/// JSON lines of a session's figures (view.proto's MetricsLine): one a second, or one a frame.
class MetricsFile {
  public:
    /// Error: io_failure (cannot be written).
    static Result<MetricsFile> open(const std::filesystem::path& file, bool every_frame);

    /// After each frame's add(): writes a line if one is due, and begins the next.
    Result<void> frame(SessionMetrics& metrics, ClientTime now);
    /// The frames since the last line.
    Result<void> end(SessionMetrics& metrics);

  private:
    MetricsFile(std::filesystem::path file, bool every_frame, std::ofstream stream)
        : file_{std::move(file)}, every_frame_{every_frame}, stream_{std::move(stream)} {}
    Result<void> write(SessionMetrics& metrics);

    std::filesystem::path file_;
    bool every_frame_;
    std::ofstream stream_;
    std::optional<ClientTime> next_;
    bool has_more_ = false;
};

}  // namespace tessera
