#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <unordered_map>
#include <vector>

#include "client/load/page_walk.h"
#include "client/residency/camera.h"

namespace tessera {

/// What a viewer asks for while its camera flies: each frame's visible pages, the coarsest first, without
/// those that it still holds. When the path is over it starts again as a viewer that holds nothing.
class CameraWalk : public PageWalk {
  public:
    struct Settings {
        int width = 1280;  ///< The picture, in pixels.
        int height = 720;
        std::size_t held_pages = 2048;  ///< The viewer's page cache: the longest unseen page goes first.
    };
    /// `frames` is not empty; pages of levels that `levels` does not have are left out.
    CameraWalk(Extent extent, std::vector<LevelWeight> levels, std::vector<Camera> frames, Settings settings);
    PageKey next() override;

  private:
    void next_frame();

    Extent extent_;
    std::vector<LevelWeight> levels_;
    std::vector<Camera> frames_;
    Settings settings_;
    std::size_t frame_ = 0;
    std::vector<PageKey> wanted_;  ///< Of this frame, those not held; the next one last.
    std::list<PageKey> held_;      ///< The longest unseen first.
    std::unordered_map<PageKey, std::list<PageKey>::iterator> place_in_held_;
};

/// A flight of `seconds` at `frames_per_second` over a place that the seed chooses: it glides, turns, rises
/// until a texel of the coarsest given level is about a pixel, and comes down again.
std::vector<Camera> generated_flight(Extent extent, const std::vector<LevelWeight>& levels,
                                     std::uint64_t seed, double seconds = 20, double frames_per_second = 30);

}  // namespace tessera
