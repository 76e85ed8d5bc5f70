// When any place of a rectangle shows another frame: what tells how long a page stays as it is.
//
// On each leg a target walks straight, so that the places which come into a ring about it between two steps
// lie in the hull of the ring's discs at both, and those that leave it do not lie in both discs. Row by row
// these are stretches, mostly empty; the few places in them are asked, and every answer makes them shorter.
#include <algorithm>
#include <array>
#include <cmath>

#include "shared/motion/targets.h"
#include "shared/motion/walk_times.h"

namespace tessera {

namespace {

/// Doubles only pick which places are asked: from so much further than need be, in texels.
constexpr double margin = 0.01;

/// Rows that are looked at for one ring on one walk: some milliseconds.
constexpr std::int64_t most_rows = 1 << 16;

/// Columns of a row, from the first to the last.
struct Columns {
    std::int64_t first = 0, last = -1;
    bool empty() const noexcept { return first > last; }
    bool operator==(const Columns&) const = default;
};

}  // namespace

class TargetDistance::Search {
  public:
    struct Near {
        const MovingTarget* target;
        MovingTarget::Walk walk;  ///< At the step.
    };

    /// `near`: those that may come near any of the places.
    Search(const TargetDistance& law, const MotionLattice& places, std::span<const Near> near, Step step,
           Validity& found) noexcept
        : law_{law},
          near_{near},
          places_{places},
          step_{step},
          found_{found},
          spacing_{static_cast<double>(places.spacing)},
          per_spacing_{1 / spacing_},
          width_{static_cast<double>(places.columns - 1) * spacing_},
          height_{static_cast<double>(places.rows - 1) * spacing_},
          held_{0} {
        for (const Near& target : near) hold(target);
    }

    /// Narrows what was found to the steps in which none of the places changes because one of them moves.
    void look_at(const Near& near) {
        const MovingTarget& target = *near.target;
        MovingTarget::Walk walk = near.walk;
        const std::array now{Part{*this, walk, step_ - walk.begin, true},
                             Part{*this, walk, step_ - walk.begin, false}};
        look_around(now);
        while (add_steps(walk.begin, walk.steps) < found_.until) {
            walk = target.walk_at(add_steps(walk.begin, walk.steps));
            look_around(std::array{Part{*this, walk, 0, true}});
        }
        for (walk = near.walk; walk.begin > found_.from;) {
            walk = target.walk_at(walk.begin - 1);
            look_around(std::array{Part{*this, walk, walk.steps, false}});
        }
    }

  private:
    /// Where one target keeps all places inside a ring, as long as is looked, no other changes them there.
    void hold(const Near& near) noexcept {
        const Part part{*this, near.walk, step_ - near.walk.begin, true};
        const double steps = static_cast<double>(std::max(found_.until - step_, step_ - found_.from));
        const double x = std::max(part.x, width_ - part.x), y = std::max(part.y, height_ - part.y);
        const double most = std::sqrt(x * x + y * y) + near.target->speed() * steps + margin;
        while (held_ < law_.reach_.size() && static_cast<double>(law_.reach_[held_]) > most) ++held_;
    }

    /// A walk from a place of it on, or back from there.
    struct Part {
        Part(const Search& of, const MovingTarget::Walk& along, std::int64_t moved, bool on) noexcept
            : walk{along}, begin{moved}, onwards{on} {
            const auto steps = static_cast<double>(walk.steps);
            const double share = static_cast<double>(moved) / steps, sign = on ? 1 : -1;
            x = static_cast<double>(walk.from.x - of.places_.first.x) +
                static_cast<double>(walk.by.x) * share;
            y = static_cast<double>(walk.from.y - of.places_.first.y) +
                static_cast<double>(walk.by.y) * share;
            by_x = sign * static_cast<double>(walk.by.x) / steps;
            by_y = sign * static_cast<double>(walk.by.y) / steps;
            speed = std::sqrt(by_x * by_x + by_y * by_y);
        }
        MovingTarget::Walk walk;
        std::int64_t begin;
        bool onwards;
        double x, y, by_x, by_y,
            speed;  ///< Where it begins, from the first of the places, and texels a step.
    };
    /// How many steps of it matter still.
    double steps_of(const Part& part) const noexcept {
        const std::int64_t steps =
            part.onwards ? std::min(part.walk.steps, found_.until - 1 - part.walk.begin) - part.begin
                         : part.begin - std::max<std::int64_t>(0, found_.from - part.walk.begin);
        return static_cast<double>(std::max<std::int64_t>(0, steps));
    }

    /// Parts that begin at the same place.
    template <std::size_t count>
    void look_around(const std::array<Part, count>& parts) {
        for (ring_ = held_; ring_ < law_.reach_.size(); ++ring_) {
            const auto radius = static_cast<double>(law_.reach_[ring_]);
            double way = way_of(parts);
            if (!may_pass(parts, radius, way)) continue;
            Rows rows = rows_of(parts, radius, way);
            std::int64_t looked = 0;
            const auto look_at = [&](std::int64_t row) {
                if (++looked > most_rows) {
                    // Nobody waits for that: it stays so for this step
                    found_.meet({step_, add_steps(step_, 1)});
                    way = 0;
                    return;
                }
                if (!look_at_row(parts, radius, way, row)) return;
                way = way_of(parts);
                rows = rows_of(parts, radius, way);
            };
            // Found nearer by, less is to be looked at further off
            for (std::int64_t row = rows.up; row >= rows.first && way > 0; --row) look_at(row);
            for (std::int64_t row = rows.down; row <= rows.last && way > 0; ++row) look_at(row);
        }
    }
    /// Rows that a ring may meet: from `up` on to the first, and from `down` on to the last. All places of
    /// those between stay inside.
    struct Rows {
        std::int64_t first, up, down, last;
    };
    template <std::size_t count>
    Rows rows_of(const std::array<Part, count>& parts, double radius, double way) const noexcept {
        const Part& begin = parts.front();
        double least = begin.y, most = begin.y;
        for (const Part& part : parts) {
            const double end = part.y + part.by_y * steps_of(part);
            least = std::min(least, end);
            most = std::max(most, end);
        }
        const auto row_at = [&](double y) {
            return static_cast<std::int64_t>(
                std::clamp(y * per_spacing_, -1.0, static_cast<double>(places_.rows)));
        };
        Rows rows{row_at(least - radius - margin), 0, 0,
                  std::min(row_at(most + radius + margin), places_.rows - 1)};
        rows.first = std::max<std::int64_t>(rows.first, 0);
        const double inner = radius - way - margin, far_x = std::max(begin.x, width_ - begin.x);
        const double kept = inner > far_x ? std::sqrt(inner * inner - far_x * far_x) : 0;
        rows.up = std::min(row_at(begin.y - kept) + 1, places_.rows - 1);
        rows.down = std::max(kept > 0 ? row_at(begin.y + kept) : rows.up + 1, rows.up + 1);
        return rows;
    }
    template <std::size_t count>
    double way_of(const std::array<Part, count>& parts) const noexcept {
        double way = 0;
        for (const Part& part : parts) way = std::max(way, part.speed * steps_of(part));
        return way;
    }
    /// Whether a part's discs come to the rectangle at all.
    bool comes_near(const Part& part, double radius) const noexcept {
        const double steps = steps_of(part), reach = radius + margin;
        const auto overlaps = [&](double from, double by, double size) {
            const double to = from + by * steps;
            return std::max(from, to) + reach >= 0 && std::min(from, to) - reach <= size;
        };
        return overlaps(part.x, part.by_x, width_) && overlaps(part.y, part.by_y, height_);
    }
    /// Whether a ring may pass any of the places: neither all are further off, nor all inside.
    template <std::size_t count>
    bool may_pass(const std::array<Part, count>& parts, double radius, double way) const noexcept {
        if (std::none_of(parts.begin(), parts.end(),
                         [&](const Part& part) { return comes_near(part, radius); }))
            return false;
        const double x = parts.front().x, y = parts.front().y;
        if (way == 0) return false;
        const double near_x = std::max({-x, x - width_, 0.0}), near_y = std::max({-y, y - height_, 0.0});
        const double far_x = std::max(x, width_ - x), far_y = std::max(y, height_ - y);
        const double outer = radius + way + margin, inner = radius - way - margin;
        return near_x * near_x + near_y * near_y <= outer * outer &&
               !(inner > 0 && far_x * far_x + far_y * far_y < inner * inner);
    }

    /// Columns between two x.
    Columns between(double left, double right) const noexcept {
        // Truncated: what is below 0 or far beyond is cut first
        left = std::clamp(left * per_spacing_, -1.0, static_cast<double>(places_.columns));
        right = std::clamp(right * per_spacing_, -1.0, static_cast<double>(places_.columns));
        auto first = static_cast<std::int64_t>(left), last = static_cast<std::int64_t>(right);
        if (static_cast<double>(first) < left) ++first;
        if (static_cast<double>(last) > right) --last;
        return {std::max<std::int64_t>(first, 0), std::min(last, places_.columns - 1)};
    }
    Columns disc(double x, double off_y, double radius) const noexcept {
        const double square = radius * radius - off_y * off_y;
        if (radius < 0 || square < 0) return {};
        const double half = std::sqrt(square);
        const Columns columns = between(x - half, x + half);
        return columns.empty() ? Columns{} : columns;
    }
    /// Whether a row has any column between two circles, were there more of them than it has: mostly not, and
    /// that is told sooner than which.
    bool may_hold_places(double x, double off_y, double inner, double outer) const noexcept {
        // As far as doubles count columns far more finely than the margin
        constexpr double most = 1 << 20;
        if (outer > most || std::abs(x) > most) return true;
        const double wide = outer * outer - off_y * off_y, hole = inner * inner - off_y * off_y;
        if (wide < 0) return false;
        const auto holds = [&](double from, double to) {
            // The column next to their middle
            constexpr double whole = 3LL << 51;
            const double middle = (from + to) / 2 * per_spacing_;
            return std::abs(middle - (middle + whole - whole)) <= (to - from) / 2 * per_spacing_;
        };
        const double far = std::sqrt(wide);
        // Where the inner one does not come to the row, all of the outer one's
        const double near = inner > 0 && hole > 0 ? std::sqrt(hole) : -far;
        return holds(x - far, x - near) || holds(x + near, x + far);
    }
    /// Of the hull of two discs that are `steps` steps apart.
    Columns hull(const Part& part, double steps, double y, double radius) const noexcept {
        double left = HUGE_VAL, right = -HUGE_VAL;
        const double end_x = part.x + part.by_x * steps, end_y = part.y + part.by_y * steps;
        const auto add_disc = [&](double x, double off_y) {
            const double square = radius * radius - off_y * off_y;
            if (square < 0) return;
            const double half = std::sqrt(square);
            left = std::min(left, x - half);
            right = std::max(right, x + half);
        };
        add_disc(part.x, y - part.y);
        add_disc(end_x, y - end_y);
        const double aside_x = -part.by_y / part.speed * radius, aside_y = part.by_x / part.speed * radius;
        for (const double sign : {-1.0, 1.0}) {
            const double from = part.y + sign * aside_y, to = end_y + sign * aside_y;
            if ((y < from) == (y < to)) continue;
            const double x = part.x + sign * aside_x + (y - from) / (to - from) * (end_x - part.x);
            left = std::min(left, x);
            right = std::max(right, x);
        }
        if (left > right) return {};
        const Columns columns = between(left, right);
        return columns.empty() ? Columns{} : columns;
    }

    /// Whether the ring may pass a place, counted from the first one, on a part as far as that matters still.
    /// The walk's distance to it falls and rises: it is inside between two moments.
    bool may_change(const Part& part, double place_x, double place_y, double radius) const noexcept {
        const double steps = steps_of(part);
        if (steps == 0) return false;
        const double x = place_x - part.x, y = place_y - part.y, square = x * x + y * y;
        const double least = radius - margin, most = radius + margin;
        const bool inside = square < least * least && least > 0;
        // From far off, doubles cannot tell a target that grazes the ring from one that passes it
        constexpr double near = 65536;
        if ((!inside && square <= most * most) || square > near * near) return true;
        const double along = x * part.by_x + y * part.by_y, speeds = part.speed * part.speed;
        const double reach = inside ? least : most;
        // Times the speed's square, of the way along: where the ring comes to it, or leaves it
        const double half = along * along - speeds * (square - reach * reach);
        if (half < 0 || (!inside && along < 0)) return false;
        return (inside ? along + std::sqrt(half) : along - std::sqrt(half)) <= steps * speeds;
    }

    /// Looks at a row, whose places a ring may pass on such a way. Whether something was found there.
    template <std::size_t count>
    bool look_at_row(const std::array<Part, count>& parts, double radius, double way, std::int64_t row) {
        constexpr std::int64_t few = 8;
        const double y = static_cast<double>(row) * spacing_;
        const Part& first = parts.front();
        if (!may_hold_places(first.x, y - first.y, radius - way - margin, radius + way + margin))
            return false;
        const Columns outer = disc(first.x, y - first.y, radius + way + margin),
                      inner = disc(first.x, y - first.y, radius - way - margin);
        if (outer == inner) return false;
        const Validity before = found_;
        const Columns left{outer.first, inner.empty() ? outer.last : inner.first - 1},
            right{inner.empty() ? outer.last + 1 : inner.last + 1, outer.last};
        if (left.last - left.first + right.last - right.first + 2 > few)
            look_at_long_row(parts, radius, row);
        else
            for (const Columns& columns : {left, right})
                for (std::int64_t column = columns.first; column <= columns.last; ++column)
                    for (const Part& part : parts)
                        if (may_change(part, static_cast<double>(column) * spacing_, y, radius))
                            ask_place(column, row, part);
        return !(found_ == before);
    }

    template <std::size_t count>
    void look_at_long_row(const std::array<Part, count>& parts, double radius, std::int64_t row) {
        const double y = static_cast<double>(row) * spacing_;
        const Part& first = parts.front();
        const Columns inside = disc(first.x, y - first.y, radius - margin),
                      touched = disc(first.x, y - first.y, radius + margin);
        for (const Part& part : parts) {
            const auto come = [&](Columns columns) {
                const double steps = steps_of(part);
                if (steps == 0) return Columns{};
                const Columns reached = hull(part, steps, y, radius + margin);
                return Columns{std::max(columns.first, reached.first), std::min(columns.last, reached.last)};
            };
            const auto stay = [&] {
                const double steps = steps_of(part);
                return disc(part.x + part.by_x * steps, y - part.y - part.by_y * steps, radius - margin);
            };
            const auto ask = [&](std::int64_t column) { ask_place(column, row, part); };
            if (inside.empty()) {
                ask_middle({0, places_.columns - 1}, come, ask);
                continue;
            }
            // Those beside what is inside come first, and those at its ends go first
            for (Columns left = come({0, inside.first - 1}); !left.empty(); left = come({0, left.last - 1}))
                ask(left.last);
            for (Columns right = come({inside.last + 1, places_.columns - 1}); !right.empty();
                 right = come({right.first + 1, places_.columns - 1}))
                ask(right.first);
            for (Columns open = touched; !open.empty() && steps_of(part) > 0;) {
                const Columns kept = stay();
                const bool left = kept.empty() || open.first < kept.first,
                           right = kept.empty() || open.last > kept.last;
                if (!left && !right) break;
                if (left) ask(open.first++);
                if (right && !open.empty()) ask(open.last--);
            }
        }
    }

    /// Asks those of `columns` that `clip` leaves, one in their middle first.
    template <class Clip, class Ask>
    void ask_middle(Columns columns, const Clip& clip, const Ask& ask) {
        columns = clip(columns);
        if (columns.empty()) return;
        const std::int64_t middle = columns.first + (columns.last - columns.first) / 2;
        ask(middle);
        ask_middle({columns.first, middle - 1}, clip, ask);
        ask_middle({middle + 1, columns.last}, clip, ask);
    }

    std::int32_t frame_at(MotionPoint place, Step step) const noexcept {
        std::int32_t frame = 0;
        for (const Near& near : near_) {
            const bool on_walk =
                near.walk.begin <= step && step <= add_steps(near.walk.begin, near.walk.steps);
            const MovingTarget::Walk walk = on_walk ? near.walk : near.target->walk_at(step);
            frame = std::max(frame, law_.frame_on(walk, place, step - walk.begin));
        }
        return frame;
    }
    /// The first frame to come at a place is the next, as soon as some target comes within its ring; or one
    /// before, as soon as the last target leaves the ring of what is shown.
    void ask_place(std::int64_t column, std::int64_t row, const Part& part) {
        const MotionPoint place{places_.first.x + column * places_.spacing,
                                places_.first.y + row * places_.spacing};
        const std::int32_t frame = frame_at(place, step_);
        const auto shown = static_cast<std::size_t>(frame);
        if (shown != ring_ && shown != ring_ + 1) return;
        const bool comes = shown == ring_;
        const std::int64_t closest = closest_on(part.walk, place);
        const auto within = static_cast<std::int64_t>(steps_within(part.walk, place, law_.reach_[ring_]));
        const auto inside = [&](std::int64_t at) {
            return static_cast<std::size_t>(law_.frame_on(part.walk, place, at)) > ring_;
        };
        const auto outside = [&](std::int64_t at) { return !inside(at); };
        if (part.onwards) {
            const std::int64_t end = std::min(part.walk.steps, found_.until - 1 - part.walk.begin);
            const std::int64_t from = comes ? part.begin : std::max(part.begin, closest);
            const std::int64_t to = comes ? std::min(end, closest) : end;
            if (!comes && !inside(from)) return;
            const std::int64_t change = comes ? first_of(from, to, closest - within, inside)
                                              : first_of(from, to, closest + within + 1, outside);
            if (change > to) return;
            const Step until = add_steps(part.walk.begin, change);
            if (comes || near_.size() == 1 || frame_at(place, until) != frame) found_.until = until;
        } else {
            const std::int64_t end = std::max<std::int64_t>(0, found_.from - part.walk.begin);
            const std::int64_t to = comes ? part.begin : std::min(part.begin, closest);
            const std::int64_t from = comes ? std::max(end, closest) : end;
            if (!comes && !inside(to)) return;
            const std::int64_t change = comes ? last_of(from, to, closest + within, inside)
                                              : last_of(from, to, closest - within - 1, outside);
            if (change < from) return;
            const Step last = add_steps(part.walk.begin, change);
            if (comes || near_.size() == 1 || frame_at(place, last) != frame) found_.from = last + 1;
        }
    }

    const TargetDistance& law_;
    std::span<const Near> near_;
    const MotionLattice& places_;
    Step step_;
    Validity& found_;
    std::size_t ring_ = 0;  ///< That is looked at: frame ring_ + 1 is shown inside.
    double spacing_, per_spacing_, width_, height_;
    std::size_t held_;  ///< Rings that no place leaves.
};

void TargetDistance::narrow(const MotionLattice& places, Step step, Validity& validity) const {
    if (reach_.empty()) return;
    const MotionPoint last{places.first.x + (places.columns - 1) * places.spacing,
                           places.first.y + (places.rows - 1) * places.spacing};
    // A whole round without a change is followed by no other
    Validity within = validity;
    within.meet({add_steps(step, -round_), add_steps(step, round_)});
    std::vector<Search::Near> near;
    near.reserve(targets_->size());
    double speed = 0, rings = 0;
    for (const MovingTarget& target : *targets_) {
        if (!ever_near(target, places.first, last)) continue;
        near.push_back({&target, target.walk_at(step)});
        if (target.moves()) speed = std::max(speed, target.speed());
    }
    if (speed == 0) return;
    // How often a ring meets a row, at most: so often a place is passed in the time that it takes from one to
    // the next. About that far is looked first, since places further off take longer
    for (const std::int64_t reach : reach_)
        rings += std::min(2 * static_cast<double>(reach) / static_cast<double>(places.spacing) + 1,
                          static_cast<double>(places.rows));
    const auto soon =
        static_cast<std::int64_t>(std::min(4 * static_cast<double>(places.spacing) / rings / speed, 1e15));
    Validity found;
    bool later = true, earlier = true;
    for (std::int64_t ahead = soon + 1; later || earlier; ahead *= 8) {
        const Validity seen{std::max(within.from, add_steps(step, -ahead)),
                            std::min(within.until, add_steps(step, ahead + 1))};
        if (later) found.until = seen.until;
        if (earlier) found.from = seen.from;
        Search search{*this, places, near, step, found};
        for (const Search::Near& target : near) {
            if (target.target->moves()) search.look_at(target);
            // Nothing is shorter
            if (found.until - 1 == found.from) break;
        }
        later = later && found.until == seen.until && seen.until < within.until;
        earlier = earlier && found.from == seen.from && seen.from > within.from;
    }
    if (found.until < within.until) validity.until = found.until;
    if (found.from > within.from) validity.from = found.from;
}

}  // namespace tessera
