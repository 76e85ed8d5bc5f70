#pragma once

#include "server/filter/convex_polygon.h"
#include "server/filter/each_footprint.h"
#include "server/filter/exact_filter.h"
#include "server/filter/line_table.h"

namespace tessera {

/// Line integral textures (line-integral-textures, section 3.2): walks over the lines that the footprint
/// crosses, with the difference of two sums in each. Departures: the footprint's edges are integrated as they
/// lie, and not by one point a line, which the paper names as its main error; sums are integers of a page,
/// not floats of a texture; and a footprint of more than `lines` lines takes its texels from a coarser level
/// (with any number of lines: one of more than 1024 lines, or of more than 300 pages).
class LineIntegralFilter {
  public:
    LineIntegralFilter(const FootprintFilter& filter, std::shared_ptr<const TexelPages> pages,
                       std::size_t memory_bytes)
        : filter_{filter},
          columns_{pages, memory_bytes},
          rows_{pages, memory_bytes},
          exact_{filter, pages, memory_bytes} {}

    Estimate operator()(const Footprint& footprint, Reading& reading);

  private:
    template <bool Horizontal>
    Estimate walk(const Footprint& footprint, int level, Reading& reading,
                  PageTables<LineTable<Horizontal>>& tables);

    FootprintFilter filter_;
    PageTables<LineTable<false>> columns_;
    PageTables<LineTable<true>> rows_;
    ExactFilter exact_;  ///< For slivers, whose area would be lost between two great sums.
};

}  // namespace tessera
