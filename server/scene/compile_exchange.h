#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "server/texture/exchange.h"
#include "server/texture/exchange_asset.h"
#include "shared/result/result.h"

namespace tessera {

namespace proto {
class Exchange;
}

/// What a field of a scene file says of a prepared photograph, read and checked.
struct ReadExchange {
    ExchangeAsset asset;
    ExchangeOptions options;
    std::size_t bytes = 0;  ///< That a texture of it takes when it is compiled, without aligned images.
};

/// `field` is its path for messages ("content_exchange", "pattern.blocks[3] \"ground\".wang"), `method` what
/// the field's name says. Errors: invalid_input, io_failure; the message starts with the field's path.
Result<ReadExchange> read_exchange(const std::filesystem::path& folder, const std::string& field,
                                   ExchangeMethod method, const proto::Exchange& message);

/// The refusal of what would take so much.
Error too_large_exchange(const std::string& field, const std::string& asset, std::size_t bytes);

}  // namespace tessera
