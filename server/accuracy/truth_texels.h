#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "server/texture/texture.h"
#include "shared/math/footprint.h"

namespace tessera {

/// Texels of level 0 for the ground truth, one at a time: RGB, linear, premultiplied. Shares nothing with the
/// filters' own pages. For one thread at a time.
class TruthTexels {
  public:
    virtual ~TruthTexels() = default;
    TruthTexels() = default;
    TruthTexels(const TruthTexels&) = delete;
    TruthTexels& operator=(const TruthTexels&) = delete;

    /// So many samples, spread over `footprint`, follow.
    virtual void expect(const Footprint& footprint, std::size_t samples) = 0;
    virtual Result<std::array<float, 3>> at(std::int64_t x, std::int64_t y) = 0;
};

/// An image, repeated.
std::unique_ptr<TruthTexels> truth_texels_of(std::shared_ptr<const LinearImage> image);

/// Any texture: in blocks of 64² texels where samples lie densely, else texel by texel.
std::unique_ptr<TruthTexels> truth_texels_of(std::shared_ptr<const Texture> texture, std::stop_token stop);

}  // namespace tessera
