#include "client/load/report_text.h"

#include <array>
#include <cstdio>
#include <string_view>

namespace tessera {
namespace {

std::string three_digits(double value, std::string_view unit) {
    std::array<char, 48> text{};
    const int decimals = value < 9.995 ? 2 : value < 99.95 ? 1 : 0;
    std::snprintf(text.data(), text.size(), "%.*f ", decimals, value);
    return text.data() + std::string{unit};
}

}  // namespace

std::string duration_text(std::chrono::nanoseconds duration) {
    const auto ns = static_cast<double>(duration.count());
    if (ns < 999.5) return std::to_string(duration.count()) + " ns";
    if (ns < 999.5e3) return three_digits(ns / 1e3, "µs");
    if (ns < 999.5e6) return three_digits(ns / 1e6, "ms");
    return three_digits(ns / 1e9, "s");
}

std::string bytes_text(double bytes) {
    constexpr std::array<std::string_view, 5> units{"B", "KB", "MB", "GB", "TB"};
    std::size_t unit = 0;
    while (bytes >= 999.5 && unit + 1 < units.size()) {
        bytes /= 1000;
        ++unit;
    }
    return three_digits(bytes, units[unit]);
}

std::string count_text(std::uint64_t count) {
    std::string digits = std::to_string(count);
    for (std::size_t i = digits.size(); i > 3;) digits.insert(i -= 3, ",");
    return digits;
}

}  // namespace tessera
