#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "server/texture/exchange.h"

namespace tessera::tests {

using Code3 = std::array<std::uint8_t, 3>;

/// Adds an image of one colour, aligned with the asset's.
void add_flat_channel(ExchangeAsset& asset, const std::string& name, Code3 code);

/// Adds normals of bumps a few texels wide, `steep` codes to each side of flat.
void add_bumps(ExchangeAsset& asset, std::uint32_t steep, std::uint64_t seed = 5);

/// Adds grey noise between two codes.
void add_grey_noise(ExchangeAsset& asset, const std::string& name, std::uint8_t from, std::uint8_t to);

/// Adds the colour itself, as data.
void add_copy_of_albedo(ExchangeAsset& asset, const std::string& name);

}  // namespace tessera::tests
