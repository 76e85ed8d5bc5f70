#pragma once

#include <array>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/scene/image_file.h"
#include "server/scene/scene.h"
#include "server/tiled/import_map.h"
#include "tests/support/temporary_folder.h"

namespace tessera::test {

/// A folder for maps that tests write, and for the scenes that become of them.
class MapFolder : public testing::Test {
  protected:
    std::filesystem::path at(const std::string& name) const { return folder.path / name; }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream{at(name), std::ios::binary} << text;
    }

    /// Tiles of `width`×`height` texels, so many in a row; texel (u, v) of tile i is (16 i, u, v, alpha).
    void write_tiles(const std::string& name, int columns, int rows, int width, int height, int margin = 0,
                     int spacing = 0, int alpha = 255) const {
        StraightRgba8Image image{2 * margin + columns * (width + spacing) - spacing,
                                 2 * margin + rows * (height + spacing) - spacing,
                                 {}};
        image.bytes.resize(std::size_t(image.width) * std::size_t(image.height) * 4, 99);
        for (int i = 0; i < columns * rows; ++i)
            for (int v = 0; v < height; ++v)
                for (int u = 0; u < width; ++u) {
                    const int x = margin + i % columns * (width + spacing) + u;
                    const int y = margin + i / columns * (height + spacing) + v;
                    std::uint8_t* const texel =
                        image.bytes.data() + (std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * 4;
                    texel[0] = static_cast<std::uint8_t>(16 * i), texel[1] = static_cast<std::uint8_t>(u);
                    texel[2] = static_cast<std::uint8_t>(v), texel[3] = static_cast<std::uint8_t>(alpha);
                }
        ASSERT_TRUE(write_rgba_png(at(name), image));
    }

    Result<TiledScene> import(const std::string& map) const {
        SilentProgress progress;
        return import_tiled_map(at(map), at("scene"), {}, progress);
    }
    /// Level-0 texels of the scene that was imported last.
    Rgba8Image texels(std::int64_t x, std::int64_t y, int width, int height) const {
        const auto scene = load_scene(at("scene"));
        Rgba8Image out;
        EXPECT_TRUE(scene) << scene.error().detail;
        if (!scene) return out;
        EXPECT_TRUE((*scene)->texture->evaluate(TexelRegion{0, x, y, width, height}, {}, out));
        return out;
    }
    static std::array<int, 4> texel(const Rgba8Image& image, int x, int y) {
        const std::uint8_t* const codes = image.row(y) + 4 * x;
        return {codes[0], codes[1], codes[2], codes[3]};
    }

    tests::TemporaryFolder folder;
};

inline std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + '\n';
    return text;
}

}  // namespace tessera::test
