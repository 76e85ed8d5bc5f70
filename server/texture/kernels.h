#pragma once

#include <cstddef>
#include <cstdint>

#include "server/texture/patch_map.h"
#include "server/texture/variants.h"

namespace tessera {

/// The inner loops of content exchange, compiled once for each instruction set from kernels_body.inc. Every
/// result lane is computed by the same operations in the same order, so all of them give the same bits.
struct Kernels {
    const char* name;  ///< "x86-64", "avx2", "avx512"

    /// What one row of a page takes from one tile's column of stamps.
    struct StampTile {
        std::int64_t x = 0;                      ///< The tile's first texel, relative to the row's.
        const std::uint8_t* contents = nullptr;  ///< Of this row's tile, by patch.
        const std::uint8_t* contents_above =
            nullptr;  ///< Of the tile above, whose patches hang over into this row.
    };
    struct StampRow {
        const StampTile* tiles = nullptr;
        std::size_t tile_count = 0;
        const PatchMap::Span* spans = nullptr;  ///< Of this row in the tile.
        const PatchMap::Span* spans_end = nullptr;
        const PatchMap::Span* spans_above = nullptr;  ///< Of the row a tile's side further down.
        const PatchMap::Span* spans_above_end = nullptr;
        const float* values = nullptr;                ///< Stamps of the level …
        const std::size_t* patch_begin = nullptr;     ///< … by patch, in floats
        const std::size_t* content_stride = nullptr;  ///< … by patch, in floats
        std::int32_t width = 0;                       ///< Texels of the row.
    };
    /// Adds the stamps to `rgb` (3·width floats). Returns the number of stamps met.
    std::size_t (*add_stamps)(const StampRow& row, float* rgb);

    struct VariantRow {
        const std::uint16_t* types =
            nullptr;  ///< Of the tiles of this row, from the one that holds column `first_x`.
        const std::uint16_t* types_above = nullptr;
        std::size_t tile_count = 0;
        std::int64_t first_x = 0;      ///< First tile's first texel relative to the row's, usually negative.
        const float* image = nullptr;  ///< Row y of the image of type 0.
        const float* image_above =
            nullptr;  ///< Row y + tile side of it, or null if nothing hangs over so far down.
        std::size_t image_stride = 0;  ///< Floats from a type's image to the next's.
        std::int32_t image_side = 0;
        std::int32_t tile_side = 0;
        std::int32_t width = 0;
    };
    void (*add_variants)(const VariantRow& row, float* rgb);

    /// A row of whole nodes: types of the row and of the row above, each from the node left of the first
    /// texel on.
    void (*add_nodes)(const NodeTables::Sums* table, const std::uint16_t* types,
                      const std::uint16_t* types_above, std::int32_t width, float* rgb);

    /// RGB linear to sRGB codes, opaque.
    void (*encode)(const float* rgb, std::int32_t width, std::uint8_t* rgba);

    /// One run of blended texels at level 0: Σ weight·steps / weight_one, rounded, as sRGB codes (`rgba`) or
    /// as steps.
    struct BlendTerm {
        const std::uint16_t* steps = nullptr;    ///< RGBA
        const std::uint16_t* weights = nullptr;  ///< Four equal ones for each texel.
    };
    /// `sums`: room for 4·(width + 3) values; left holding Σ weight·steps. Reads and writes up to 3 texels
    /// too far.
    void (*blend)(const BlendTerm* terms, std::size_t count, std::int32_t width, std::uint32_t* sums);
    /// Sums of blend() to sRGB codes, opaque.
    void (*encode_sums)(const std::uint32_t* sums, std::int32_t width, std::uint8_t* rgba);
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
