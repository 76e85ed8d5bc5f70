#include "server/accuracy/commands.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>

#include "server/accuracy/accuracy_run.h"
#include "server/accuracy/exported_textures.h"
#include "server/accuracy/report_files.h"
#include "server/files/whole_file.h"
#include "server/prepare/photo_options.h"
#include "server/progress/interrupt.h"
#include "server/progress/terminal_progress.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

struct Arguments {
    std::vector<std::string> textures;
    std::string folder;
    std::string export_folder;
    std::string gpu_rows;
    std::int32_t width = 0;
    std::size_t samples = 0;
    std::size_t threads = 0;
    std::int64_t max_megapixels = default_megapixels;
    bool thorough = false, quick = false, no_pictures = false, no_pages = false, quiet = false;
};

std::string words_of(const Arguments& arguments) {
    std::string words = "tessera accuracy";
    for (const std::string& texture : arguments.textures) words += " " + texture;
    words += " -o " + arguments.folder;
    if (arguments.thorough) words += " --thorough";
    if (arguments.quick) words += " --quick";
    if (arguments.width != 0) words += " --width " + std::to_string(arguments.width);
    if (arguments.samples != 0) words += " --samples " + std::to_string(arguments.samples);
    if (arguments.no_pictures) words += " --no-pictures";
    if (arguments.no_pages) words += " --no-pages";
    if (!arguments.gpu_rows.empty()) words += " --gpu-rows " + arguments.gpu_rows;
    return words;
}

AccuracyOptions options_of(const Arguments& arguments, const Interrupt& interrupt) {
    AccuracyOptions options;
    options.textures = arguments.textures;
    if (arguments.thorough) {
        options.width = 800;
        options.truth_samples = 65536;
        options.scene_truth_samples = 16384;
        options.measure.rounds = 15;
        options.measure.round_seconds = 0.1;
        options.measure.picture_seconds = options.scene_picture_seconds = 60;
        options.every_filter_on_scenes = true;
        options.most_column_log2 = 26;
    }
    if (arguments.quick) {
        options.width = 64;
        options.truth_samples = options.scene_truth_samples = least_truth_samples;
        options.measure.rounds = 3;
        options.measure.round_seconds = 0.002;
        options.measure.picture_seconds = 0.5;
        options.scene_picture_seconds = 0.1;
        options.most_column_log2 = 18;
    }
    if (arguments.width != 0) options.width = arguments.width;
    options.height = options.width * 7 / 8;
    if (arguments.samples != 0) options.truth_samples = options.scene_truth_samples = arguments.samples;
    options.threads =
        arguments.threads != 0 ? arguments.threads : std::max(1U, std::thread::hardware_concurrency());
    options.measure.threads = options.threads;
    options.measure.budget = {.accuracy = Accuracy::exact, .cancelled = interrupt.token()};
    options.limits = photo_limits(arguments.max_megapixels);
    options.gpu_rows = arguments.gpu_rows;
    options.pictures = !arguments.no_pictures;
    options.pages = !arguments.no_pages;
    options.made_by = words_of(arguments);
    return options;
}

Result<void> write_report(const Arguments& arguments, const Interrupt& interrupt) {
    fs::path folder = arguments.folder;
    if (!folder.has_filename()) folder = folder.parent_path();
    if (auto fit = check_report_folder(folder); !fit) return fit;
    // Whole or not at all: a neighbour that is moved into place
    fs::path partial = folder;
    partial += ".partial";
    std::error_code failure;
    fs::remove_all(partial, failure);
    fs::create_directories(partial, failure);
    if (failure) return Error{ErrorCode::io_failure, partial.string() + ": " + failure.message()};
    const RemovedAtEnd removed{partial};

    const AccuracyOptions options = options_of(arguments, interrupt);
    TerminalProgress progress{"tessera accuracy", accuracy_shares(), arguments.quiet, interrupt.token()};
    const auto report = run_accuracy(options, partial, progress);
    if (!report && report.error().code == ErrorCode::cancelled)
        return Error{ErrorCode::cancelled, "stopped; nothing is left of " + folder.string()};
    if (!report) return report.error();
    if (auto written = write_report_files(partial, *report); !written) return written;
    if (auto moved = move_into_place(partial, folder); !moved) return moved;
    if (!arguments.quiet) {
        std::size_t holds = 0;
        for (const proto::AccuracyClaim& claim : report->claims()) holds += claim.holds() ? 1 : 0;
        progress.note((folder / "index.html").string() + ": " + std::to_string(report->rows_size()) +
                      " rows; " + std::to_string(holds) + " of " + std::to_string(report->claims_size()) +
                      " claims hold");
    }
    return {};
}

Result<void> export_only(const Arguments& arguments, const Interrupt& interrupt) {
    TerminalProgress progress{"tessera accuracy", {{"textures", 1.0}}, arguments.quiet, interrupt.token()};
    return export_textures(options_of(arguments, interrupt), arguments.export_folder, progress);
}

int run(const Arguments& arguments) {
    const Interrupt interrupt;
    if (arguments.folder.empty() && arguments.export_folder.empty()) {
        std::fprintf(stderr, "tessera accuracy: say where to write the report with -o FOLDER\n");
        return 1;
    }
    Result<void> done;
    if (!arguments.export_folder.empty()) done = export_only(arguments, interrupt);
    if (done && !arguments.folder.empty()) done = write_report(arguments, interrupt);
    if (!done) std::fprintf(stderr, "tessera accuracy: %s\n", done.error().detail.c_str());
    return done ? 0 : 1;
}

}  // namespace

void add_accuracy_command(CLI::App& app, int& exit_code) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App& command = *app.add_subcommand(
        "accuracy",
        "Measures what each filter costs in time and how wrong it is, and writes a report to look at");
    command.add_option("TEXTURE", arguments->textures,
                       "Scene folders, images (PNG, JPEG, WebP, TIFF), or any of photograph, checker, text, "
                       "content-exchange, patterns, which are taken if none is named");
    command.add_option("-o,--output", arguments->folder, "Folder for the report; index.html opens it");
    command.add_flag("--thorough", arguments->thorough,
                     "Pictures of 800 x 700 pixels, 65,536 samples a pixel; may take an hour");
    command.add_flag("--quick", arguments->quick, "Pictures of 64 x 56 pixels: only a look, times are rough")
        ->excludes("--thorough");
    command.add_option("--width", arguments->width, "Of the pictures, in pixels; they are 8:7")
        ->check(CLI::Range(32, 1600))
        ->default_str("208");
    command
        .add_option("--samples", arguments->samples,
                    "Of the ground truth, a pixel, where it is not analytic; a power of two")
        ->check(CLI::Range(least_truth_samples, std::size_t{1} << 20))
        ->default_str("16384, of scenes 4096");
    command.add_option("--gpu-rows", arguments->gpu_rows,
                       "Takes in the rows that tessera-view --headless --compare-filters wrote");
    command.add_option("--export-textures", arguments->export_folder,
                       "Writes the stored textures as FOLDER/NAME.png, for tessera-view to measure the same");
    command.add_flag("--no-pictures", arguments->no_pictures, "Figures only");
    command.add_flag("--no-pages", arguments->no_pages, "Filters only, no comparisons of pages");
    command
        .add_option("--threads", arguments->threads,
                    "For truth and pictures; 0: one for each processor. Times are always taken on one")
        ->capture_default_str();
    add_megapixels_option(command, arguments->max_megapixels);
    command.add_flag("-q,--quiet", arguments->quiet, "No progress, only errors");
    command.callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace tessera
