#pragma once

#include <gtest/gtest.h>

#include "server/texture/texture.h"

namespace tessera {

/// A region as it was evaluated, and what that did.
struct EvaluatedPage {
    LinearImage texels;
    Evaluation did;
};

inline EvaluatedPage page_of(const Texture& texture, const TexelRegion& region, Accuracy accuracy) {
    EvaluatedPage page;
    const auto did = texture.evaluate(region, {.accuracy = accuracy}, page.texels);
    EXPECT_TRUE(did);
    if (did) page.did = *did;
    return page;
}

}  // namespace tessera
