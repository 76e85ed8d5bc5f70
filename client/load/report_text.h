#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace tessera {

/// Three digits and a unit: "812 µs", "1.24 ms", "30.2 s".
std::string duration_text(std::chrono::nanoseconds duration);
/// Three digits and a unit: "21.8 KB", "1.76 GB".
std::string bytes_text(double bytes);
/// With a comma after each three digits: "1,570,312".
std::string count_text(std::uint64_t count);

}  // namespace tessera
