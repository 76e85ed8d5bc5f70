#pragma once

#include "server/pages/page_encoder.h"

namespace tessera {

/// A PNG of `image`, said to be sRGB where it is colour: RGB where every texel is opaque, else RGBA with
/// straight alpha. A single colour becomes a palette of one entry. The same bytes on every machine: the
/// filters are ours, and libdeflate's output does not depend on the instruction set.
EncodedBytes encode_png(const Rgba8Image& image, TexelKind kind);

}  // namespace tessera
