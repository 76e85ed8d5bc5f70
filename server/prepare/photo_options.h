#pragma once

#include <cstdint>

#include "server/scene/image_file.h"
#include "server/texture/exchange_asset.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tessera {

inline constexpr std::int64_t default_megapixels = 64;

/// --method content_exchange|interchange|wang
CLI::Option* add_method_option(CLI::App& command, ExchangeMethod& method);

/// --max-megapixels N: what a photograph may hold, so that none takes all memory.
void add_megapixels_option(CLI::App& command, std::int64_t& megapixels);

/// The limits that this many megapixels mean; whoever is above is told of the option.
ImageLimits photo_limits(std::int64_t megapixels);

}  // namespace tessera
