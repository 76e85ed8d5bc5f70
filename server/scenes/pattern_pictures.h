#pragma once

#include <cstdint>
#include <stop_token>
#include <string_view>
#include <vector>

#include "server/texture/texture.h"
#include "shared/page/page_key.h"
#include "shared/page/texel_image.h"
#include "shared/result/result.h"

namespace tessera {

/// Where a case study is looked at: three levels of one place.
struct View {
    std::string_view scene;
    std::string_view caption;
    struct Look {
        std::uint8_t level = 0;
        std::int64_t x = 0, y = 0;  ///< Its middle, in texels of level 0.
        std::int64_t slice = 0;
    };
    Look looks[3];
    std::int32_t stack = 0;  ///< Slices laid on each other, seen from the front at a slant; 0: one slice.
};
const std::vector<View>& pattern_views();

/// The rectangle of `side` × `side` texels about the middle of a look.
TexelRegion region_of(const View::Look& look, std::int32_t side) noexcept;

/// `slices` slices from 0 up, each drawn higher up the picture than the one below it, premultiplied over.
/// Errors: those of evaluating.
Result<LinearImage> evaluate_stack(const Texture& texture, const TexelRegion& region, std::int32_t slices,
                                   const Budget& budget);

/// One picture of all views whose scenes are in `textures` (in the order of pattern_views(); null where there
/// is none), `cell` texels a side each. Errors: those of evaluating.
Result<Rgba8Image> draw_pattern_views(const std::vector<const Texture*>& textures, std::int32_t cell,
                                      std::stop_token stop);

}  // namespace tessera
