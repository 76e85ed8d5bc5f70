#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "server/blocks/plan.h"
#include "server/filter/summed_area.h"
#include "server/pattern/look_means.h"
#include "shared/page/page_key.h"

namespace tessera {

/// What a plan's instances look like: one image for each pattern, slice, turn and scale that a cell can show,
/// rendered once. A texel is the exact integral of the turned, scaled pattern over it (parallelogram.h), in
/// linear light, premultiplied, in steps of 1/65535; a quarter turn at scale 1 moves texels on texels. Images
/// are kept as summed areas, so that every level above is an exact box integral at any offset.
///
/// A pattern turns about its middle, which stays the middle of the image; turns go from x towards y:
/// clockwise where y points down.
class InstanceImages {
  public:
    /// `plan.transform` is set, and bytes(plan) has been found affordable.
    explicit InstanceImages(const ReferencePlan& plan);

    /// What the images of a plan will take, known without making them.
    static std::uint64_t bytes(const ReferencePlan& plan);

    /// Which looks cells can show: [(pattern·turns + turn)·scales + scale].
    static std::vector<bool> shown_looks(const ReferencePlan& plan);

    /// Null where nothing is shown: pattern −1, or a slice outside the set.
    const SummedArea* find(const Look& look, std::int32_t slice) const noexcept {
        if (look.pattern < 0 || slice < 0 || slice >= slices_) return nullptr;
        const std::int32_t first = first_[look_index(look.pattern, look.turn, look.scale)];
        return first < 0 ? nullptr : &images_[static_cast<std::size_t>(first + slice)];
    }

    /// Mean colours of cells of `cell_log2` that hold one whole instance.
    LookMeans means(int cell_log2) const;

    std::size_t memory_bytes() const noexcept;

  private:
    std::size_t look_index(std::int32_t pattern, std::size_t turn, std::size_t scale) const noexcept {
        return (static_cast<std::size_t>(pattern) * turns_ + turn) * scales_ + scale;
    }
    void render(const ReferencePlan& plan, std::size_t turn, std::size_t scale,
                const std::vector<std::uint16_t>& steps);

    std::size_t turns_, scales_;
    std::int32_t slices_;
    std::vector<std::int32_t> first_;  ///< By look: its slice 0 among images_, or −1.
    std::vector<SummedArea> images_;
};

/// Means over texels [from_x, to_x) of row `y` of `level`, where the image's top-left texel of level 0 is at
/// (left, top): four floats each. Exact sums, rounded once; 0 beyond the image.
void instance_row(const SummedArea& image, std::int64_t left, std::int64_t top, int level, std::int64_t y,
                  std::int64_t from_x, std::int64_t to_x, float* out) noexcept;

/// Where an image's top-left texel is, from that of its cell on. Constrained, it lies inside the cell, all
/// places alike; where it may hang over, it starts in the cell.
struct CellPlace {
    std::int32_t left, top;
};
inline CellPlace place_in_cell(const Look& look, std::int32_t side, int cell_log2, bool overflow) noexcept {
    const std::int64_t cell = std::int64_t{1} << cell_log2;
    const std::int64_t places = overflow ? cell : std::max<std::int64_t>(cell - side + 1, 1);
    return {static_cast<std::int32_t>(look.x * places >> 16),
            static_cast<std::int32_t>(look.y * places >> 16)};
}

/// The texels of a level that the image meets, from the first to behind the last.
struct TexelSpan {
    std::int64_t from, to;
};
inline TexelSpan texels_met(std::int64_t left, std::int32_t side, int level) noexcept {
    return {left >> level, ((left + side - 1) >> level) + 1};
}

/// Where an instance lies, in texels of level 0, and what it meets of a region, in texels of its level.
struct MetInstance {
    std::int64_t left = 0, top = 0;
    TexelSpan columns, rows;  ///< Of the lattice; empty where from is not below to.
};
inline MetInstance met_of(const TexelRegion& region, const Look& look, std::int32_t side, std::int64_t cell_x,
                          std::int64_t cell_y, int cell_log2, bool overflow) noexcept {
    const CellPlace place = place_in_cell(look, side, cell_log2, overflow);
    MetInstance met{cell_x * (std::int64_t{1} << cell_log2) + place.left,
                    cell_y * (std::int64_t{1} << cell_log2) + place.top,
                    {},
                    {}};
    const auto within = [](TexelSpan span, std::int64_t first, std::int32_t count) {
        return TexelSpan{std::max(span.from, first), std::min(span.to, first + count)};
    };
    met.columns = within(texels_met(met.left, side, region.level), region.x, region.width);
    met.rows = within(texels_met(met.top, side, region.level), region.y, region.height);
    return met;
}

}  // namespace tessera
