#include "server/compare/comparison_sheet.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>

#include "server/quality/pictures.h"
#include "server/quality/small_text.h"
#include "server/scene/asset_file.h"

namespace tessera {
namespace {

constexpr std::int32_t gap = 8;
constexpr auto columns = static_cast<std::int32_t>(std::size(sheet_levels));

void paste(Rgba8Image& sheet, const Rgba8Image& picture, std::int32_t left, std::int32_t top,
           std::int32_t cell) {
    for (std::int32_t y = 0; y < cell; ++y)
        for (std::int32_t x = 0; x < cell; ++x)
            std::copy_n(picture.row(y % picture.height) + std::ptrdiff_t{4} * (x % picture.width), 4,
                        sheet.row(top + y) + std::ptrdiff_t{4} * (left + x));
}

std::string spoken(ExchangeMethod method) {
    std::string name{method_name(method)};
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

std::string figures(const Quality& quality) {
    std::array<char, 96> text{};
    std::snprintf(text.data(), text.size(), "seams %.2f, blended %.2f, repetition %.1f %%",
                  quality.seams.hard_ratio.mean, quality.seams.blended_ratio.mean,
                  quality.repetition.levels.front().greatest.value * 100);
    return text.data();
}

}  // namespace

Result<Rgba8Image> draw_comparison(const std::string& name, const std::vector<JudgedAsset>& assets,
                                   std::int32_t cell, std::stop_token stop) {
    const std::int32_t scale = cell >= 512 ? 2 : 1;
    const std::int32_t line = letter_height * scale + 2 * gap;
    const auto rows = static_cast<std::int32_t>(assets.size()) + 1;
    Rgba8Image sheet{columns * (cell + gap) + gap, rows * (cell + line) + line + gap};
    for (std::size_t i = 0; i < sheet.bytes.size(); i += 4) {
        std::fill_n(sheet.bytes.begin() + std::ptrdiff_t(i), 3, std::uint8_t{24});
        sheet.bytes[i + 3] = 255;
    }
    draw_text(sheet, gap, gap, name, scale, {255, 255, 255});
    for (std::int32_t row = 0; row < rows; ++row) {
        const std::int32_t top = line + row * (cell + line);
        const JudgedAsset* judged = row == 0 ? nullptr : &assets[std::size_t(row - 1)];
        const std::string words = judged == nullptr
                                      ? "the tile repeated"
                                      : spoken(judged->asset.method) + ": " + figures(judged->quality);
        draw_text(sheet, gap, top + gap, words, scale, {220, 215, 205});
        for (std::int32_t column = 0; column < columns; ++column) {
            const int level = sheet_levels[column];
            Rgba8Image picture;
            if (judged == nullptr) {
                picture = tile_at_level(assets.front().asset.tile, level);
            } else {
                const auto done =
                    judged->texture->evaluate({static_cast<std::uint8_t>(level), 0, 0, cell, cell},
                                              {.accuracy = Accuracy::exact, .cancelled = stop}, picture);
                if (!done) return done.error();
            }
            const std::int32_t left = gap + column * (cell + gap);
            paste(sheet, picture, left, top + line, cell);
            draw_text_on_picture(sheet, left + gap, top + line + gap, "level " + std::to_string(level),
                                 scale);
        }
    }
    return sheet;
}

}  // namespace tessera
