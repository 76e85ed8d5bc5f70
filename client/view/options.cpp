#include "client/view/options.h"

#include <cmath>
#include <utility>

#include <CLI/CLI.hpp>

#include "client/render/integral_store.h"
#include "client/view/viewer_state.h"

namespace tessera {
namespace {

constexpr const char* after_help = R"(In the window:
  drag           moves the plane          right drag     turns the head
  middle drag    orbits the centre        wheel          zooms to the cursor
  W A S D        fly (Shift: faster)      Q E            down, up
  F, 1 to 7      next filter, this one    V              plane, terrain, corridor
  B              page borders, age, ...   X              side by side; drag the line
  R              records the camera       L              plays what was recorded
  P              screenshot               H              all keys
  Enter          edits the scene: sprites by palette, drag and handles; brush; targets (Ctrl+Z undoes)

Examples:
  tessera-view http://127.0.0.1:7070 pebbles
  tessera-view http://127.0.0.1:7070 meadow --name Ada
  tessera-view http://127.0.0.1:7070 pebbles --headless --frames 60 --camera path.json -o frames
  tessera-view http://127.0.0.1:7070 pebbles --view terrain --split line-integral
  tessera-view http://127.0.0.1:7070 pebbles --headless --view corridor --split fast --overlay level -o out
  tessera-view --headless --compare-filters --textures photographs -o report
  tessera-view http://127.0.0.1:7070 pebbles --record flight.session --metrics flight.jsonl
  tessera-view --headless --replay flight.session

Without a display (--headless) an off-screen OpenGL context is used (EGL, surfaceless): it needs no X server, and on
a machine with no GPU Mesa's software rasteriser draws. frame_0000.png … and metrics.json are written. A camera path:
  {"keys": [{"time": 0, "x": "134217728", "y": 5000, "x_fraction": 0.5, "height": 900, "yaw": 30, "pitch": -35},
            {"time": 4, "x": "134219000", "y": 5000, "height": 300, "yaw": 60, "pitch": -20}]}
Times in seconds, positions and height in texels of level 0, angles in degrees; K in the window prints such a key.
)";

std::string read_size(const std::string& text, Options& options) {
    int used = 0;
    if (std::sscanf(text.c_str(), "%dx%d%n", &options.width, &options.height, &used) != 2 ||
        static_cast<std::size_t>(used) != text.size() || options.width < 16 || options.height < 16 ||
        options.width > 8192 || options.height > 8192)
        return "--size must be WIDTHxHEIGHT in pixels, 16 to 8192 each, as in 800x700";
    return {};
}

/// What is missing, or asked for in vain.
std::string check_compare(const Options& options) {
    if (!options.replay.empty()) {
        if (options.compare_filters || !options.url.empty() || !options.log.record.empty())
            return "--replay takes no URL, and nothing else to do: all is in its file";
        return {};
    }
    if (!options.compare_filters) {
        if (!options.textures.empty()) return "--textures is for --compare-filters";
        if (options.url.empty() || options.scene.empty()) return "URL and SCENE are required";
        return {};
    }
    if (!options.headless) return "--compare-filters needs --headless";
    if (!options.url.empty())
        return "--compare-filters takes no URL: its textures come from --textures FOLDER";
    return {};
}

}  // namespace

std::optional<SplitChoice> split_of(const Options& options) {
    if (!options.split_filter && !options.split_accuracy) return std::nullopt;
    SplitChoice split{
        .at = options.split_at, .filter = options.filter, .is_second = options.split_accuracy.has_value()};
    if (options.split_filter) split.filter.filter = *options.split_filter;
    return split;
}

bool read_options(int argc, const char* const* argv, Options& options, int& exit_code) {
    CLI::App app{
        "Flies over a virtual texture of a Tessera server: a plane seen in perspective under a free camera."};
    app.footer(after_help);
    app.set_version_flag("--version", std::string{"tessera-view "} + TESSERA_VERSION);
    std::string size;
    app.add_option("URL", options.url, "The server, as in http://127.0.0.1:7070");
    app.add_option("SCENE", options.scene, "The scene's id; the server lists them at URL/scenes");
    std::string channels{name_of(options.channels)};
    app.add_option("--channels", channels,
                   "albedo, normal, roughness, height or moments, if the scene has it")
        ->check(CLI::IsMember({"albedo", "normal", "roughness", "height", "moments"}))
        ->capture_default_str();
    app.add_flag("--http", options.http,
                 "Ask for pages by HTTP, which tells of no edits; else by the scene's stream");
    app.add_option("--name", options.name, "Who looks, for the others who are there");
    app.add_option("--token", options.token, "Of an editor, where the server asks for one (tessera token)");
    app.add_option("--camera", options.camera,
                   "A camera path (JSON): replayed with --headless, else where to begin");
    app.add_option("-o,--output", options.output, "Folder for frames, metrics.json and screenshots");
    app.add_option("--frames", options.frames,
                   "Frames to draw, evenly over the camera path; a window then closes")
        ->check(CLI::Range(1, 100'000));
    app.add_option("--size", size, "WIDTHxHEIGHT in pixels [800x700; window 1280x800]");
    app.add_flag("--headless", options.headless,
                 "No window: write frames and metrics.json into the output folder");
    app.add_flag("--settle,!--free-run", options.settle,
                 "Each headless frame waits until every page it needs is there (the default); "
                 "--free-run keeps to the clock instead");
    app.add_option("--width", options.width, "Pixels, instead of --size")->check(CLI::Range(16, 8192));
    app.add_option("--height", options.height, "Pixels, instead of --size")->check(CLI::Range(16, 8192));
    std::string filter{name_of(options.filter.filter)};
    std::vector<std::string> filter_names;
    for (const Filter known : filters) filter_names.emplace_back(name_of(known));
    app.add_option("--filter", filter, "How texels become pixels; F in the window switches")
        ->check(CLI::IsMember(filter_names))
        ->capture_default_str();
    app.add_option(
           "--columns", options.filter.columns,
           "Of the line integral: lines across a pixel's footprint; more are finer and read more pages")
        ->check(CLI::Range(2, max_columns))
        ->capture_default_str();
    app.add_option("--subsamples", options.filter.subsamples, "Of supersampling: N, for N×N samples a pixel")
        ->check(CLI::Range(2, max_subsamples))
        ->capture_default_str();
    std::string view{"plane"}, overlay{name_of(options.overlay)}, accuracy{name_of(options.accuracy)}, split;
    app.add_option("--view", view, "What the texture lies on; V in the window switches")
        ->check(CLI::IsMember({"plane", "terrain", "corridor"}))
        ->capture_default_str();
    app.add_option(
        "--terrain", options.terrain,
        "Heights for --view terrain: a grey PNG, 8 or 16 bits, one pixel each 256 texels, that repeats "
        "mirrored; without it, hills are made");
    app.add_option("--relief", options.surface.relief,
                   "Of a terrain: heights times this; at 1, a code of 8 bits in the PNG is a texel")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str();
    app.add_option(
           "--overlay", overlay,
           "Page borders coloured by level, or pages tinted by age (how long shown) or by revision (how "
           "lately edited); B in the window switches")
        ->check(CLI::IsMember({"none", "level", "age", "revision"}))
        ->capture_default_str();
    app.add_option("--accuracy", accuracy, "Of the pages: fast, high or exact")
        ->check(CLI::IsMember({"fast", "high", "exact"}))
        ->capture_default_str();
    std::vector<std::string> splits = filter_names;
    for (const Accuracy known : accuracies) splits.emplace_back(name_of(known));
    app.add_option("--split", split,
                   "Side by side: the right half with this filter, or with pages of this accuracy; X in the "
                   "window switches")
        ->check(CLI::IsMember(splits));
    app.add_option("--split-at", options.split_at,
                   "Where the line between the halves is: a share of the width")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    app.add_option(
        "--metrics", options.log.metrics,
        "Write figures of the session (time to sharp, faults, frame times, …) as JSON lines, one a second");
    app.add_flag("--metrics-frames", options.log.every_frame, "With --metrics: one line a frame");
    app.add_flag(
        "--check-pages", options.log.check_pages,
        "Once a second compare pages and table on the GPU with what was brought there: wrong-page pixels");
    app.add_option("--record", options.log.record,
                   "Write the session down: all that decides its pictures, for --replay");
    app.add_option("--record-limit", options.log.record_megabytes, "Megabytes after which the recording ends")
        ->check(CLI::Range(1.0, 1e6))
        ->capture_default_str();
    app.add_flag("--record-hashes", options.log.record_hashes,
                 "In the window: hash each picture, so that a replay can compare (headless always does)");
    app.add_option(
        "--replay", options.replay,
        "Draw a recorded session again, without a server, and say whether each picture's hash is equal; "
        "with --headless and -o FOLDER also write the pictures");
    app.add_option("--step", options.step,
                   "Of the scene's clock, for headless frames; without it the scene's own");
    app.add_flag("--compare-filters", options.compare_filters,
                 "Draw three situations with every filter, compare with the true area integrals, and write "
                 "report.json "
                 "and pictures; needs --headless and no server");
    app.add_option("--textures", options.textures,
                   "Folder of PNG images for --compare-filters; without it a checker");
    app.add_option("--panel-scale", options.panel_scale, "Panels this much larger than the screen asks")
        ->check(CLI::Range(0.5, 4.0))
        ->capture_default_str();
    app.add_option("--cache-pages", options.cache_pages,
                   "Pages kept on the GPU, 279 KB each; line integrals of those in the picture take "
                   "another " +
                       std::to_string(IntegralStore::page_bytes >> 20) + " MiB each")
        ->capture_default_str()
        ->check(CLI::Range(least_cache_pages, most_cache_pages));
    app.add_option("--in-flight", options.in_flight, "Pages asked for at once")
        ->capture_default_str()
        ->check(CLI::Range(1, 64));
    try {
        app.parse(argc, argv);
        if (!size.empty())
            if (const std::string wrong = read_size(size, options); !wrong.empty())
                throw CLI::ValidationError{wrong};
        if (const std::string wrong = check_compare(options); !wrong.empty())
            throw CLI::ValidationError{wrong};
        for (const auto& [name, number] :
             {std::pair{"--relief", options.surface.relief}, std::pair{"--split-at", options.split_at},
              std::pair{"--panel-scale", options.panel_scale},
              std::pair{"--record-limit", options.log.record_megabytes}})
            if (!std::isfinite(number)) throw CLI::ValidationError{std::string{name} + " must be a number"};
        if (!options.terrain.empty() && view != "terrain")
            throw CLI::ValidationError{"--terrain is for --view terrain"};
        if (options.headless && options.output.empty() && options.replay.empty())
            throw CLI::ValidationError{"--headless needs -o FOLDER, where the frames go"};
        if (options.step && !options.headless)
            throw CLI::ValidationError{"--step is for --headless; in the window the scene's clock goes on"};
    } catch (const CLI::ParseError& error) {
        exit_code = app.exit(error) == 0 ? 0 : 2;
        return false;
    }
    options.channels = *channel_set_named(channels);
    options.filter.filter = *filter_named(filter);
    options.surface.kind = surface_named(view).value();
    options.overlay = overlay_named(overlay).value();
    options.accuracy = accuracy_named(accuracy).value();
    options.split_filter = filter_named(split);
    options.split_accuracy = accuracy_named(split);
    if (options.width == 0) options.width = options.headless ? 800 : 1280;
    if (options.height == 0) options.height = options.headless ? 700 : 800;
    for (int i = 0; i < argc; ++i) options.command_line += std::string{i == 0 ? "" : " "} + argv[i];
    if (options.headless && options.frames == 0) options.frames = 1;
    return true;
}

}  // namespace tessera
