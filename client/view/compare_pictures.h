#pragma once

#include <vector>

#include "client/render/situation_renderer.h"
#include "client/view/area_truth.h"
#include "shared/math/image_error.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// sRGB codes of linear light, fractions kept.
CodeImage codes_of(const FloatPicture& picture);

/// Rounded to 8 bits; what was not measured is dark grey.
Rgba8Image shown(const CodeImage& codes, const std::vector<std::uint8_t>& measured);

/// Eight times the difference of each channel.
Rgba8Image difference(const CodeImage& truth, const CodeImage& codes,
                      const std::vector<std::uint8_t>& measured);

/// The paper's figure 5: the picture in grey, tinted green where fewer texels were read than `reference`
/// reads for the pixel, red where more; full colour at four times.
Rgba8Image texel_map(const FloatPicture& picture, const FloatPicture& reference,
                     const std::vector<std::uint8_t>& measured);

/// Pictures side by side: `columns` of rows, of equal sizes.
Rgba8Image sheet(const std::vector<std::vector<Rgba8Image>>& columns);

/// The part of a picture from (left, top); inside it.
Rgba8Image cut(const Rgba8Image& image, int left, int top, int width, int height);

}  // namespace tessera
