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

/// The longer way from `step` to an end of `validity`: in the steps before that a place matters only if its
/// frame changes.
double horizon(const Validity& validity, Step step) noexcept {
    const double until = static_cast<double>(validity.until) - static_cast<double>(step);
    const double from = static_cast<double>(step) - static_cast<double>(validity.from);
    return std::max(until, from);
}

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
    return std::any_of(targets_.begin(), targets_.end(),
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

/// Asks the law about those places that may be passed by a ring before the interval ends that is known so
/// far: the interval shrinks quickly, and few are left.
void TargetDistance::narrow(const MovingTarget& target, const MotionRow& row, Step step,
                            std::span<const std::int32_t> frames, Validity& validity) const noexcept {
    const MovingTarget::Place place = target.at(step);
    const double parts = static_cast<double>(place.parts);
    const double x = static_cast<double>(place.x - row.first.x) + static_cast<double>(place.x_rest) / parts;
    const double y = static_cast<double>(place.y - row.first.y) + static_cast<double>(place.y_rest) / parts;
    double way = target.speed() * horizon(validity, step) + margin;
    const auto spacing = static_cast<double>(row.spacing);
    for (std::int32_t i = 0; i < row.count; ++i) {
        const double dx = i * spacing - x, distance = std::sqrt(dx * dx + y * y);
        const auto frame = static_cast<std::size_t>(frames[static_cast<std::size_t>(i)]);
        const bool comes = frame < reach_.size() && distance - static_cast<double>(reach_[frame]) < way;
        const bool goes = frame > 0 && static_cast<double>(reach_[frame - 1]) - distance < way;
        if (!comes && !goes) continue;
        validity.meet(shown_at({x_of(row, i), row.first.y}, step, validity).validity);
        if (is_one_step(validity)) return;
        way = target.speed() * horizon(validity, step) + margin;
    }
}

void TargetDistance::shown_along(const MotionRow& row, Step step, std::int32_t* frames,
                                 Validity* validity) const {
    std::fill_n(frames, row.count, 0);
    if (reach_.empty() || row.count == 0) return;
    std::vector<std::int32_t> own;
    for (const MovingTarget& target : targets_) {
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
