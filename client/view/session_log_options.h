#pragma once

#include <filesystem>

namespace tessera {

/// What the command line asks to be kept of a session.
struct SessionLogOptions {
    std::filesystem::path metrics;  ///< Empty: no file
    bool every_frame = false;       ///< A line for each frame, not for each second
    bool check_pages = false;       ///< Compares what the GPU has with what it should have, a second apart
    std::filesystem::path record;   ///< Empty: none
    double record_megabytes = 2048;
    bool record_hashes = false;  ///< Of each picture, which waits for it
};

}  // namespace tessera
