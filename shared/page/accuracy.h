#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace tessera {

/// How much error a request allows (DESIGN section 3).
enum class Accuracy : std::uint8_t {
    exact,  ///< No bound but rounding, where the method has an exact evaluation; else the least bound it
            ///< reaches.
    high,   ///< The default: as `exact` where that is cheap, else an expectation with its bound.
    fast,   ///< The cheapest answer that still carries a bound.
};

inline constexpr std::array accuracies{Accuracy::exact, Accuracy::high, Accuracy::fast};

/// The word for it in addresses, options and headers.
constexpr std::string_view name_of(Accuracy accuracy) noexcept {
    return accuracy == Accuracy::exact ? "exact" : accuracy == Accuracy::high ? "high" : "fast";
}

constexpr std::optional<Accuracy> accuracy_named(std::string_view name) noexcept {
    for (const Accuracy accuracy : accuracies)
        if (name_of(accuracy) == name) return accuracy;
    return std::nullopt;
}

}  // namespace tessera
