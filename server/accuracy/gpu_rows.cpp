#include "server/accuracy/gpu_rows.h"

#include <cmath>
#include <map>
#include <tuple>

#include "server/accuracy/filter_measurement.h"
#include "server/accuracy/measured_texture.h"
#include "server/accuracy/report_rows.h"
#include "server/files/whole_file.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t max_report_bytes = std::int64_t{64} << 20;
constexpr int max_rows = 10'000;

std::string lacks(const proto::AccuracyRow& row) {
    if (row.situation().empty()) return "has no situation";
    if (row.texture().empty()) return "has no texture";
    if (row.filter().empty()) return "has no filter";
    if (row.where().empty() || row.where() == on_cpu) return "says not where; name the GL renderer";
    for (const double number : {row.mse(), row.ms_ssim(), row.frame_milliseconds(), row.texels_per_sample()})
        if (!std::isfinite(number) || number < 0) return "has a figure that is negative or not a number";
    return {};
}

/// Copies a picture under a name of ours; what is not there is left out.
std::string copied(const std::string& name, const fs::path& beside, const fs::path& pictures, int number) {
    const fs::path relative{name};
    if (name.empty() || relative.is_absolute() || relative.extension() != ".png") return {};
    for (const fs::path& part : relative)
        if (part == "..") return {};
    const std::string target =
        "gpu-" + std::to_string(number) + "-" + texture_name_of(relative.filename().string());
    std::error_code failure;
    fs::copy_file(beside / relative, pictures / target, fs::copy_options::overwrite_existing, failure);
    return failure ? std::string{} : "pictures/" + target;
}

}  // namespace

Result<proto::AccuracyReport> read_gpu_rows(const fs::path& file) {
    const auto text = read_whole_file(file, max_report_bytes);
    if (!text) return text.error();
    proto::AccuracyReport gpu;
    if (const auto read = read_json_leniently(*text, file.string(), gpu); !read) return read.error();
    if (gpu.rows_size() == 0 || gpu.rows_size() > max_rows)
        return Error{ErrorCode::invalid_input,
                     file.string() + ": rows: has " + std::to_string(gpu.rows_size()) +
                         "; write it with tessera-view --headless --compare-filters"};
    for (int i = 0; i < gpu.rows_size(); ++i)
        if (const std::string what = lacks(gpu.rows(i)); !what.empty())
            return Error{ErrorCode::invalid_input,
                         file.string() + ": rows[" + std::to_string(i) + "]: " + what};
    return gpu;
}

Result<void> add_gpu_rows(proto::AccuracyReport gpu, const fs::path& file, const fs::path& pictures,
                          proto::AccuracyReport& report) {
    std::map<std::tuple<std::string, std::string, std::string>, std::vector<proto::AccuracyRow*>> groups;
    int number = 0;
    for (proto::AccuracyRow& row : *gpu.mutable_rows()) {
        for (auto* const name :
             {row.mutable_picture(), row.mutable_error_picture(), row.mutable_count_picture()})
            *name = copied(*name, file.parent_path(), pictures, number++);
        groups[{row.situation(), row.texture(), row.where()}].push_back(&row);
    }
    for (auto& [group, rows] : groups) {
        std::vector<double> times, errors;
        for (const auto* row : rows) {
            times.push_back(row->frame_milliseconds());
            errors.push_back(row->mse());
        }
        const std::vector<bool> front = pareto_front(times, errors);
        for (std::size_t i = 0; i < rows.size(); ++i) rows[i]->set_pareto(front[i]);
    }
    for (proto::AccuracyRow& row : *gpu.mutable_rows()) *report.add_rows() = std::move(row);
    return {};
}

}  // namespace tessera
