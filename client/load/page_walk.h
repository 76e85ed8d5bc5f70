#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "client/load/level_weights.h"
#include "shared/page/page_key.h"

namespace tessera {

/// An endless sequence of pages to ask for. The same arguments give the same sequence.
class PageWalk {
  public:
    virtual ~PageWalk() = default;
    virtual PageKey next() = 0;
};

/// Pages drawn at random: a level by its weight, then a page of that level, all equally likely.
class RandomWalk : public PageWalk {
  public:
    /// `working_set`: the walk stays within that many pages, drawn once in the same way, so that pages come
    /// back as they do with many viewers of one place; 0 draws from the whole extent. `levels` is not empty.
    RandomWalk(Extent extent, std::vector<LevelWeight> levels, std::uint64_t seed, std::size_t working_set);
    PageKey next() override;

  private:
    PageKey draw(std::uint64_t stream_key, std::uint64_t counter) const;

    Extent extent_;
    std::vector<LevelWeight> levels_;
    std::uint32_t sum_of_weights_ = 0;
    std::uint64_t seed_;
    std::vector<PageKey> set_;
    std::uint64_t drawn_ = 0;
};

/// Neighbours in turn, as a seeder or a slow pan asks for them: a square of `side` pages of the finest level
/// given, row by row to and fro; then the same of each coarser level around the same place; then the next
/// place to the right.
class SweepWalk : public PageWalk {
  public:
    /// The weights of `levels` do not matter. The seed chooses the first place.
    SweepWalk(Extent extent, std::vector<LevelWeight> levels, std::uint64_t seed, std::uint32_t side = 16);
    PageKey next() override;

  private:
    void start_level();

    Extent extent_;
    std::vector<LevelWeight> levels_;
    std::uint32_t side_;
    std::uint64_t place_x_, place_y_;  ///< The square's top-left corner, in pages of the finest level given.
    std::size_t level_index_ = 0;
    std::uint32_t left_ = 0, top_ = 0,
                  width_ = 0;  ///< The square on the level it is on now, inside the extent.
    std::uint32_t column_ = 0, row_ = 0;
};

}  // namespace tessera
