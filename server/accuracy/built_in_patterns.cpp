// Textures whose truth can be written down: they are unions of rectangles.
#include <array>

#include "server/accuracy/measured_texture.h"
#include "server/quality/small_text.h"

namespace tessera {
namespace {

MeasuredTexture of(std::string name, std::string title, TwoColorPattern pattern) {
    auto shared = std::make_shared<const TwoColorPattern>(std::move(pattern));
    return {std::move(name), std::move(title), std::make_shared<const LinearImage>(draw(*shared)), nullptr,
            shared};
}

constexpr std::array lines{
    "A PHOTOGRAPH IN, AN ENDLESS GROUND OUT. EVERY TEXTURE IS A SUM OF STAMPS,",
    "SMALL IMAGES WHOSE LEVELS ARE COMPUTED ONCE, AND THE BOX FILTER IS LINEAR:",
    "SO LEVEL N OF THE WHOLE IS THE SUM OF LEVEL N OF THE STAMPS, AND LEVEL 0 IS",
    "NEVER MADE. A PIXEL OF THE SCREEN SEES A QUADRILATERAL OF THE TEXTURE. ITS",
    "TRUE COLOUR IS THE AVERAGE OF ALL THAT LIES INSIDE, IN LINEAR LIGHT. A FILTER",
    "GUESSES THAT AVERAGE FROM A FEW TEXELS: ONE, FOUR, EIGHT, A HUNDRED AND MORE.",
    "WHOEVER CAN STILL READ THIS LINE AT A GRAZING ANGLE HAS A GOOD FILTER. 0.25 %",
};

}  // namespace

MeasuredTexture checker_texture() {
    TwoColorPattern board{
        .square_texels = 32, .width = 16, .height = 16, .inked = {}, .ground = {255, 255, 255}};
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) board.inked.push_back((x + y) % 2 != 0 ? 1 : 0);
    return of("checker", "A checker", std::move(board));
}

MeasuredTexture constant_texture() {
    return of("constant", "One colour",
              {.square_texels = 256, .width = 1, .height = 1, .inked = {0}, .ground = {188, 120, 57}});
}

MeasuredTexture text_texture() {
    constexpr std::int32_t side = 512, line_height = 11;
    Rgba8Image page(side, side);
    for (std::int32_t line = 0; (line + 1) * line_height <= side; ++line)
        draw_text(page, 8, line * line_height + 3, lines[std::size_t(line) % lines.size()], 1,
                  {255, 255, 255});
    TwoColorPattern text{.square_texels = 2,
                         .width = side,
                         .height = side,
                         .inked = {},
                         .ground = {244, 240, 230},
                         .ink = {26, 24, 32}};
    for (std::size_t i = 0; i < page.bytes.size(); i += 4) text.inked.push_back(page.bytes[i] != 0 ? 1 : 0);
    return of("text", "Fine text", std::move(text));
}

}  // namespace tessera
