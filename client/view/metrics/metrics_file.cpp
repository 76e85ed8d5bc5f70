#include "client/view/metrics/metrics_file.h"

#include "client/view/metrics/session_metrics.h"
#include "client/view/view.pb.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

constexpr ClientTime between_lines{1000};

}  // namespace

Result<MetricsFile> MetricsFile::open(const std::filesystem::path& file, bool every_frame) {
    std::ofstream stream{file, std::ios::binary | std::ios::trunc};
    if (!stream) return Error{ErrorCode::io_failure, "--metrics: " + file.string() + ": cannot be written"};
    return MetricsFile{file, every_frame, std::move(stream)};
}

Result<void> MetricsFile::frame(SessionMetrics& metrics, ClientTime now) {
    has_more_ = true;
    if (!next_) next_ = now + between_lines;
    if (!every_frame_ && now < *next_) return {};
    next_ = now + between_lines;
    return write(metrics);
}

Result<void> MetricsFile::end(SessionMetrics& metrics) { return has_more_ ? write(metrics) : Result<void>{}; }

Result<void> MetricsFile::write(SessionMetrics& metrics) {
    stream_ << write_json_line(metrics.line()) << std::flush;
    metrics.next_line();
    has_more_ = false;
    if (stream_) return {};
    return Error{ErrorCode::io_failure, "--metrics: " + file_.string() + ": cannot be written any further"};
}

}  // namespace tessera
