#include "shared/math/srgb.h"

namespace tessera {

const std::array<std::uint8_t, 65536>& steps_to_srgb() noexcept {
    static const auto table = [] {
        std::array<std::uint8_t, 65536> codes{};
        std::size_t step = 0;
        for (int code = 0; code < 256; ++code) {
            // Nearest in code values: the border between two codes lies half a code further
            const double border = code == 255 ? 65536.0 : detail::decode(code + 0.5) * 65535.0;
            for (; step < codes.size() && static_cast<double>(step) < border; ++step)
                codes[step] = static_cast<std::uint8_t>(code);
        }
        return codes;
    }();
    return table;
}

const std::uint16_t* srgb_codes_to_steps() noexcept { return srgb_to_steps.data(); }

const std::uint8_t* steps_to_srgb_codes() noexcept { return steps_to_srgb().data(); }

}  // namespace tessera
