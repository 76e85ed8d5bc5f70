#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <png.h>

#include "shared/math/hash.h"
#include "tests/end_to_end/server/program.h"
#include "tests/support/temporary_folder.h"

namespace tessera::test {

/// A folder with one scene, `sprites`: four patterns of 16 texels over a checker of 256·2^6.
class LiveScene {
  public:
    LiveScene() {
        const std::filesystem::path scene = folder_.path / "sprites";
        std::filesystem::create_directories(scene);
        std::vector<std::uint8_t> texels;
        for (std::int64_t i = 0; i < 16 * 64 * 4; ++i)
            texels.push_back(static_cast<std::uint8_t>(hash(4, 4, i, 0)));
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        image.width = 16;
        image.height = 64;
        image.format = PNG_FORMAT_RGBA;
        png_image_write_to_file(&image, (scene / "patterns.png").c_str(), 0, texels.data(), 0, nullptr);
        std::ofstream{scene / "scene.json"} << R"({"checker": {"cell_texels": 8}, "extent_log2_pages": 6,
            "sprites": {"patterns": {"image": "patterns.png", "side_texels": 16}}})";
    }

    /// Of a server on a free port, or on this one. Edits are kept in the folder.
    std::vector<std::string> arguments(std::uint16_t port = 0) const {
        return {"serve", "--scenes", folder_.path.string(), "--listen", "127.0.0.1:" + std::to_string(port)};
    }
    std::filesystem::path file(const std::string& name) const { return folder_.path / name; }

  private:
    tests::TemporaryFolder folder_;
};

}  // namespace tessera::test
