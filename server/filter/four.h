#pragma once

#include <cstdint>
#include <cstring>

namespace tessera {

/// Four channels at once: GCC's and clang's vectors, on any processor. One operation is one rounding.
typedef float Floats4 __attribute__((vector_size(16)));
typedef std::int32_t Ints4 __attribute__((vector_size(16)));
typedef std::uint16_t Steps4 __attribute__((vector_size(8)));
typedef double Doubles2 __attribute__((vector_size(16)));
typedef std::int32_t Ints2 __attribute__((vector_size(8)));

inline Ints4 load_steps(const std::uint16_t* texel) noexcept {
    Steps4 steps;
    std::memcpy(&steps, texel, sizeof steps);
    return __builtin_convertvector(steps, Ints4);
}

inline Ints4 load_ints(const std::int32_t* four) noexcept {
    Ints4 ints;
    std::memcpy(&ints, four, sizeof ints);
    return ints;
}

inline Floats4 floats_of(Ints4 ints) noexcept { return __builtin_convertvector(ints, Floats4); }

/// Four doubles as two vectors, so that no wider registers are needed to pass them.
struct Doubles4 {
    Doubles2 low{}, high{};

    Doubles4() = default;
    Doubles4(Doubles2 a, Doubles2 b) noexcept : low{a}, high{b} {}
    explicit Doubles4(Ints4 ints) noexcept
        : low{__builtin_convertvector(__builtin_shufflevector(ints, ints, 0, 1), Doubles2)},
          high{__builtin_convertvector(__builtin_shufflevector(ints, ints, 2, 3), Doubles2)} {}

    explicit Doubles4(Floats4 floats) noexcept
        : low{static_cast<double>(floats[0]), static_cast<double>(floats[1])},
          high{static_cast<double>(floats[2]), static_cast<double>(floats[3])} {}

    friend Doubles4 operator+(Doubles4 a, Doubles4 b) noexcept { return {a.low + b.low, a.high + b.high}; }
    friend Doubles4 operator-(Doubles4 a, Doubles4 b) noexcept { return {a.low - b.low, a.high - b.high}; }
    friend Doubles4 operator*(Doubles4 a, double b) noexcept { return {a.low * b, a.high * b}; }
    Doubles4& operator+=(Doubles4 b) noexcept { return *this = *this + b; }
    double operator[](int channel) const noexcept { return channel < 2 ? low[channel] : high[channel - 2]; }
};

}  // namespace tessera
