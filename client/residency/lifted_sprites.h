#pragma once

#include <cstdint>
#include <vector>

#include "client/residency/page_holds.h"

namespace tessera {

/// A sprite that a hand holds, and where the pages have it.
struct LiftedSprite {
    std::uint64_t id = 0;
    TexelBox box;
    auto operator<=>(const LiftedSprite& other) const { return id <=> other.id; }
    bool operator==(const LiftedSprite&) const = default;
};

/// What a page is to be without.
struct LiftedFrom {
    std::vector<LiftedSprite> without{};  ///< In the order of their ids
    std::uint64_t made_revision = 0;      ///< What edits of holds up to this one changed is in it
    bool operator==(const LiftedFrom&) const = default;
};

/// Sprites that a page may be without; servers take no more.
inline constexpr std::size_t most_lifted = 64;

/// All that some hold lifts from a page, in the order of the ids.
std::vector<LiftedSprite> all_lifted(PageKey page, const std::vector<const PageHold*>& holds);

/// What to ask for of a page. Where edits have made some of the holds so and others have not, only what the
/// latter lift is left out: the first are drawn where the page has them, and it is right without them too.
LiftedFrom lifted_from(PageKey page, const std::vector<const PageHold*>& holds);

/// How a stand-in made like this would show a page (its own or a finer one) under these holds.
enum class Shows {
    right,
    twice,  ///< A sprite that is in a hand.
    less,   ///< Than it should: a sprite that no hand holds.
};
Shows shows(const LiftedFrom& made, PageKey page, const std::vector<const PageHold*>& holds);

}  // namespace tessera
