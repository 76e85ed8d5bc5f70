#include "client/view/hand/carries.h"

#include <algorithm>
#include <set>

namespace tessera {
namespace {

/// Whether its texels lie on texels: servers copy it then.
bool lies_on_texels(const HandSprite& sprite, const SpritePosition& at) {
    const std::int64_t half = std::int64_t{sprite.side_texels} * sprite_units / 2;
    return sprite.scale == sprite_scale_one && sprite.turn % 16384 == 0 &&
           (at.x - half) % sprite_units == 0 && (at.y - half) % sprite_units == 0;
}

struct Shown {
    const HandSprite* sprite;
    Carries::Id carry;  ///< 0: the pages show it.
};

/// What lies over what is shown, and what lies over that, but for those whose frames are not known.
void add_above(std::vector<Shown>& shown, const std::set<SpriteId>& known, Step step,
               const SpriteAnimations& animations, std::span<const HandSprite* const> others) {
    std::vector<TexelBox> boxes;
    TexelBox around;
    for (const Shown& one : shown) {
        const HandSprite resting = resting_at(*one.sprite, step);
        boxes.push_back(box_around(std::span{&resting, 1}, step));
        around = hull(around, boxes.back());
    }
    std::vector<Shown> all;
    std::size_t above = 0, next = 0;
    for (const HandSprite* other : others) {
        for (; next < shown.size() && drawn_before(*shown[next].sprite, *other); ++next)
            all.push_back(shown[next]);
        const bool is_unknown = other->animation && !has_frames(*other, animations);
        if (all.empty() || above == Carries::most_above || is_unknown || known.contains(other->id) ||
            !there_at(*other, step))
            continue;
        const TexelBox box = box_around(std::span{other, 1}, step);
        if (!box.meets(around)) continue;
        // Those of `boxes` that are drawn before it: all that were passed, and all that were added
        const auto met = [&](std::size_t first, std::size_t end) {
            return std::any_of(boxes.begin() + static_cast<std::ptrdiff_t>(first),
                               boxes.begin() + static_cast<std::ptrdiff_t>(end),
                               [&](const TexelBox& one) { return one.meets(box); });
        };
        if (!met(0, next) && !met(shown.size(), boxes.size())) continue;
        all.push_back({other, 0});
        boxes.push_back(box);
        around = hull(around, box);
        ++above;
    }
    all.insert(all.end(), shown.begin() + static_cast<std::ptrdiff_t>(next), shown.end());
    shown = std::move(all);
}

}  // namespace

HeldSprite held_sprite(const HandSprite& sprite, Step step, const SpriteAnimations& animations) {
    const SpritePosition at = position_at(sprite, step);
    return {.pattern = shown_pattern(sprite, step, animations),
            .middle = plane_point({at.x, at.y}),
            .scale = sprite.scale / double{sprite_scale_one},
            .turns = sprite.turn / 65536.0,
            .sharp = lies_on_texels(sprite, at)};
}

Carries::Carry* Carries::find_carry(Id carry) {
    const auto found = std::ranges::find(all_, carry, &Carry::id);
    return found == all_.end() ? nullptr : &*found;
}

const Carries::Carry* Carries::find_carry(Id carry) const {
    const auto found = std::ranges::find(all_, carry, &Carry::id);
    return found == all_.end() ? nullptr : &*found;
}

Carries::Id Carries::begin(std::vector<HandSprite> taken, std::vector<HandSprite> now) {
    all_.push_back({.id = ++last_, .taken = std::move(taken), .now = std::move(now)});
    return last_;
}

void Carries::drag(Id carry, std::vector<HandSprite> now) {
    if (Carry* one = find_carry(carry)) one->now = std::move(now);
}

void Carries::drop(Id carry) {
    std::erase_if(all_, [&](const Carry& one) { return one.id == carry; });
}

void Carries::sent(Id carry) {
    if (Carry* one = find_carry(carry)) one->is_sent = true;
}

void Carries::made(Id carry, std::uint64_t revision, std::vector<TexelBox> dirty, ClientTime now) {
    Carry* one = find_carry(carry);
    if (!one) return;
    one->revision = revision;
    one->dirty = std::move(dirty);
    one->made_at = now;
}

void Carries::end(std::span<const std::uint32_t> holds) {
    for (const std::uint32_t id : holds) drop(id);
}

void Carries::tidy(ClientTime now) {
    std::erase_if(all_,
                  [&](const Carry& one) { return one.revision != 0 && now - one.made_at > longest_melt; });
}

std::span<const HandSprite> Carries::taken(Id carry) const {
    const Carry* one = find_carry(carry);
    return one ? std::span<const HandSprite>{one->taken} : std::span<const HandSprite>{};
}

std::span<const HandSprite> Carries::now(Id carry) const {
    const Carry* one = find_carry(carry);
    return one ? std::span<const HandSprite>{one->now} : std::span<const HandSprite>{};
}

const HandSprite* Carries::find(SpriteId id) const {
    for (auto one = all_.rbegin(); one != all_.rend(); ++one) {
        const auto found = std::ranges::find(one->now, id, &HandSprite::id);
        if (found != one->now.end()) return &*found;
        if (std::ranges::find(one->taken, id, &HandSprite::id) != one->taken.end()) return nullptr;
    }
    return nullptr;
}

bool Carries::is_gone(SpriteId id) const {
    for (auto one = all_.rbegin(); one != all_.rend(); ++one) {
        if (std::ranges::find(one->now, id, &HandSprite::id) != one->now.end()) return false;
        if (std::ranges::find(one->taken, id, &HandSprite::id) != one->taken.end()) return true;
    }
    return false;
}

std::vector<HeldSprite> Carries::held(Step step, const SpriteAnimations& animations,
                                      std::span<const HandSprite* const> others) const {
    std::vector<Shown> shown;
    std::set<SpriteId> known;
    for (auto one = all_.rbegin(); one != all_.rend(); ++one) {
        for (const HandSprite& sprite : one->now)
            if (known.insert(sprite.id).second && there_at(sprite, step)) shown.push_back({&sprite, one->id});
        for (const HandSprite& sprite : one->taken) known.insert(sprite.id);
    }
    std::ranges::sort(shown,
                      [](const Shown& a, const Shown& b) { return drawn_before(*a.sprite, *b.sprite); });
    if (!shown.empty()) add_above(shown, known, step, animations, others);
    std::vector<HeldSprite> held;
    held.reserve(shown.size());
    for (const Shown& one : shown)
        held.emplace_back(held_sprite(*one.sprite, step, animations)).hold = one.carry;
    return held;
}

std::vector<PageHold> Carries::holds() const {
    std::vector<PageHold> holds;
    for (const Carry& carry : all_) {
        PageHold& hold = holds.emplace_back();
        hold.id = carry.id;
        hold.waits = carry.is_sent;
        hold.revision = carry.revision;
        for (const HandSprite& sprite : carry.taken) {
            hold.lifted.push_back(sprite.id);
            hold.lifted_boxes.push_back(box_of(sprite));
        }
        if (carry.revision != 0) {
            hold.boxes = carry.dirty;
            continue;
        }
        hold.boxes = hold.lifted_boxes;
        for (const HandSprite& sprite : carry.now) hold.boxes.push_back(box_of(sprite));
    }
    return holds;
}

}  // namespace tessera
