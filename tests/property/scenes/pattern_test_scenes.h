#pragma once

#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace tessera::tests {

/// A scene of pattern blocks that the laws are tested on.
struct PatternTestScene {
    std::string name;
    std::string json{};               ///< Of its scene file; empty for a sample of that name.
    bool is_exact = false;            ///< One layer, typed or constant: no bound but 0 will do.
    double largest_bound = 0.51;      ///< In codes, of the accuracy "exact".
    std::int64_t x = 2048, y = 2048;  ///< Where it is looked at, in texels of level 0.
    std::int64_t slice = 0;
    std::int32_t side = 32;  ///< Of the squares that are compared: less where a texel costs much.
};
std::vector<PatternTestScene> pattern_test_scenes();
inline void PrintTo(const PatternTestScene& scene, std::ostream* out) { *out << scene.name; }

/// The scene's folder, with the images that it names, as long as this lives.
class WrittenScene {
  public:
    explicit WrittenScene(const PatternTestScene& scene);
    const std::filesystem::path& folder() const { return folder_; }

  private:
    TemporaryFolder temporary_;
    std::filesystem::path folder_;
};

}  // namespace tessera::tests
