#include "server/scene/asset_file.h"

namespace tessera {

Result<ContentExchangeAsset> read_content_exchange_asset(const std::filesystem::path& folder) {
    return Error{ErrorCode::io_failure, folder.string() + ": cannot be read"};
}

}  // namespace tessera
