#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "server/pattern/draw_law.h"
#include "server/pattern/texel_range.h"
#include "server/texture/texture.h"

namespace tessera {

struct Layer {
    std::shared_ptr<const Texture> texture;
    TexelRange range;
};

/// Layers, from the ground up, composited with premultiplied over: at level 0 exactly; above, texel by texel
/// from the layers' own filtered texels, with certain limits (mean_products.h), and deeper where that is not
/// good enough (descent.h). Exact where at most one layer varies. At least one layer. `law`: of the whole.
std::shared_ptr<const Texture> make_layered_texture(std::vector<Layer> layers,
                                                    const std::optional<DrawLaw>& law = {});

}  // namespace tessera
