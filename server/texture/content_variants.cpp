#include "server/texture/unit_choice.h"
#include "shared/math/hash.h"

namespace tessera {

Variants content_variants(const Shapes& shapes, std::uint64_t seed, std::uint32_t types) {
    const std::size_t patches = shapes.patch_count();
    std::vector<std::uint8_t> contents(std::size_t{types} * patches);
    // For each patch a deck of the contents, as often as fits, shuffled in a stream of the patch's own
    std::vector<std::uint8_t> deck(types);
    for (std::size_t p = 0; p < patches; ++p) {
        const std::uint64_t key = stream("contents of a patch", p);
        const std::uint32_t count = shapes.first_of(p + 1) - shapes.first_of(p) + 1;
        for (std::uint32_t i = 0; i < types; ++i) {
            const std::uint32_t j = uniform_below(hash(seed, key, i, 0), i + 1);
            deck[i] = deck[j];
            deck[j] = static_cast<std::uint8_t>(i % count);
        }
        for (std::uint32_t type = 0; type < types; ++type) contents[type * patches + p] = deck[type];
    }

    Variants variants;
    std::vector<Shown> shown;
    for (std::uint32_t type = 0; type < types; ++type) {
        shown.clear();
        for (std::size_t p = 0; p < patches; ++p)
            if (const std::uint8_t content = contents[type * patches + p]; content > 0)
                shown.push_back({static_cast<std::uint16_t>(shapes.first_of(p) + content - 1), 0, 0});
        variants.add(shown);
    }
    return variants;
}

}  // namespace tessera
