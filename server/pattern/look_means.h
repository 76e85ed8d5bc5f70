#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/blocks/cell_program.h"

namespace tessera {

/// The mean colour of a whole cell by what it shows: linear, premultiplied, share of the cell included. What
/// levels above the cell sum, whether patterns fill their cells or are turned and scaled inside them.
struct LookMeans {
    std::int32_t turns = 1;  ///< 1 where there is no transform; Look::turn is then 0.
    std::int32_t scales = 1;
    std::int32_t slices = 1;                   ///< Of a pattern.
    std::vector<std::array<double, 4>> means;  ///< [((pattern·turns + turn)·scales + scale)·slices + slice]

    /// Pattern −1 and slices outside the set are transparent.
    std::array<double, 4> of(std::int32_t pattern, std::uint8_t turn, std::uint8_t scale,
                             std::int32_t slice) const noexcept {
        if (pattern < 0 || slice < 0 || slice >= slices) return {};
        const std::size_t look =
            (static_cast<std::size_t>(pattern) * static_cast<std::size_t>(turns) + turn) *
                static_cast<std::size_t>(scales) +
            scale;
        return means[look * static_cast<std::size_t>(slices) + static_cast<std::size_t>(slice)];
    }
    std::array<double, 4> of(const Look& look, std::int32_t slice) const noexcept {
        return of(look.pattern, look.turn, look.scale, slice);
    }
    std::array<double, 4> of(const LookShare& share, std::int32_t slice) const noexcept {
        return of(share.pattern, share.turn, share.scale, slice);
    }
    std::size_t memory_bytes() const noexcept { return means.size() * sizeof means[0]; }
};

}  // namespace tessera
