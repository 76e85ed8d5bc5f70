#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "client/render/frame_target.h"
#include "shared/result/result.h"

namespace tessera {

/// What came of a replay.
struct ReplayReport {
    std::string scene;
    std::string recorded_by, recorded_with;  ///< Program and GL driver
    std::uint64_t frames = 0;                ///< Decided
    std::uint64_t drawn = 0;
    std::uint64_t hashed = 0;  ///< Drawn, with a hash to compare
    std::uint64_t equal = 0;   ///< Of these
    struct Difference {
        std::uint64_t frame = 0;
        std::string what;
    };
    std::vector<Difference> differences;  ///< The first few
    std::string end;                      ///< As the recording says why it ended
    std::string trouble;  ///< Where it breaks off, or why it cannot be gone on with; else empty
    bool is_equal() const { return hashed == equal && differences.empty() && trouble.empty(); }
};

/// Draws a recorded session again, without any server: the same frames out of the same answers at the same
/// times. Needs a current context. `shown`: called with each drawn frame's target and number; false ends it.
/// Error: invalid_input (no file of these, another version), io_failure (the driver).
Result<ReplayReport> replay(const std::filesystem::path& file,
                            const std::function<bool(const FrameTarget&, std::uint64_t frame)>& shown);

/// For people: some lines.
std::string text_of(const ReplayReport& report);

}  // namespace tessera
