#include "client/load/camera_walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/residency/needed_pages.h"
#include "client/residency/plane_view.h"
#include "shared/math/hash.h"

namespace tessera {

CameraWalk::CameraWalk(Extent extent, std::vector<LevelWeight> levels, std::vector<Camera> frames,
                       Settings settings)
    : extent_{extent}, levels_{std::move(levels)}, frames_{std::move(frames)}, settings_{settings} {}

PageKey CameraWalk::next() {
    // A whole path may show nothing that is not held, or no level that was asked for: two rounds are enough
    // to know
    for (std::size_t tried = 0; wanted_.empty() && tried < 2 * frames_.size(); ++tried) next_frame();
    if (wanted_.empty()) return {extent_.n, 0, 0};
    const PageKey page = wanted_.back();
    wanted_.pop_back();
    return page;
}

void CameraWalk::next_frame() {
    if (frame_ == frames_.size()) {
        frame_ = 0;
        held_.clear();
        place_in_held_.clear();
    }
    const PlaneView view{frames_[frame_++], settings_.width, settings_.height};
    for (const NeededPage& needed : needed_pages(view, extent_, 0)) {
        const PageKey page = needed.key;
        if (std::none_of(levels_.begin(), levels_.end(), [&](auto l) { return l.level == page.level; }))
            continue;
        if (const auto found = place_in_held_.find(page); found != place_in_held_.end()) {
            held_.splice(held_.end(), held_, found->second);
            continue;
        }
        wanted_.push_back(page);
        place_in_held_.emplace(page, held_.insert(held_.end(), page));
        if (held_.size() > settings_.held_pages) {
            place_in_held_.erase(held_.front());
            held_.pop_front();
        }
    }
    std::reverse(wanted_.begin(), wanted_.end());  // taken from the back
}

std::vector<Camera> generated_flight(Extent extent, const std::vector<LevelWeight>& levels,
                                     std::uint64_t seed, double seconds, double frames_per_second) {
    const std::int64_t side = extent.side_texels();
    const auto place = [&](std::int64_t axis) {
        const double share = static_cast<double>(hash(seed, stream("flight"), 0, axis) >> 11) * 0x1p-53;
        return static_cast<std::int64_t>((0.25 + 0.5 * share) * static_cast<double>(side));
    };
    Camera camera;
    camera.ground = {place(0), place(1), 0, 0};
    camera.yaw_degrees = static_cast<double>(hash(seed, stream("flight"), 0, 2) % 360);
    camera.pitch_degrees = -50;
    // At this height a pixel in the middle of the picture is about one texel of level 0
    constexpr double height_of_level_0 = 700;
    const double finest = levels.front().level, coarsest = levels.back().level;
    const auto count = static_cast<std::size_t>(std::max(1.0, seconds * frames_per_second));
    std::vector<Camera> frames;
    for (std::size_t i = 0; i < count; ++i) {
        const double turn = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
        const double level = finest + (coarsest - finest) * (1 - std::cos(turn)) / 2;
        camera.height_texels = height_of_level_0 * std::exp2(level);
        camera.yaw_degrees += 40 * std::sin(2 * turn) / frames_per_second;
        // Glide forward by half the height a second, but stay over the extent
        const double heading = camera.yaw_degrees * std::numbers::pi / 180;
        const double step = 0.5 * camera.height_texels / frames_per_second;
        PlanePoint ground = camera.ground.moved(step * std::sin(heading), -step * std::cos(heading));
        ground.x = std::clamp<std::int64_t>(ground.x, 0, side - 1);
        ground.y = std::clamp<std::int64_t>(ground.y, 0, side - 1);
        camera.ground = ground;
        frames.push_back(camera);
    }
    return frames;
}

}  // namespace tessera
