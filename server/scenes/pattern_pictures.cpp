#include "server/scenes/pattern_pictures.h"

#include <algorithm>
#include <string>

#include "server/quality/small_text.h"

namespace tessera {
namespace {

constexpr std::int32_t gap = 6, looks = 3, columns = 2;
constexpr double slant_texels = 1.25;  ///< A slice is drawn so much higher than the one below it, at level 0.

void fill(Rgba8Image& image, std::uint8_t code) {
    for (std::size_t i = 0; i < image.bytes.size(); ++i)
        image.bytes[i] = i % 4 == 3 ? std::uint8_t{255} : code;
}

/// Over black; premultiplied codes are that already.
void paste(Rgba8Image& sheet, const Rgba8Image& picture, std::int32_t left, std::int32_t top) {
    for (std::int32_t y = 0; y < picture.height; ++y)
        for (std::int32_t x = 0; x < picture.width; ++x)
            std::copy_n(picture.row(y) + std::ptrdiff_t{4} * x, 3,
                        sheet.row(top + y) + std::ptrdiff_t{4} * (left + x));
}

}  // namespace

const std::vector<View>& pattern_views() {
    static const std::vector<View> views{
        {"tiles",
         "Basic aperiodic tiling: 16 patterns",
         {{0, 1024, 1024, 0}, {2, 1024, 1024, 0}, {5, 8192, 8192, 0}},
         0},
        {"meadow-sand",
         "Extended: families, transition tiles, dithered areas",
         {{0, 5400, 3300, 0}, {3, 5400, 3300, 0}, {6, 8192, 8192, 0}},
         0},
        {"leaves",
         "Basic sparse convolution",
         {{0, 2048, 2048, 0}, {2, 2048, 2048, 0}, {5, 8192, 8192, 0}},
         0},
        {"autumn",
         "Extended sparse convolution: areas of mixtures",
         {{0, 5000, 5000, 0}, {3, 5000, 5000, 0}, {6, 8192, 8192, 0}},
         0},
        {"terrain",
         "Four families, a billion texels a side",
         {{0, 1069023232, 1065877504, 0}, {4, 1069023232, 1065877504, 0}, {22, 420000000, 315000000, 0}},
         0},
        {"petals",
         "Patterns over content exchange",
         {{0, 2048, 2048, 0}, {1, 2048, 2048, 0}, {3, 2048, 2048, 0}},
         0},
        {"grove",
         "Volumes: slices 0, 13 and 22",
         {{0, 2048, 2048, 0}, {0, 2048, 2048, 13}, {0, 2048, 2048, 22}},
         0},
        {"grove",
         "32 slices stacked, at levels 0, 1 and 3",
         {{0, 2048, 2048, 0}, {1, 2048, 2048, 0}, {3, 2048, 2048, 0}},
         32},
    };
    return views;
}

TexelRegion region_of(const View::Look& look, std::int32_t side) noexcept {
    return {look.level, (look.x >> look.level) - side / 2, (look.y >> look.level) - side / 2, side, side,
            look.slice};
}

Result<LinearImage> evaluate_stack(const Texture& texture, const TexelRegion& region, std::int32_t slices,
                                   const Budget& budget) {
    LinearImage sum{region.width, region.height};
    LinearImage slice;
    const double slant = slant_texels / static_cast<double>(std::int64_t{1} << region.level);
    for (std::int32_t s = 0; s < slices; ++s) {
        // What is higher up the picture comes from further down the texture
        TexelRegion moved = region;
        moved.y += static_cast<std::int64_t>(s * slant + 0.5);
        moved.slice = region.slice + s;
        if (auto evaluated = texture.evaluate(moved, budget, slice); !evaluated) return evaluated.error();
        for (std::size_t i = 0; i < sum.values.size(); i += 4) {
            const float through = 1.0F - slice.values[i + 3];
            for (std::size_t c = 0; c < 4; ++c)
                sum.values[i + c] = slice.values[i + c] + through * sum.values[i + c];
        }
    }
    return sum;
}

Result<Rgba8Image> draw_pattern_views(const std::vector<const Texture*>& textures, std::int32_t cell,
                                      std::stop_token stop) {
    const auto& views = pattern_views();
    const std::int32_t line = letter_height + 2 * gap;
    const auto rows = (static_cast<std::int32_t>(views.size()) + columns - 1) / columns;
    const std::int32_t strip = looks * (cell + gap) + 2 * gap;
    Rgba8Image sheet{columns * strip, rows * (cell + line) + gap};
    fill(sheet, 24);
    const Budget budget{.accuracy = Accuracy::exact, .cancelled = stop};
    for (std::size_t v = 0; v < views.size(); ++v) {
        const View& view = views[v];
        const std::int32_t left = static_cast<std::int32_t>(v) % columns * strip + gap;
        const std::int32_t top = static_cast<std::int32_t>(v) / columns * (cell + line);
        draw_text(sheet, left, top + gap, std::string{view.scene} + ": " + std::string{view.caption}, 1,
                  {220, 215, 205});
        if (v >= textures.size() || textures[v] == nullptr) continue;
        for (std::int32_t look = 0; look < looks; ++look) {
            const TexelRegion region = region_of(view.looks[look], cell);
            Rgba8Image picture;
            if (view.stack > 0) {
                const auto stacked = evaluate_stack(*textures[v], region, view.stack, budget);
                if (!stacked) return stacked.error();
                encode(*stacked, picture);
            } else if (auto evaluated = textures[v]->evaluate(region, budget, picture); !evaluated) {
                return evaluated.error();
            }
            const std::int32_t x = left + look * (cell + gap);
            paste(sheet, picture, x, top + line);
            const std::string words = view.stack == 0 && view.scene == "grove"
                                          ? "slice " + std::to_string(view.looks[look].slice)
                                          : "level " + std::to_string(view.looks[look].level);
            draw_text_on_picture(sheet, x + gap, top + line + gap, words, 1);
        }
    }
    return sheet;
}

}  // namespace tessera
