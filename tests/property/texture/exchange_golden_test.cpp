#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <map>
#include <string>

#include "server/texture/kernels.h"
#include "tests/property/texture/exchange_pages.h"

namespace tessera {
namespace {

using tests::codes;
using tests::make_synthetic_asset;

TEST(ExchangeGolden, EveryInstructionSetGivesTheSameBytes) {
    // FNV-1a over one page of each way to evaluate. Raise evaluator_version (server/scene/fingerprint.cpp)
    // when these change.
    const ExchangeAsset asset =
        make_synthetic_asset({.tile_side = 128, .patches = 30, .contents = 7, .blend_texels = 8});
    const auto typed = make_exchange_texture(asset, {.seed = 2026});
    const auto independent = make_exchange_texture(asset, {.seed = 2026, .choice = Choice::independent});
    const ExchangeAsset patches = tests::make_synthetic_interchange({.patches = 200});
    const auto interchange = make_exchange_texture(patches, {.seed = 2026, .types = 64});
    const auto kolar = make_exchange_texture(patches, {.seed = 2026, .choice = Choice::kolar});
    const auto wang = make_exchange_texture(tests::make_synthetic_wang({}), {.seed = 2026, .types = 64});
    const auto hash_of = [&](const Texture& texture, std::uint8_t level, std::int32_t side) {
        const Rgba8Image page = codes(texture, {level, -300, 77, side, side});
        std::uint64_t h = 0xcbf29ce484222325u;
        for (const std::uint8_t byte : page.bytes) h = (h ^ byte) * 0x100000001b3u;
        return h;
    };
    if (const char* asked = std::getenv("TESSERA_KERNELS")) {
        const KernelList list = available_kernels();
        const bool available = std::any_of(list.items, list.items + list.count,
                                           [&](const Kernels* k) { return std::string{k->name} == asked; });
        EXPECT_EQ(available, std::string{kernels().name} == asked);
        if (!available)
            std::cout << "This processor lacks " << asked << "; tested " << kernels().name << " instead\n";
    }
    const auto expect = [&](const Texture& texture, std::int32_t side,
                            const std::map<int, std::uint64_t>& golden) {
        for (const auto& [level, expected] : golden)
            EXPECT_EQ(hash_of(texture, static_cast<std::uint8_t>(level), side), expected)
                << texture.kind() << ", level " << level;
    };
    expect(*typed, 264,
           {{0, 17560310496679043940u},
            {1, 3053456330696986945u},
            {3, 14341894892491646556u},
            {5, 16147777811767766030u},
            {7, 1183169205514748749u},
            {15, 5834916224373319461u}});
    expect(*independent, 64,
           {{0, 15342631789067391047u},
            {4, 10738616608029685732u},
            {7, 15720084498647707819u},
            {8, 13734359368375779633u},
            {20, 3871475367914185509u}});
    expect(*interchange, 264,
           {{0, 3357954405446415724u},
            {2, 16105001816997495996u},
            {5, 12420483317608146460u},
            {8, 16359884047706111190u},
            {20, 11517562437440240293u}});
    expect(*kolar, 64,
           {{0, 9991239574444758533u},
            {3, 2554564605730996358u},
            {7, 970311202921875993u},
            {20, 15578437444352647973u}});
    expect(*wang, 264, {{0, 17581993318018745531u}, {4, 8418642413948361472u}, {9, 284458875325107527u}});
}

}  // namespace
}  // namespace tessera
