#pragma once

#include <memory>
#include <optional>
#include <string>

#include "client/render/page_identity.h"
#include "client/view/frame_painter.h"
#include "client/view/metrics/metrics_file.h"
#include "client/view/metrics/session_metrics.h"
#include "client/view/record/session_recorder.h"
#include "client/view/session_log_options.h"
#include "client/view/view_source.h"

namespace tessera {

/// Figures and recording of a session: fed by the window and by headless runs alike.
class SessionLog {
  public:
    /// Error: io_failure (a file cannot be written).
    static Result<std::unique_ptr<SessionLog>> open(const SessionLogOptions& options);

    /// Before the scene is made, and with a current context: the source to make it with.
    PageSource& begin(const std::string& scene, Extent extent, PageSource& source,
                      const ResidencySettings& settings);
    PageSource& begin_second(PageSource& source, const ResidencySettings& settings);
    void end_second();
    /// All caches have so many slots from the next frame on.
    void resized(std::size_t slots);
    void pattern(std::int32_t pattern, const Rgba8Image& image, double side_texels);

    /// What a frame took, and what the link says meanwhile.
    struct Costs {
        double frame_ms = 0;  ///< Since the frame before; 0: unknown
        double work_ms = 0;
        std::uint64_t bytes_received = 0;
        ViewSource::State link{};
    };
    /// After each FramePainter::update().
    void updated(const ViewFrame& frame);
    /// After the frame was drawn, if it was. `target` is read if hashes are wanted.
    void drawn(const FrameTarget& target);
    /// The same, where the hash is known anyway.
    void drawn(std::uint64_t hash);
    /// Once a frame, at its end.
    void measured(const ViewFrame& frame, const ResidencyFrame& outcome, const FramePainter& painter,
                  const Costs& costs);

    /// The last line, and the files' ends. Returns what went wrong with them, for people; empty: nothing.
    std::string end();

    const SessionMetrics& metrics() const { return metrics_; }

  private:
    explicit SessionLog(const SessionLogOptions& options) : options_{options} {}

    SessionLogOptions options_;
    SessionMetrics metrics_;
    std::optional<MetricsFile> file_;
    std::unique_ptr<SessionRecorder> recorder_;
    PageIdentity identity_;
    std::size_t known_slots_ = 0;
    std::optional<ClientTime> next_check_, next_line_;
    std::string trouble_;
};

}  // namespace tessera
