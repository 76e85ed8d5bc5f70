#include "server/compare/commands.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "server/compare/comparison_sheet.h"
#include "server/compare/judged_asset.h"
#include "server/files/whole_file.h"
#include "server/pages/page_encoder.h"
#include "server/prepare/photo_options.h"
#include "server/progress/interrupt.h"
#include "server/progress/terminal_progress.h"
#include "server/scene/asset_file.h"
#include "server/scene/image_file.h"
#include "server/scenes/paint_pebbles.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::array all_methods{ExchangeMethod::content_exchange, ExchangeMethod::interchange,
                                 ExchangeMethod::wang};
constexpr std::int32_t pebbles_side = 1024;
constexpr std::uint64_t pebbles_seed = 1;

struct Arguments {
    const char* command = "quality";
    std::vector<std::string> photos;
    std::vector<std::string> methods;
    std::string folder;  ///< compare only
    std::string format = "png";
    std::int32_t cell = 768;
    bool pebbles = false;
    PrepareOptions options;
    std::int64_t max_megapixels = default_megapixels;
    bool quiet = false;
};

/// Reads a photograph; no name stands for the painted pebbles.
Result<Rgb8Image> photo_of(const std::string& name, const Arguments& arguments) {
    if (name.empty()) return paint_pebbles(pebbles_side, pebbles_seed);
    return read_rgb_image(name, photo_limits(arguments.max_megapixels));
}

std::vector<ExchangeMethod> methods_of(const Arguments& arguments) {
    std::vector<ExchangeMethod> methods;
    for (const ExchangeMethod method : all_methods)
        if (arguments.methods.empty() ||
            std::count(arguments.methods.begin(), arguments.methods.end(), method_name(method)) > 0)
            methods.push_back(method);
    return methods;
}

/// A figure that misses its limit is marked.
std::string marked(double value, const Quality& quality, std::string_view gate, const char* pattern,
                   double scale = 1) {
    bool missed = false;
    for (const Gate& one : quality.gates) missed |= one.name == gate && !one.passed();
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), pattern, value * scale);
    return text.data() + std::string{missed ? "!" : " "};
}

void print_head() {
    std::printf(
        "%-20s %-16s %7s  %6s %6s  %5s  %6s %6s %5s %6s  %6s %6s  %7s %7s  %6s %6s  %5s %5s  %6s %6s %6s\n",
        "photograph", "method", "prepare", "seams", "p99", "place", "excess", "p99", "new", "quiet", "blend",
        "p99", "repeats", "else", "tile", "max", "L", "steps", "cut", "p99", "MiB");
}

void print_row(const std::string& photo, const JudgedAsset& judged) {
    const Quality& quality = judged.quality;
    const Seams& seams = quality.seams;
    const auto& fine = quality.repetition.levels.front();
    const auto known = [](bool is, const char* pattern, double value) {
        std::array<char, 32> text{};
        std::snprintf(text.data(), text.size(), pattern, value);
        return std::string{is ? text.data() : "-"};
    };
    const bool natural = seams.natural_steps > 0;
    std::printf(
        "%-20.20s %-16s %6.1fs  %6s %6s  %5s  %6s %6s %5s %6s  %6s %6s  %7s %6.1f%%  %5.1f%% %5.1f%%  %5.2f "
        "%5.2f  %6.2f %6.2f "
        "%6.1f\n",
        photo.c_str(), std::string{method_name(judged.asset.method)}.c_str(), judged.prepare_seconds,
        marked(seams.hard_ratio.mean, quality, "seams, mean", "%.2f").c_str(),
        marked(seams.hard_ratio.percentile_99, quality, "seams, 99th percentile", "%.2f").c_str(),
        known(natural, "%.2f", seams.natural_ratio.mean).c_str(),
        known(natural, "%.2f", seams.excess.mean).c_str(),
        known(natural, "%.2f", seams.excess.percentile_99).c_str(),
        known(natural, "%.0f%%", seams.new_edges * 100).c_str(),
        known(seams.quiet_steps > 0, "%.2f", seams.quiet_ratio.mean).c_str(),
        marked(seams.blended_ratio.mean, quality, "seams blended, mean", "%.2f").c_str(),
        marked(seams.blended_ratio.percentile_99, quality, "seams blended, 99th percentile", "%.2f").c_str(),
        marked(fine.greatest.value, quality, "repetition", "%.1f%%", 100).c_str(), fine.elsewhere * 100,
        quality.share.tile.mean * 100, quality.share.tile.greatest * 100, quality.fidelity.texture.lightness,
        quality.fidelity.texture.steps, judged.own_seams.ratio.mean, judged.own_seams.ratio.percentile_99,
        double(judged.texture->memory_bytes()) / (1 << 20));
    std::fflush(stdout);
}

Result<void> write_sheet(const Arguments& arguments, const std::string& name,
                         const std::vector<JudgedAsset>& assets, const std::stop_token& stop) {
    const auto sheet = draw_comparison(name, assets, arguments.cell, stop);
    if (!sheet) return sheet.error();
    const auto bytes = encode_page(*sheet, *page_format(arguments.format));
    if (!bytes) return bytes.error();
    const fs::path file = fs::path{arguments.folder} / (name + "." + arguments.format);
    fs::path made = file;
    made += ".partial";
    auto done = write_whole_file(made, *bytes);
    std::error_code failure;
    if (done) fs::rename(made, file, failure);
    if (failure) done = Error{ErrorCode::io_failure, file.string() + ": " + failure.message()};
    fs::remove(made, failure);
    if (done && !arguments.quiet) std::fprintf(stderr, "tessera compare: %s\n", file.c_str());
    return done;
}

/// `turn`: which of all it is, for the progress bar.
Result<void> compare_photo(const std::string& photo_name, const std::string& turn, const Arguments& arguments,
                           const Interrupt& interrupt) {
    const std::string name = photo_name.empty() ? "pebbles" : fs::path{photo_name}.stem().string();
    const auto photo = photo_of(photo_name, arguments);
    if (!photo) return photo.error();
    std::vector<JudgedAsset> assets;
    for (const ExchangeMethod method : methods_of(arguments)) {
        PrepareOptions options = arguments.options;
        options.method = method;
        auto judged = [&] {
            TerminalProgress progress{"tessera " + std::string{arguments.command} + ": " + turn + name +
                                          ", " + std::string{method_name(method)},
                                      judge_shares(method), arguments.quiet, interrupt.token()};
            return judge(*photo, options, progress);
        }();
        if (!judged) return Error{judged.error().code, name + ": " + judged.error().detail};
        print_row(name, *judged);
        assets.push_back(std::move(*judged));
    }
    return arguments.folder.empty() ? Result<void>{}
                                    : write_sheet(arguments, name, assets, interrupt.token());
}

int run(const Arguments& arguments) {
    const Interrupt interrupt;
    const auto fail = [&](const std::string& why) {
        std::fprintf(stderr, "tessera %s: %s\n", arguments.command, why.c_str());
        return 1;
    };
    std::vector<std::string> photos = arguments.photos;
    if (arguments.pebbles) photos.emplace_back();
    if (photos.empty()) return fail("names no PHOTO; name some, or add --pebbles");
    if (!arguments.folder.empty()) {
        std::error_code failure;
        fs::create_directories(arguments.folder, failure);
        if (failure) return fail(arguments.folder + ": " + failure.message());
    }
    print_head();
    // One bad photograph does not stop the others
    int exit_code = 0;
    for (std::size_t i = 0; i < photos.size(); ++i) {
        if (interrupt.token().stop_requested()) return fail("stopped");
        const std::string turn =
            photos.size() == 1 ? "" : std::to_string(i + 1) + " of " + std::to_string(photos.size()) + ": ";
        if (const auto done = compare_photo(photos[i], turn, arguments, interrupt); !done)
            exit_code = fail(done.error().detail);
    }
    return exit_code;
}

void add_common(CLI::App& command, Arguments& arguments) {
    command.add_option("PHOTO", arguments.photos, "PNG, JPEG, WebP or TIFF");
    command.add_flag("--pebbles", arguments.pebbles, "The painted pebbles of the sample scenes too");
    std::vector<std::string> names;
    for (const ExchangeMethod method : all_methods) names.emplace_back(method_name(method));
    command.add_option("--method", arguments.methods, "Only this method; may be repeated")
        ->check(CLI::IsMember(names))
        ->allow_extra_args(false);  // so that photographs may follow
    command.add_option("--tile", arguments.options.tile_side, "Side of the tile in texels, a power of two")
        ->default_str("the method's own, by the photograph's size");
    command.add_option("--seed", arguments.options.seed, "Another seed, other patches")
        ->capture_default_str();
    command
        .add_option("--threads", arguments.options.threads,
                    "0: one for each processor; changes nothing but the time")
        ->capture_default_str();
    add_megapixels_option(command, arguments.max_megapixels);
    command.add_flag("-q,--quiet", arguments.quiet, "No progress, only errors");
}

}  // namespace

void add_compare_commands(CLI::App& app, int& exit_code) {
    const auto judged = std::make_shared<Arguments>();
    CLI::App& quality = *app.add_subcommand("quality",
                                            "Prepares photographs by each method and prints how good the "
                                            "textures are; ! marks what misses its limit");
    add_common(quality, *judged);
    quality.callback([judged, &exit_code] { exit_code = run(*judged); });

    const auto drawn = std::make_shared<Arguments>();
    drawn->command = "compare";
    CLI::App& compare = *app.add_subcommand(
        "compare",
        "The same, and a picture of each photograph: all methods at three levels, beside the tile repeated");
    add_common(compare, *drawn);
    compare.add_option("-o,--output", drawn->folder, "Folder for the pictures, named as the photographs")
        ->required();
    compare.add_option("--cell", drawn->cell, "Side of each part of a picture in texels")
        ->check(CLI::Range(least_sheet_cell, greatest_sheet_cell))
        ->capture_default_str();
    compare.add_option("--format", drawn->format, "Of the pictures")
        ->check(CLI::IsMember({"png", "jpg"}))
        ->capture_default_str();
    compare.callback([drawn, &exit_code] { exit_code = run(*drawn); });
}

}  // namespace tessera
