#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "client/render/filter.h"
#include "client/render/overlay.h"
#include "client/residency/surface.h"
#include "client/view/session_log_options.h"
#include "client/view/view_frame.h"
#include "shared/page/accuracy.h"
#include "shared/page/channel_set.h"

namespace tessera {

/// The command line of `tessera-view`.
struct Options {
    std::string url;    ///< http://host:port
    std::string scene;  ///< The scene's id
    bool http = false;  ///< Pages by HTTP, which tells of no edits; else by the stream.
    std::string name;   ///< Of who looks, for the others
    std::string token;  ///< Of an editor, for servers elsewhere; empty: none
    ChannelSet channels = ChannelSet::albedo;
    int width = 0;  ///< Pixels of the frames, or of the window; 0: 800×700, or 1280×800
    int height = 0;
    std::filesystem::path camera;  ///< A camera path; empty: the scene's opening view
    std::filesystem::path output;  ///< Folder for frames and screenshots
    int frames = 0;                ///< Frames to draw; 0: one, or until the window is closed
    bool headless = false;
    FilterChoice filter{};
    Accuracy accuracy = Accuracy::high;  ///< Of the pages
    Surface surface{};                   ///< But for what is read from `terrain`
    std::filesystem::path terrain;       ///< A grey PNG of heights; empty: made ones
    Overlay overlay = Overlay::none;
    std::optional<Filter> split_filter;      ///< The right half is drawn so,
    std::optional<Accuracy> split_accuracy;  ///< or has pages of this accuracy.
    double split_at = 0.5;
    bool compare_filters = false;
    std::filesystem::path textures;  ///< Folder of compare_filters; empty: a built-in checker
    std::string command_line;
    SessionLogOptions log{};
    std::filesystem::path replay;  ///< A recorded session to draw again; no server then
    std::optional<Step> step;      ///< Of headless frames; none: the scene's
    bool settle = true;
    double panel_scale = 1;         ///< Panels are so much larger than the screen asks.
    std::size_t cache_pages = 512;  ///< See ResidencySettings::slots
    std::size_t in_flight = 12;     ///< See RequestLimits::in_flight
};

/// The right half of the picture, where the options ask for one.
std::optional<SplitChoice> split_of(const Options& options);

/// Reads the command line. Returns false after it has printed help, the version or what is wrong; `exit_code`
/// is then the program's.
bool read_options(int argc, const char* const* argv, Options& options, int& exit_code);

}  // namespace tessera
