// When a target comes near a rectangle of places, and when one was near it last: what tells how long a page
// stays as it is that no target is near.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "shared/motion/targets.h"

namespace tessera {

namespace {

__extension__ using Wide = __int128;

/// A target may be near the rectangle without being near one of its places, for no more steps than this.
constexpr std::int64_t most_steps_between = 64;

}  // namespace

/// One walk of a target past the rectangle. Its distance to it falls and then rises.
class TargetDistance::Approach {
  public:
    Approach(const TargetDistance& law, const MotionLattice& places, const MovingTarget::Walk& walk) noexcept
        : law_{law},
          places_{places},
          walk_{walk},
          last_{places.first.x + (places.columns - 1) * places.spacing,
                places.first.y + (places.rows - 1) * places.spacing} {
        const auto far = [](std::int64_t a, std::int64_t b, std::int64_t from, std::int64_t by) {
            return std::max(std::abs(a - from), std::abs(b - from)) + std::abs(by);
        };
        const Wide most = std::max(far(places.first.x, last_.x, walk.from.x, walk.by.x),
                                   far(places.first.y, last_.y, walk.from.y, walk.by.y));
        is_small_ = most * walk.steps < Wide{1} << 62 && Wide{law.reach()} * walk.steps < Wide{1} << 31;
    }

    /// Whether the rectangle is in reach, `moved` steps on.
    bool box_is_near(std::int64_t moved) const noexcept {
        return is_small_ ? box_near<std::int64_t>(moved) : box_near<Wide>(moved);
    }
    /// Whether one of the places is.
    bool is_near(std::int64_t moved) const noexcept {
        const auto below = [&](std::int64_t from, std::int64_t by, std::int64_t first, std::int64_t count) {
            return is_small_ ? place_below<std::int64_t>(from - first, by, moved, count)
                             : place_below<Wide>(from - first, by, moved, count);
        };
        const std::int64_t i = below(walk_.from.x, walk_.by.x, places_.first.x, places_.columns),
                           j = below(walk_.from.y, walk_.by.y, places_.first.y, places_.rows);
        for (std::int64_t row = j; row <= std::min(j + 1, places_.rows - 1); ++row)
            for (std::int64_t column = i; column <= std::min(i + 1, places_.columns - 1); ++column)
                if (law_.frame_on(
                        walk_,
                        {places_.first.x + column * places_.spacing, places_.first.y + row * places_.spacing},
                        moved) > 0)
                    return true;
        return false;
    }

    /// A step of [from, to] at which the rectangle is in reach, if there is any: the closest, or one beside
    /// it.
    std::optional<std::int64_t> closest(std::int64_t from, std::int64_t to) const noexcept {
        const double x = static_cast<double>(walk_.from.x), y = static_cast<double>(walk_.from.y);
        const double bx = static_cast<double>(walk_.by.x) / static_cast<double>(walk_.steps),
                     by = static_cast<double>(walk_.by.y) / static_cast<double>(walk_.steps);
        const double x0 = static_cast<double>(places_.first.x), x1 = static_cast<double>(last_.x),
                     y0 = static_cast<double>(places_.first.y), y1 = static_cast<double>(last_.y);
        const auto square = [&](double t) {
            const double dx = std::max({x0 - (x + bx * t), x + bx * t - x1, 0.0});
            const double dy = std::max({y0 - (y + by * t), y + by * t - y1, 0.0});
            return dx * dx + dy * dy;
        };
        const auto least = static_cast<double>(from), most = static_cast<double>(to);
        double best = least, best_square = square(least);
        const auto take = [&](double t) {
            t = std::clamp(t, least, most);
            if (const double other = square(t); other < best_square) best = t, best_square = other;
        };
        take(most);
        const auto take_sides = [&](double first, double last, double speed) {
            if (speed == 0) return;
            const double steps_a_texel = 1 / speed;
            take(first * steps_a_texel), take(last * steps_a_texel);
        };
        take_sides(x0 - x, x1 - x, bx), take_sides(y0 - y, y1 - y, by);
        if (const double length = bx * bx + by * by; length > 0) {
            const double along_x = bx / length, along_y = by / length;
            for (const double corner_x : {x0, x1})
                for (const double corner_y : {y0, y1})
                    take((corner_x - x) * along_x + (corner_y - y) * along_y);
        }
        // Its neighbours too: doubles are off by less
        const auto middle = static_cast<std::int64_t>(best);
        for (const std::int64_t t : {middle, middle + 1, middle - 1, middle + 2})
            if (t >= from && t <= to && box_is_near(t)) return t;
        return std::nullopt;
    }

    enum class Found : std::uint8_t { no, yes, unknown };
    /// The first step of [from, to] at which a place is in reach. None is at `from`, or before it.
    Found first_near(std::int64_t from, std::int64_t to, std::int64_t& found) const noexcept {
        const auto near = closest(from, to);
        if (!near) return Found::no;
        std::int64_t outside = from - 1, inside = *near;
        while (inside - outside > 1) {
            const std::int64_t middle = outside + (inside - outside) / 2;
            (box_is_near(middle) ? inside : outside) = middle;
        }
        for (found = inside; found <= to && box_is_near(found); ++found) {
            if (is_near(found)) return Found::yes;
            if (found - inside > most_steps_between) return Found::unknown;
        }
        return Found::no;
    }
    /// The last one.
    Found last_near(std::int64_t from, std::int64_t to, std::int64_t& found) const noexcept {
        const auto near = closest(from, to);
        if (!near) return Found::no;
        std::int64_t outside = to + 1, inside = *near;
        while (outside - inside > 1) {
            const std::int64_t middle = inside + (outside - inside) / 2;
            (box_is_near(middle) ? inside : outside) = middle;
        }
        for (found = inside; found >= from && box_is_near(found); --found) {
            if (is_near(found)) return Found::yes;
            if (inside - found > most_steps_between) return Found::unknown;
        }
        return Found::no;
    }

  private:
    /// The last of `count` places along an axis that the target is at or beyond; the first if there is none.
    /// `from`: where its walk begins, from the first of them.
    template <class Integer>
    std::int64_t place_below(Integer from, Integer by, std::int64_t moved,
                             std::int64_t count) const noexcept {
        const Integer steps = walk_.steps, way = by * moved;
        const Integer at = from + way / steps - (way % steps < 0 ? 1 : 0);
        const Integer index = at < 0 ? Integer{0} : at / places_.spacing;
        return static_cast<std::int64_t>(std::min<Integer>(index, count - 1));
    }

    /// In parts of walk_.steps of a texel.
    template <class Integer>
    bool box_near(std::int64_t moved) const noexcept {
        const Integer steps = walk_.steps, reach = law_.reach() * steps;
        const auto off = [&](std::int64_t from, std::int64_t by, std::int64_t least, std::int64_t most) {
            const Integer along = static_cast<Integer>(by) * moved;
            return std::max({static_cast<Integer>(least - from) * steps - along,
                             along - static_cast<Integer>(most - from) * steps, Integer{0}});
        };
        const Integer x = off(walk_.from.x, walk_.by.x, places_.first.x, last_.x);
        const Integer y = off(walk_.from.y, walk_.by.y, places_.first.y, last_.y);
        return x <= reach && y <= reach && x * x + y * y <= reach * reach;
    }

    const TargetDistance& law_;
    const MotionLattice& places_;
    MovingTarget::Walk walk_;
    MotionPoint last_;
    bool is_small_ = false;  ///< 64 bits hold it.
};

std::optional<Validity> TargetDistance::rest_of(const MotionLattice& places, Step step) const noexcept {
    Validity rest;
    if (reach_.empty()) return rest;
    const MotionPoint last{places.first.x + (places.columns - 1) * places.spacing,
                           places.first.y + (places.rows - 1) * places.spacing};
    using Found = Approach::Found;
    for (const MovingTarget& target : *targets_) {
        if (!ever_near(target, places.first, last)) continue;
        const MovingTarget::Walk now = target.walk_at(step);
        const std::int64_t moved = step - now.begin;
        if (Approach{*this, places, now}.box_is_near(moved)) return std::nullopt;
        std::int64_t found = 0;
        // Onwards, until it comes near or has come round, or another did so earlier
        MovingTarget::Walk walk = now;
        for (std::int64_t from = moved;;) {
            const Found near = Approach{*this, places, walk}.first_near(from, walk.steps, found);
            if (near == Found::unknown) return std::nullopt;
            if (near == Found::yes) {
                rest.until = std::min(rest.until, add_steps(walk.begin, found));
                break;
            }
            const Step next = add_steps(walk.begin, walk.steps);
            if (next >= rest.until || next >= add_steps(step, target.round_steps())) break;
            walk = target.walk_at(next);
            from = 0;
        }
        walk = now;
        for (std::int64_t to = moved;;) {
            const Found near = Approach{*this, places, walk}.last_near(0, to, found);
            if (near == Found::unknown) return std::nullopt;
            if (near == Found::yes) {
                rest.from = std::max(rest.from, add_steps(walk.begin, found + 1));
                break;
            }
            if (walk.begin <= rest.from || walk.begin <= add_steps(step, -target.round_steps())) break;
            walk = target.walk_at(walk.begin - 1);
            to = walk.steps;
        }
    }
    return rest;
}

}  // namespace tessera
