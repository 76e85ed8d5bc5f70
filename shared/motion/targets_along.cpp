// What a row of places shows of targets: the cost of a page is here.
#include <algorithm>
#include <cmath>

#include "shared/motion/targets.h"

namespace tessera {

namespace {

/// Doubles only pick which places are looked at more closely: so much further than need be, in texels.
constexpr double margin = 0.5;

std::int64_t x_of(const MotionRow& row, std::int32_t i) noexcept { return row.first.x + i * row.spacing; }

/// The distance of a point from a leg's line, in about.
double distance_to(const MotionPoint& from, const MotionPoint& to, double x, double y) noexcept {
    const double bx = static_cast<double>(to.x - from.x), by = static_cast<double>(to.y - from.y);
    const double px = x - static_cast<double>(from.x), py = y - static_cast<double>(from.y);
    const double length = bx * bx + by * by;
    const double along = length > 0 ? std::clamp((px * bx + py * by) / length, 0.0, 1.0) : 0.0;
    return std::sqrt((px - along * bx) * (px - along * bx) + (py - along * by) * (py - along * by));
}

bool is_one_step(const Validity& validity) noexcept { return validity.until - 1 == validity.from; }

}  // namespace

bool TargetDistance::ever_near(const MovingTarget& target, MotionPoint cell) const noexcept {
    if (reach_.empty()) return false;
    const MovingTarget::Box box = target.box();
    const std::int64_t far = reach_.front();
    return cell.x >= box.least.x - far && cell.x <= box.most.x + far && cell.y >= box.least.y - far &&
           cell.y <= box.most.y + far;
}

bool TargetDistance::ever_near(const MovingTarget& target, MotionPoint least,
                               MotionPoint most) const noexcept {
    if (reach_.empty()) return false;
    const std::int64_t far = reach_.front();
    const MovingTarget::Box box = target.box();
    if (most.x < box.least.x - far || least.x > box.most.x + far || most.y < box.least.y - far ||
        least.y > box.most.y + far)
        return false;
    // Its box is, but a leg?
    const double half_x = 0.5 * static_cast<double>(most.x - least.x),
                 half_y = 0.5 * static_cast<double>(most.y - least.y);
    const double x = static_cast<double>(least.x) + half_x, y = static_cast<double>(least.y) + half_y;
    const double reach = static_cast<double>(far) + std::sqrt(half_x * half_x + half_y * half_y) + margin;
    const auto legs = target.legs();
    for (std::size_t i = 0; i < legs.size(); ++i)
        if (distance_to(legs[i].from, legs[(i + 1) % legs.size()].from, x, y) <= reach) return true;
    return false;
}

bool TargetDistance::ever_near(MotionPoint least, MotionPoint most) const noexcept {
    return std::any_of(targets_->begin(), targets_->end(),
                       [&](const MovingTarget& target) { return ever_near(target, least, most); });
}

/// Every ring about the target covers a stretch of the row, and that of a nearer ring lies inside.
void TargetDistance::frames_of(const MovingTarget& target, const MotionRow& row, Step step,
                               std::span<std::int32_t> frames) const noexcept {
    std::fill(frames.begin(), frames.end(), 0);
    const MovingTarget::Walk walk = target.walk_at(step);
    const std::int64_t moved = step - walk.begin;
    const MovingTarget::Place place = target.at(step);
    const auto at = [&](std::int32_t i) { return frame_on(walk, {x_of(row, i), row.first.y}, moved); };
    // The nearest place: of two beside the target, whichever
    const std::int64_t right = (place.x - row.first.x) / row.spacing;
    auto nearest = static_cast<std::int32_t>(std::clamp<std::int64_t>(right, 0, row.count - 1));
    if (nearest + 1 < row.count && at(nearest + 1) > at(nearest)) ++nearest;
    std::int32_t left_end = 0, right_end = row.count - 1;
    for (std::int32_t frame = 1, most = at(nearest); frame <= most; ++frame) {
        std::int32_t outside = left_end - 1, inside = nearest;
        while (inside - outside > 1) {
            const std::int32_t middle = outside + (inside - outside) / 2;
            (at(middle) >= frame ? inside : outside) = middle;
        }
        left_end = inside;
        outside = right_end + 1, inside = nearest;
        while (outside - inside > 1) {
            const std::int32_t middle = inside + (outside - inside) / 2;
            (at(middle) >= frame ? inside : outside) = middle;
        }
        right_end = inside;
        std::fill(frames.begin() + left_end, frames.begin() + right_end + 1, frame);
    }
}

/// Whether a place shows `frame` in all of `within`, as far as one walk tells: its frames rise and then fall.
bool TargetDistance::stays_on(const MovingTarget::Walk& walk, MotionPoint cell, std::int32_t frame,
                              const Validity& within) const noexcept {
    const std::int64_t first = within.from - walk.begin, last = within.until - 1 - walk.begin;
    if (within.from < walk.begin || first < 0 || last < first || last > walk.steps) return false;
    if (frame_on(walk, cell, first) != frame || frame_on(walk, cell, last) != frame) return false;
    const double bx = static_cast<double>(walk.by.x), by = static_cast<double>(walk.by.y);
    const double length = bx * bx + by * by;
    if (length == 0) return true;
    const double along =
        (static_cast<double>(cell.x - walk.from.x) * bx + static_cast<double>(cell.y - walk.from.y) * by) /
        length * static_cast<double>(walk.steps);
    if (along < static_cast<double>(first) - 2 || along > static_cast<double>(last) + 2) return true;
    const auto near = static_cast<std::int64_t>(along);
    for (std::int64_t moved = std::max(near - 2, first); moved <= std::min(near + 3, last); ++moved)
        if (frame_on(walk, cell, moved) != frame) return false;
    return true;
}

/// Asks the law about those places that a ring may pass within so many steps, and about more steps only where
/// none is passed: then few places are asked about.
void TargetDistance::narrow(const MovingTarget& target, const MotionRow& row, Step step,
                            std::span<const std::int32_t> frames, Validity& validity) const noexcept {
    const MovingTarget::Place place = target.at(step);
    const double parts = static_cast<double>(place.parts);
    const double x = static_cast<double>(place.x - row.first.x) + static_cast<double>(place.x_rest) / parts;
    const double y = static_cast<double>(place.y - row.first.y) + static_cast<double>(place.y_rest) / parts;
    const auto spacing = static_cast<double>(row.spacing);
    const MotionPoint last{x_of(row, row.count - 1), row.first.y};
    const bool alone = std::none_of(targets_->begin(), targets_->end(), [&](const MovingTarget& other) {
        return &other != &target && ever_near(other, row.first, last);
    });
    for (std::int64_t ahead = 1;; ahead *= 8) {
        Validity within = validity;
        within.meet({add_steps(step, -ahead), add_steps(step, ahead + 1)});
        const double way = target.speed() * static_cast<double>(ahead) + margin;
        for (std::int32_t i = 0; i < row.count; ++i) {
            const double dx = i * spacing - x, distance = std::sqrt(dx * dx + y * y);
            const auto frame = static_cast<std::size_t>(frames[static_cast<std::size_t>(i)]);
            const bool comes = frame < reach_.size() && distance - static_cast<double>(reach_[frame]) < way;
            const bool goes = frame > 0 && static_cast<double>(reach_[frame - 1]) - distance < way;
            if (!comes && !goes) continue;
            const MotionPoint cell{x_of(row, i), row.first.y};
            if (alone && stays_on(target.walk_at(step), cell, static_cast<std::int32_t>(frame), within))
                continue;
            validity.meet(shown_at(cell, step, within).validity);
            if (is_one_step(validity)) return;
            within.meet(validity);
        }
        // Known as far as anybody asks, or for a whole round
        if ((validity.until <= add_steps(step, ahead) && validity.from > add_steps(step, -ahead)) ||
            ahead >= round_)
            return;
    }
}

void TargetDistance::shown_along(const MotionRow& row, Step step, std::int32_t* frames,
                                 Validity* validity) const {
    std::fill_n(frames, row.count, 0);
    if (reach_.empty() || row.count == 0) return;
    std::vector<std::int32_t> own;
    for (const MovingTarget& target : *targets_) {
        if (!ever_near(target, row.first, {x_of(row, row.count - 1), row.first.y})) continue;
        own.resize(static_cast<std::size_t>(row.count));
        frames_of(target, row, step, own);
        for (std::int32_t i = 0; i < row.count; ++i)
            frames[i] = std::max(frames[i], own[static_cast<std::size_t>(i)]);
        if (validity != nullptr && target.moves() && !is_one_step(*validity))
            narrow(target, row, step, own, *validity);
    }
}

}  // namespace tessera
