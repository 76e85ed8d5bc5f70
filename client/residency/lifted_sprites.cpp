#include "client/residency/lifted_sprites.h"

#include <algorithm>

namespace tessera {
namespace {

template <class Visit>
void for_lifted(PageKey page, const PageHold& hold, Visit visit) {
    const TexelBox box = box_of_page(page);
    for (std::size_t i = 0; i < std::min(hold.lifted.size(), hold.lifted_boxes.size()); ++i)
        if (box.meets(hold.lifted_boxes[i])) visit(LiftedSprite{hold.lifted[i], hold.lifted_boxes[i]});
}

void put_in_order(std::vector<LiftedSprite>& sprites) {
    std::ranges::sort(sprites, {}, &LiftedSprite::id);
    const auto rest = std::ranges::unique(sprites, {}, &LiftedSprite::id);
    sprites.erase(rest.begin(), rest.end());
}

bool has(const std::vector<LiftedSprite>& sprites, std::uint64_t id) {
    return std::ranges::binary_search(sprites, id, {}, &LiftedSprite::id);
}

}  // namespace

std::vector<LiftedSprite> all_lifted(PageKey page, const std::vector<const PageHold*>& holds) {
    std::vector<LiftedSprite> all;
    for (const PageHold* hold : holds)
        for_lifted(page, *hold, [&](const LiftedSprite& sprite) { all.push_back(sprite); });
    put_in_order(all);
    return all;
}

LiftedFrom lifted_from(PageKey page, const std::vector<const PageHold*>& holds) {
    LiftedFrom made;
    for (const PageHold* hold : holds) {
        if (hold->revision == 0)
            for_lifted(page, *hold, [&](const LiftedSprite& sprite) { made.without.push_back(sprite); });
        else if (meets_any(box_of_page(page), hold->boxes))
            made.made_revision = std::max(made.made_revision, hold->revision);
    }
    put_in_order(made.without);
    if (made.without.empty()) return {all_lifted(page, holds), 0};
    return made;
}

Shows shows(const LiftedFrom& made, PageKey page, const std::vector<const PageHold*>& holds) {
    const std::vector<LiftedSprite> held = all_lifted(page, holds);
    const TexelBox box = box_of_page(page);
    for (const LiftedSprite& sprite : made.without)
        if (box.meets(sprite.box) && !has(held, sprite.id)) return Shows::less;
    bool twice = false;
    for (const PageHold* hold : holds)
        for_lifted(page, *hold, [&](const LiftedSprite& sprite) {
            const bool is_made_so = hold->revision != 0 && made.made_revision >= hold->revision;
            twice = twice || !(is_made_so || has(made.without, sprite.id));
        });
    return twice ? Shows::twice : Shows::right;
}

}  // namespace tessera
