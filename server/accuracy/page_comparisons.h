#pragma once

#include <memory>
#include <string>
#include <vector>

#include "proto/accuracy.pb.h"

#include "server/progress/progress.h"
#include "server/texture/exchange_asset.h"
#include "server/texture/texture.h"
#include "shared/result/result.h"

namespace tessera {

// What pages cost and what it buys, one comparison each. Errors of rows are against what exact evaluation
// gives, times are medians of whole evaluations. Error of all: cancelled.

/// "light": MIP levels filtered in sRGB codes, as is often done, and in linear light.
void compare_light(const std::string& name, const LinearImage& image, std::vector<proto::PageRow>& rows);

/// "content-depth": four contents that share a region by weights, stored and summed level by level in 8-bit
/// sRGB codes, in 8-bit linear light, and in 16-bit linear light as Tessera does.
void compare_content_depth(const std::string& name, const LinearImage& image,
                           std::vector<proto::PageRow>& rows);

/// "integral": the mean of 16 texels as a difference of two column sums, from the end of columns of 2^level
/// texels; sums in 32-bit floats, as in the paper, and in modular 32-bit integers.
void compare_integrals(std::vector<proto::PageRow>& rows);

/// "statistical": above the tile level, contents that are chosen independently: their expectation
/// (accuracy fast), what high makes of it, enumeration (exact), and the typed quadtree, which is exact there.
Result<void> compare_statistics(const ExchangeAsset& asset, const std::stop_token& stop,
                                std::vector<proto::PageRow>& rows);

/// "descent": layers composited d levels below the one that was asked for, and reduced.
Result<void> compare_descents(const std::string& name, const Texture& layers, const std::stop_token& stop,
                              std::vector<proto::PageRow>& rows);

}  // namespace tessera
