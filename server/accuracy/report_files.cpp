#include "server/accuracy/report_files.h"

#include <array>
#include <charconv>
#include <span>

#include "server/accuracy/plot_picture.h"
#include "server/accuracy/report_page.h"
#include "server/files/whole_file.h"
#include "server/pages/page_encoder.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

Result<void> write_text(const fs::path& file, const std::string& text) {
    return write_whole_file(file,
                            std::as_bytes(std::span{text}).empty()
                                ? std::span<const std::uint8_t>{}
                                : std::span{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::string number(double value) {
    std::array<char, 32> digits{};
    const auto end =
        std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 7);
    return {digits.data(), end.ptr};
}

/// Names hold no quotes, but a GL renderer's name may hold commas.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
    return out + '"';
}

}  // namespace

std::string report_csv(const proto::AccuracyReport& report) {
    std::string out =
        "situation,texture,filter,where,mse,psnr,ms_ssim,max_error,texels_per_sample,nanoseconds_per_sample,"
        "frame_milliseconds,truth_mse,mse_linear,bound_codes,pixels,pareto\n";
    for (const proto::AccuracyRow& row : report.rows()) {
        for (const std::string* text : {&row.situation(), &row.texture(), &row.filter(), &row.where()})
            out += quoted(*text) + ",";
        for (const double value :
             {row.mse(), row.psnr(), row.ms_ssim(), row.max_error(), row.texels_per_sample(),
              row.nanoseconds_per_sample(), row.frame_milliseconds(), row.truth_mse(), row.mse_linear(),
              row.bound_codes()})
            out += number(value) + ",";
        out += std::to_string(row.pixels()) + (row.pareto() ? ",1\n" : ",0\n");
    }
    return out;
}

Result<void> write_report_files(const fs::path& folder, const proto::AccuracyReport& report) {
    if (auto done = write_text(folder / "report.json", write_json(report)); !done) return done;
    if (auto done = write_text(folder / "report.csv", report_csv(report)); !done) return done;
    const auto plot = encode_page(draw_plot(report), PageFormat::png);
    if (!plot) return plot.error();
    if (auto done = write_whole_file(folder / "plot.png", *plot); !done) return done;
    return write_text(folder / "index.html", report_page(report));
}

Result<void> check_report_folder(const fs::path& folder) {
    std::error_code failure;
    const auto status = fs::symlink_status(folder, failure);
    if (!fs::exists(status)) return {};
    if (!fs::is_directory(status))
        return Error{ErrorCode::invalid_input, folder.string() + ": is no folder; name another with -o"};
    const bool empty = fs::is_empty(folder, failure);
    if (failure) return Error{ErrorCode::io_failure, folder.string() + ": " + failure.message()};
    if (empty || (fs::exists(folder / "report.json", failure) && fs::exists(folder / "index.html", failure)))
        return {};
    return Error{ErrorCode::invalid_input,
                 folder.string() + ": holds files that are no accuracy report; name another folder with -o"};
}

}  // namespace tessera
