#pragma once

#include <string>
#include <vector>

#include "server/compare/judged_asset.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// What a sheet's columns show.
inline constexpr int sheet_levels[] = {0, 2, 4};
/// A sheet is at most 4096 texels a side.
inline constexpr std::int32_t least_sheet_cell = 64, greatest_sheet_cell = 960;

/// A picture of one photograph: a row for the naive repeat of the first asset's tile, then one for each
/// asset; a column for each level. `cell`: side of each in texels. Error: cancelled.
Result<Rgba8Image> draw_comparison(const std::string& name, const std::vector<JudgedAsset>& assets,
                                   std::int32_t cell, std::stop_token stop);

}  // namespace tessera
