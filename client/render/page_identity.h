#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>

#include "client/residency/residency.h"

namespace tessera {

class PlaneScene;

/// Whether pixels show the pages that they should: what the GPU has is read back and compared with what was
/// brought for it. Waits for the GPU, so it is for tests and for those who ask.
class PageIdentity {
  public:
    /// Of each frame: remembers what came.
    void add(const ResidencyFrame& frame);
    /// The cache was resized: pages are in other slots.
    void forget() { hashes_.clear(); }

    struct Checked {
        double pixels = 0;  ///< That sample the pages looked at
        double wrong = 0;   ///< Of these, those whose entry or whose texels on the GPU are others
    };
    /// Looks at the whole page table, and at the texels of the next `pages` of what the frame samples, in
    /// turns. A pixel that shows a coarser page than it should is right if the page is an ancestor.
    Checked check(const PlaneScene& scene, std::span<const NeededPage> sampled, std::size_t pages);

  private:
    std::unordered_map<Slot, std::uint64_t> hashes_;  ///< Of what was brought last
    std::size_t turn_ = 0;
};

}  // namespace tessera
