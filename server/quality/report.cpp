#include "server/quality/report.h"

#include <string>
#include <string_view>

#include <unistd.h>

#include "server/scene/whole_file.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

/// A neighbour of `file` that is renamed into its place when both files of the report are there.
fs::path partial_of(const fs::path& file) {
    fs::path made = file;
    made.replace_filename("." + file.filename().string() + ".partial-" + std::to_string(::getpid()));
    return made;
}

Result<void> write_text(const fs::path& file, std::string_view text) {
    return write_whole_file(file, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

Result<void> rename_into_place(const fs::path& made, const fs::path& file) {
    std::error_code failure;
    fs::rename(made, file, failure);
    if (failure) return Error{ErrorCode::io_failure, file.string() + ": " + failure.message()};
    return {};
}

/// Both files, or neither is touched.
Result<void> write_both(const fs::path& html, std::string_view page, std::string_view json) {
    fs::path data = html;
    data.replace_extension(".json");
    const fs::path made_page = partial_of(html), made_data = partial_of(data);
    Result<void> done = write_text(made_data, json);
    if (done) done = write_text(made_page, page);
    if (done) done = rename_into_place(made_data, data);
    if (done) done = rename_into_place(made_page, html);
    std::error_code ignored;
    fs::remove(made_page, ignored);
    fs::remove(made_data, ignored);
    return done;
}

}  // namespace

Result<void> check_report_target(const fs::path& html) {
    const std::string extension = html.extension().string();
    if (extension != ".html" && extension != ".htm")
        return Error{ErrorCode::invalid_input, html.string() + ": a report's name ends in .html"};
    std::error_code failure;
    if (fs::is_directory(html, failure))
        return Error{ErrorCode::invalid_input, html.string() + ": is a folder; name a file in it"};
    const fs::path parent = html.has_parent_path() ? html.parent_path() : fs::path{"."};
    if (!fs::is_directory(parent, failure))
        return Error{ErrorCode::io_failure, parent.string() + ": is not a folder; make it first"};
    return {};
}

Result<void> write_report(const fs::path& html, const ExchangeAsset& asset, Progress& progress) {
    if (auto may = check_report_target(html); !may) return may;
    if (progress.stop().stop_requested())
        return Error{ErrorCode::cancelled, html.string() + ": stopped; nothing was written"};
    const std::string facts = "\"tile_side\": " + std::to_string(asset.tile_side) +
                              ", \"patches\": " + std::to_string(asset.patches.size());
    return write_both(html,
                      "<!doctype html><meta charset=utf-8><title>Tessera</title><pre>" + facts + "</pre>\n",
                      "{" + facts + "}\n");
}

}  // namespace tessera
