#pragma once

#include <string>
#include <vector>

#include "server/scene/asset_file.h"
#include "shared/result/result.h"

namespace tessera {

/// "3:7,5": content 7 of patch 3, and all of patch 5. `option` names it in the message. Error: invalid_input.
Result<std::vector<StandingChange>> parse_contents(const std::string& option, const std::string& text,
                                                   ExchangeAsset::Standing standing);

}  // namespace tessera
