#pragma once

#include <memory>

#include "server/texture/exchange.h"
#include "shared/page/channel_set.h"

namespace tessera {

/// The asset's aligned image of this name. Null if it has none.
const ExchangeAsset::Channel* aligned_image(const std::vector<ExchangeAsset::Channel>& channels,
                                            ChannelSet set) noexcept;

/// What the sets beside the albedo filter. Of an asset with normals: lean_slopes(), lean_squares() and
/// lean_products() in `range`; of one without: squared_alphas(), or heights. Null if it has no such image.
/// Made when it is first evaluated: until then it holds the aligned images only, since most scenes are
/// looked at for their colour.
std::shared_ptr<const ExchangeData> make_channel_data(std::shared_ptr<const ExchangeTexture> albedo,
                                                      const ExchangeAsset& asset, double range);

}  // namespace tessera
