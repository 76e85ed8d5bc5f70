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
    /// [0, width) left out. May add zero to StampSpans::row_floats floats behind a row. Returns the number of
    /// texels added.
    std::size_t (*add_spans)(const StampSpans::Span* spans, std::int32_t count, const float* values,
                             std::int64_t x, std::int32_t width, float* rgb, std::ptrdiff_t stride);

    /// Adds `count` rows of a stamp that is a box, each of 0 to 6 times StampSpans::row_floats values, one
    /// row after the other.
    void (*add_box)(const float* values, std::int32_t vectors, std::int32_t count, float* rgb,
                    std::ptrdiff_t stride);

    /// Some rows of texels under units of a few texels.
    struct VariantBand {
        const std::uint16_t* types = nullptr;  ///< Of the first unit of the second row of units.
        std::ptrdiff_t types_stride = 0;       ///< To the next row of units.
        std::size_t units_across = 0, units_down = 0;
        const float* images = nullptr;  ///< As in VariantImages: of type 0.
        std::size_t row_floats = 0;
        std::int32_t unit_side = 0, image_side = 0;
        std::int32_t first = 0, count = 0;  ///< Rows, from the second row of units on.
    };
    /// Adds the images of all units, and what hangs over from the row of units above, to the rows: `rgb` is
    /// the first unit's first texel in the first row. Writes whole rows of images, from wherever units begin.
    void (*add_variants)(const VariantBand& band, float* rgb, std::ptrdiff_t stride);

    /// A row of whole nodes on top of one colour for all, `base`: types of the row, from the node left of the
    /// first texel on. `above` is what hangs over from the row above, two parts a node, and becomes what
    /// hangs over from this one. Writes a float behind the row.
    void (*add_nodes)(const NodeTables::Sums* table, const std::uint16_t* types, const float* base,
                      float (*above)[2][4], std::int32_t width, float* rgb);

    /// RGB linear to sRGB codes, opaque.
    void (*encode)(const float* rgb, std::int32_t width, std::uint8_t* rgba);

    /// A run of blended texels at level 0. RGBA; weights are one a texel.
    template <class Texel>
    struct BlendRun {
        const Texel* content;
        const Texel* tile;
        const std::uint16_t* weights;
        std::int32_t* sums;
        std::int32_t width;
    };
    /// sums += weight·(content − tile) in linear steps, of sRGB codes. Reads up to eight texels too far, and
    /// may add zero there. Many runs at once, since they are short and the table of codes fills registers.
    void (*blend)(const BlendRun<std::uint8_t>* runs, std::size_t count);
    /// The same of linear steps.
    void (*blend_steps)(const BlendRun<std::uint16_t>* runs, std::size_t count);
    /// A run of texels that are blended: RGBA.
    struct BlendedRun {
        std::int32_t* sums;
        const std::uint8_t* tile;
        std::uint8_t* rgba;
        std::int32_t width;
    };
    /// tile + sums / weight_one, rounded, as sRGB codes, opaque; leaves zero sums. Many at once, as for
    /// blend.
    void (*encode_blended)(const BlendedRun* runs, std::size_t count);

    /// A run of texels to be copied: RGBA.
    struct CopyRun {
        const std::uint8_t* from;
        std::uint8_t* to;
        std::int32_t width;
    };
    /// Copies one run after the other. Many at once: while one is copied, those that come are fetched.
    void (*copy)(const CopyRun* runs, std::size_t count);
};

/// The best that this processor runs; `TESSERA_KERNELS=x86-64|avx2|avx512` in the environment asks for less.
const Kernels& kernels() noexcept;

/// For each sRGB code the last linear step that is nearest to it: 256 of them, for kernels to decide by.
const std::uint16_t* last_steps_of_codes() noexcept;

/// All that this processor runs, plainest first: tests hold them equal.
struct KernelList {
    const Kernels* items[3] = {};
    std::size_t count = 0;
};
KernelList available_kernels() noexcept;

}  // namespace tessera
