#include <gtest/gtest.h>

#include "server/pattern/cell_texture.h"
#include "tests/support/made_patterns.h"

namespace tessera {
namespace {

/// Page = reduction of its four children, for typed cells at every level, wherever the page is.
TEST(TypedLaws, APageIsTheReductionOfItsChildrenAtEveryLevel) {
    for (const std::int32_t side : {1, 4, 64}) {
        const auto texture = make_cell_texture(made_typed_plan(made_patterns(side, 16), 4096));
        for (std::uint8_t level = 1; level <= max_level; ++level) {
            const std::int64_t far = std::int64_t{1} << (38 - level);
            for (const std::int64_t x : {std::int64_t{0}, std::int64_t{-300}, far - 128, far * 4}) {
                const TexelRegion region{level, x, -x + 77, 64, 64, 0};
                LinearImage page, below;
                ASSERT_TRUE(texture->evaluate(region, {}, page));
                ASSERT_TRUE(texture->evaluate(children_of(region), {}, below));
                ASSERT_LT(difference_codes(page, halved(below)), 0.02)
                    << "patterns of " << side << ", level " << int{level} << ", x " << x;
                Rgba8Image codes, reduced;
                ASSERT_TRUE(texture->evaluate(region, {}, codes));
                encode(halved(below), reduced);
                ASSERT_LE(difference_of_codes(codes, reduced), 1) << int{level};
            }
        }
    }
}

}  // namespace
}  // namespace tessera
