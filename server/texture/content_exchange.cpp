#include "server/texture/content_exchange.h"

#include "server/texture/constant_texture.h"

namespace tessera {

std::shared_ptr<const Texture> make_content_exchange_texture(const ContentExchangeAsset&,
                                                             const ContentExchangeOptions&) {
    return make_constant_texture({128, 128, 128, 255});
}

}  // namespace tessera
