#pragma once

#include <cstdint>

#include "shared/motion/validity.h"

namespace tessera {

/// How the cells of a texture run to the left ("increasing the u value depending on time", section 6).
struct Scroll {
    std::int32_t cells = 0;   ///< Every …
    std::uint32_t steps = 1;  ///< … so many steps.

    struct Place {
        std::int64_t shift = 0;  ///< A cell shows what the cell so far to its right is, …
        Validity validity{};     ///< … in these steps.
    };
    constexpr Place at(Step step) const noexcept {
        if (cells == 0) return {};
        constexpr std::uint64_t again = std::uint64_t{1} << 36;
        const auto every = static_cast<std::int64_t>(steps);
        const std::int64_t times = step / every - (step % every < 0 ? 1 : 0);
        // A power of two divides 2^64, so that it may overflow
        const std::uint64_t moved =
            static_cast<std::uint64_t>(times) * static_cast<std::uint64_t>(std::int64_t{cells});
        const Step from = times * every;
        return {static_cast<std::int64_t>(moved % again), {from, add_steps(from, every)}};
    }
};

}  // namespace tessera
