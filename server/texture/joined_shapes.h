#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/texture/shapes.h"
#include "server/texture/unit_choice.h"

namespace tessera {

/// What level 0 copies. Shapes that are always shown together (ExchangeAsset::Patch::group) are one: where
/// they are blended with each other and nothing else can be, what is seen is known before any page is asked
/// for. All others are themselves.
class JoinedShapes {
  public:
    enum class Kind : std::uint8_t {
        copied,  ///< One shape alone, unblended: texels of the exemplar.
        sealed,  ///< Weights sum to one: no other shape blends here.
        open,    ///< Blended with the tile, and with others that may come beside.
    };
    /// A run of texels of one row.
    struct Span {
        std::uint16_t begin = 0, end = 0;  ///< Columns relative to the box.
        std::uint32_t from = 0;            ///< copied: texel of the exemplar, its rows one after the other.
                                           ///< Else: texel among all those that are not copied.
        std::uint32_t first_part = 0;
        std::uint16_t part_count = 0;  ///< Of those that are not copied.
        Kind kind = Kind::copied;
    };
    /// What one shape adds to a span.
    struct Part {
        std::uint16_t begin = 0, end = 0;  ///< Columns relative to the box.
        std::uint32_t from = 0;            ///< Texel of the exemplar.
        std::uint32_t weights = 0;         ///< As in Shapes::Segment.
    };
    struct Joined {
        std::int32_t x = 0, y = 0, width = 0, height = 0;  ///< As a shape's.
        std::uint32_t first_row = 0;                       ///< Of height + 1 entries.
    };

    /// `join`: whether groups are joined; else every shape is itself.
    JoinedShapes(const ExchangeAsset& asset, const Shapes& shapes, bool join);

    /// A group has the number of its first shape; its others are empty.
    const Joined& operator[](std::size_t shape) const noexcept { return joined_[shape]; }
    std::span<const Span> row(const Joined& joined, std::int32_t y) const noexcept {
        const std::uint32_t* begin = row_begin_.data() + joined.first_row + y;
        return {spans_.data() + begin[0], spans_.data() + begin[1]};
    }
    std::span<const Part> parts(const Span& span) const noexcept {
        return {parts_.data() + span.first_part, span.part_count};
    }
    std::size_t size() const noexcept { return joined_.size(); }
    std::size_t uncopied_texels() const noexcept { return uncopied_; }
    bool joins() const noexcept { return joins_; }
    /// What variants show, groups by the number of their first shape, in the order of their first rows.
    Variants joined(const Variants& variants, std::int32_t tile_side) const;
    std::size_t memory_bytes() const noexcept;

  private:
    struct Member {
        std::uint32_t shape = 0;
        std::int32_t x = 0, y = 0;  ///< Of its box, on the tile that the first one is shown on.
    };
    struct Row;
    void add(const Shapes& shapes, std::uint32_t exemplar_width, std::span<const Member> members);
    void add_row(Row& row);

    std::vector<Joined> joined_;
    std::vector<std::uint32_t> row_begin_;
    std::vector<Span> spans_;
    std::vector<Part> parts_;
    std::size_t uncopied_ = 0;
    bool joins_ = false;
};

}  // namespace tessera
