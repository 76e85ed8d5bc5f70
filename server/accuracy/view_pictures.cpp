#include "server/accuracy/view_pictures.h"

#include <fstream>
#include <functional>
#include <mutex>
#include <optional>

#include "server/accuracy/row_pictures.h"
#include "server/pages/page_encoder.h"
#include "server/prepare/parallel.h"

namespace tessera {
namespace {

/// Without waiting for the disk: there are a thousand of them.
Result<void> write_file(const std::filesystem::path& file, const EncodedBytes& bytes) {
    std::ofstream out{file, std::ios::binary | std::ios::trunc};
    out.write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
    out.close();
    if (!out) return Error{ErrorCode::io_failure, file.string() + ": cannot be written"};
    return {};
}

}  // namespace

Result<void> write_view_pictures(const std::filesystem::path& folder, const PictureNames& names,
                                 const View& view, const GroundTruth& truth,
                                 const std::vector<FilterMeasurement>& measured, std::size_t threads,
                                 const std::stop_token& stop) {
    struct Job {
        std::string name;
        std::function<Rgba8Image()> draw;
    };
    std::vector<Job> jobs;
    jobs.push_back({names.truth(), [&] { return shown(truth.codes); }});
    for (const FilterMeasurement& one : measured) {
        if (one.picture.codes.empty()) continue;
        jobs.push_back({names.result(one.name), [&] { return shown(one.picture); }});
        jobs.push_back({names.error(one.name), [&] { return shown_error(truth.codes, one.picture); }});
        jobs.push_back({names.texels(one.name), [&] { return shown_counts(view, one); }});
    }
    std::mutex mutex;
    std::optional<Error> failure;
    for_each_index(jobs.size(), threads, [&](std::size_t i) {
        if (stop.stop_requested()) return;
        const auto bytes = encode_page(jobs[i].draw(), PageFormat::png);
        const auto written =
            bytes ? write_file(folder.parent_path() / jobs[i].name, *bytes) : Result<void>{bytes.error()};
        if (written) return;
        const std::scoped_lock lock{mutex};
        if (!failure) failure = written.error();
    });
    if (failure) return *failure;
    if (stop.stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
    return {};
}

}  // namespace tessera
