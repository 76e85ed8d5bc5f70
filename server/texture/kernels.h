#pragma once

#include <cstddef>
#include <cstdint>

#include "server/texture/stamps.h"
#include "server/texture/unit_sums.h"

namespace tessera {

/// The inner loops of by-example textures, compiled once for each instruction set from kernels_body.inc.
/// Every result lane is computed by the same operations in the same order, so all of them give the same bits.
struct Kernels {
    const char* name;  ///< "x86-64", "avx2", "avx512"

    /// Adds rows of a stamp: span i to the row `rgb` + i·stride, its columns moved by `x`, what falls outside
    /// [0, width) left out. May add zero to Stamps::row_floats floats behind a row. Returns the number of
    /// texels added.
    std::size_t (*add_spans)(const Stamps::Span* spans, std::int32_t count, const float* values,
                             std::int64_t x, std::int32_t width, float* rgb, std::ptrdiff_t stride);

    struct VariantRow {
        const std::uint16_t* types =
            nullptr;  ///< Of the units of this row, from the one that holds column `first_x`.
        const std::uint16_t* types_above = nullptr;
        std::size_t unit_count = 0;
        std::int64_t first_x = 0;      ///< First unit's first texel relative to the row's, usually negative.
        const float* image = nullptr;  ///< Row y of the image of type 0.
        const float* image_above =
            nullptr;  ///< Row y + unit side of it, or null if nothing hangs over so far down.
        std::size_t image_stride = 0;  ///< Floats from a type's image to the next's.
        std::int32_t image_side = 0;
        std::int32_t unit_side = 0;
        std::int32_t width = 0;
    };
    void (*add_variants)(const VariantRow& row, float* rgb);

    /// A row of whole nodes: types of the row and of the row above, each from the node left of the first
    /// texel on.
    void (*add_nodes)(const NodeTables::Sums* table, const std::uint16_t* types,
                      const std::uint16_t* types_above, std::int32_t width, float* rgb);

    /// RGB linear to sRGB codes, opaque.
    void (*encode)(const float* rgb, std::int32_t width, std::uint8_t* rgba);

    /// One run of blended texels at level 0: sums += weight·(content − tile) in linear steps; texels are RGBA
    /// codes, weights one a texel. Reads up to eight texels too far, and may add zero there.
    void (*blend)(const std::uint8_t* content, const std::uint8_t* tile, const std::uint16_t* weights,
                  std::int32_t width, std::int32_t* sums);
    /// tile + sums / weight_one, rounded, as sRGB codes, opaque.
    void (*encode_blended)(const std::int32_t* sums, const std::uint8_t* tile, std::int32_t width,
                           std::uint8_t* rgba);
};

/// The best that this processor runs; `TESSERA_KERNELS=x86-64|avx2|avx512` in the environment asks for less.
const Kernels& kernels() noexcept;

/// All that this processor runs, plainest first: tests hold them equal.
struct KernelList {
    const Kernels* items[3] = {};
    std::size_t count = 0;
};
KernelList available_kernels() noexcept;

}  // namespace tessera
