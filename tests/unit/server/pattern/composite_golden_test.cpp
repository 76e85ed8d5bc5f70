// The same bits on every compiler, optimisation and instruction set: sums of a few regions, as they were
// found once.
#include <bit>

#include <gtest/gtest.h>

#include "server/pattern/pattern_texture.h"
#include "server/texture/constant_texture.h"
#include "tests/unit/server/pattern/laws.h"
#include "tests/unit/server/pattern/made_programs.h"

namespace tessera {
namespace {

using namespace testing;

std::uint64_t digest(const Texture& texture) {
    std::uint64_t sum = 0;
    for (const int level : {0, 1, 3, 6, 9})
        for (const float value :
             evaluated(texture, {std::uint8_t(level), -20, 333, 40, 36}, Accuracy::high).values)
            sum = mix(sum + std::bit_cast<std::uint32_t>(value));
    return sum;
}

ReferencePlan turned(bool independent, bool overflow) {
    return {made_grid(5), made_patterns(16, 3),
            std::make_shared<MadeProgram>(made_looks(256, 3, 16, 3), independent),
            made_transform(16, {0.5, 0.77, 1.2}, overflow)};
}

ReferencePlan filled(int cell_log2, bool opaque) {
    auto looks = made_looks(256, 4, 1, 1);
    if (opaque)
        for (Look& look : looks) look.pattern = std::max(look.pattern, 0);
    return {made_grid(cell_log2, 256, std::uint64_t(cell_log2)), made_patterns(1 << cell_log2, 4, 1, opaque),
            std::make_shared<MadeProgram>(looks, false), nullptr};
}

template <class... Textures>
std::uint64_t digest_of(const Textures&... textures) {
    Plan plan;
    (plan.textures.push_back({"t", textures}), ...);
    return digest(*make_pattern_texture(plan));
}

TEST(Composites, GoldenBits) {
    EXPECT_EQ(digest_of(turned(false, false)), 18353181442488505986u);
    EXPECT_EQ(digest_of(turned(true, false)), 10904680010893317479u);
    EXPECT_EQ(digest_of(turned(true, true)), 13725555158032121153u);
    EXPECT_EQ(digest_of(filled(4, true), turned(false, false), LayersPlan{{0, 1}}), 13443981757783944062u);
    std::vector<std::int32_t> values;
    for (int i = 0; i < 45; ++i) values.push_back(i * i % 7 % 3);
    auto map = std::make_shared<StoredMap>();
    *map = {.width = 9, .height = 5, .values = values, .edge = StoredMap::Edge::wrap, .cells_log2 = 2};
    EXPECT_EQ(digest_of(filled(4, true), filled(5, false),
                        GivenPlan{make_constant_texture({80, 90, 255, 255})}, PixelMapPlan{map, {0, 1, 2}}),
              9514456529239632417u);
}

}  // namespace
}  // namespace tessera
