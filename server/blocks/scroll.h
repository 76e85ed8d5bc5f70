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
    /// Cells come to where they were after so many: |cells| at once, shifts are this often the same.
    static constexpr std::uint64_t again = std::uint64_t{1} << 36;

    /// How often they ran on since step 0: the shift's number.
    constexpr std::int64_t shift_at(Step step) const noexcept {
        if (steps == 1) return step;  // Every page asks, and a division takes long
        const auto every = static_cast<std::int64_t>(steps);
        return step / every - (step % every < 0 ? 1 : 0);
    }
    /// How far cells ran at shift `number`, at least 0.
    constexpr std::int64_t shifted(std::int64_t number) const noexcept {
        // A power of two divides 2^64, so that it may overflow
        const std::uint64_t moved =
            static_cast<std::uint64_t>(number) * static_cast<std::uint64_t>(std::int64_t{cells});
        return static_cast<std::int64_t>(moved % again);
    }
    /// The first step of shift `number`; `always` or `never` for those that no step has.
    constexpr Step begin_of(std::int64_t number) const noexcept {
        std::int64_t step = 0;
        if (__builtin_mul_overflow(number, static_cast<std::int64_t>(steps), &step))
            return number < 0 ? always : never;
        return step;
    }
    constexpr Place at(Step step) const noexcept {
        if (cells == 0) return {};
        const std::int64_t number = shift_at(step);
        return {shifted(number), {begin_of(number), begin_of(number + 1)}};
    }
};

}  // namespace tessera
