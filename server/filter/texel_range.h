#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "server/filter/texel_pages.h"

namespace tessera {

/// The least and the greatest step of each channel.
struct StepRange {
    std::array<std::uint16_t, 4> least{65535, 65535, 65535, 65535}, most{};

    void widen(const StepRange& other) noexcept {
        for (std::size_t c = 0; c < 4; ++c) {
            least[c] = std::min(least[c], other.least[c]);
            most[c] = std::max(most[c], other.most[c]);
        }
    }
};

/// Ranges of a page's blocks of 8×8, 16×16, … 256×256 texels.
class TexelRanges {
  public:
    static constexpr int finest = 3, coarsest = 8;
    static constexpr std::size_t blocks = 1024 + 256 + 64 + 16 + 4 + 1;
    static constexpr std::size_t bytes = blocks * sizeof(StepRange);

    explicit TexelRanges(const TexelPage& page);

    /// Of block (x, y) of 2^`size` texels, finest <= size <= coarsest.
    const StepRange& block(int size, std::int64_t x, std::int64_t y) const noexcept {
        return ranges_[first(size) + (static_cast<std::size_t>(y) << (coarsest - size)) +
                       static_cast<std::size_t>(x)];
    }

  private:
    /// Finest first: 4^5 blocks, 4^4, …
    static constexpr std::size_t first(int size) noexcept {
        std::size_t before = 0;
        for (int s = finest; s < size; ++s) before += std::size_t{1} << 2 * (coarsest - s);
        return before;
    }

    std::vector<StepRange> ranges_;
};

}  // namespace tessera
