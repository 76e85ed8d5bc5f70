#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <boost/smart_ptr/intrusive_ptr.hpp>

#include "shared/sprites/sprite.h"

namespace tessera {

namespace detail {
struct PositioningNode;
void intrusive_ptr_add_ref(const PositioningNode* node) noexcept;
void intrusive_ptr_release(const PositioningNode* node) noexcept;
using PositioningNodePtr = boost::intrusive_ptr<PositioningNode>;
}  // namespace detail

/// The explicit positioning map (Lefebvre and Neyret 2003, section 3.2): which sprites lie where.
///
/// The paper's grid has cells as large as the pattern, so that a sprite meets at most four of them. Here is
/// one such grid for every power of two: a sprite lies on the finest grid whose cells are as large as its
/// box, in the cell of the box's corner, and so reaches no further than the next cell to the right and below.
/// Cells are kept sparsely, in a quadtree without nodes that nothing is in: memory grows with sprites, and
/// what meets a box is found without looking at anything else.
///
/// A value: a copy costs nothing and never changes when the other does, so that pages are evaluated from one
/// while edits make the next. One thread changes a map; any may read its copies.
class PositioningMap {
  public:
    /// Sprites of one grid that may meet a cell: what bounds the work for a texel.
    static constexpr std::size_t max_overlap_layers = 64;

    explicit PositioningMap(std::size_t overlap_layers = max_overlap_layers)
        : overlap_layers_{overlap_layers} {}

    /// Error: invalid_input (check_sprite; a cell that is full, with its place). Its id is not in the map.
    Result<void> place(const Sprite& sprite);

    /// Takes away the sprite that is like this one; false if there is none.
    bool remove(const Sprite& sprite);

    /// Whether a sprite could be placed: place() without placing.
    Result<void> check_room(const Sprite& sprite) const;

    /// Sprites whose box_of() meets `box`, as they are drawn: the farthest from the eye first.
    std::vector<Sprite> meeting(const TexelBox& box) const;

    /// The same, of those that meet it at a step.
    std::vector<Sprite> meeting_at(const TexelBox& box, Step step) const;

    /// At most `most` of those that meeting() finds, whichever are found first; all of them, if they are
    /// fewer.
    std::vector<Sprite> some_meeting(const TexelBox& box, std::size_t most) const;

    /// Whether any sprite's box_of() meets `box`.
    bool any_meets(const TexelBox& box) const;

    std::size_t size() const noexcept { return size_; }
    /// Those that move, or are not always there.
    std::size_t living() const noexcept { return living_; }
    std::size_t overlap_layers() const noexcept { return overlap_layers_; }

    /// Of this map alone, as if it shared nothing.
    std::size_t memory_bytes() const noexcept;

  private:
    /// One tree for each quadrant of the plane, so that no node lies on both sides of an axis.
    std::array<detail::PositioningNodePtr, 4> roots_;
    std::size_t size_ = 0, living_ = 0;
    std::size_t overlap_layers_;
};

}  // namespace tessera
