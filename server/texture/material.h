#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "server/texture/exchange.h"
#include "shared/page/channel_set.h"

namespace tessera {

/// What a surface shows beside its colour.
struct Channels {
    ChannelSet set{};
    std::shared_ptr<const Texture> texture;
};

/// The channel sets that the asset's aligned images make possible, in the order of ChannelSet, albedo left
/// out:
///   normal     from "normal"
///   roughness  from "roughness"; with "normal" it grows where bumps are filtered away: from level 1 on,
///   since
///              where two contents blend, a level-0 texel has one normal between theirs and nothing is lost
///   height     from "height"
///   moments    from "normal"
/// Images of other names make none. All of them show what `albedo` shows where it shows it. Normal maps have
/// x to the right and y up (OpenGL), 0.5 + 0.5·n in 255ths; of grey ones the red channel counts.
///
/// Normals do not filter linearly, so their slopes and the slopes' second moments are filtered instead:
/// Olano, Baker, "LEAN Mapping", I3D 2010. See lean.h for what becomes of them.
std::vector<Channels> make_channels(const std::shared_ptr<const ExchangeTexture>& albedo,
                                    const ExchangeAsset& asset);

/// How many textures as large as the albedo's these take, once they are looked at: what loading checks
/// beforehand.
std::size_t channel_textures(const ExchangeAsset& asset) noexcept;

}  // namespace tessera
