#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace tessera {

/// Copies stretches of rows of square images that lie side by side: how pages of cells are made. Texels are
/// bytes here, so that codes (4 bytes) and linear texels (16) share it.
struct CellRowCopy {
    const void* images = nullptr;           ///< Image i at i · side² texels; rows from the top.
    const std::int32_t* index = nullptr;    ///< The image of each cell, from the first on that is met.
    int side_log2 = 0;                      ///< Of an image, in texels.
    std::int32_t skip = 0;                  ///< Texels of the first cell left of the stretch: below side.
    std::int32_t width = 0;                 ///< Texels.
    std::int32_t from_row = 0, to_row = 0;  ///< Of the images.
    void* out = nullptr;                    ///< Takes row from_row.
    std::size_t out_row_texels = 0;
};

namespace detail {

/// `fixed` is the side in texels where the compiler may know it, else 0.
template <std::size_t texel_bytes, std::size_t fixed>
void copy_cell_rows(const CellRowCopy& copy) {
    const std::size_t side = fixed != 0 ? fixed : std::size_t{1} << copy.side_log2;
    const std::size_t row_bytes = side * texel_bytes;
    const auto image_bytes = static_cast<std::ptrdiff_t>(side * row_bytes);
    const std::size_t skip = std::size_t(copy.skip), width = std::size_t(copy.width);
    const std::size_t head = skip == 0 ? 0 : std::min(side - skip, width);
    const std::size_t whole = (width - head) / side, tail = (width - head) % side;
    const std::int32_t* const whole_index = copy.index + (head == 0 ? 0 : 1);
    auto* out_row = static_cast<unsigned char*>(copy.out);
    for (std::int32_t row = copy.from_row; row < copy.to_row; ++row) {
        const auto* images = static_cast<const unsigned char*>(copy.images) + std::size_t(row) * row_bytes;
        unsigned char* out = out_row;
        if (head != 0) {
            std::memcpy(out, images + copy.index[0] * image_bytes + skip * texel_bytes, head * texel_bytes);
            out += head * texel_bytes;
        }
        for (std::size_t cell = 0; cell < whole; ++cell, out += row_bytes)
            std::memcpy(out, images + whole_index[cell] * image_bytes, row_bytes);
        if (tail != 0) std::memcpy(out, images + whole_index[whole] * image_bytes, tail * texel_bytes);
        out_row += copy.out_row_texels * texel_bytes;
    }
}

}  // namespace detail

template <std::size_t texel_bytes>
void copy_cell_rows(const CellRowCopy& copy) {
    switch (copy.side_log2) {
        case 0:
            return detail::copy_cell_rows<texel_bytes, 1>(copy);
        case 1:
            return detail::copy_cell_rows<texel_bytes, 2>(copy);
        case 2:
            return detail::copy_cell_rows<texel_bytes, 4>(copy);
        case 3:
            return detail::copy_cell_rows<texel_bytes, 8>(copy);
        case 4:
            return detail::copy_cell_rows<texel_bytes, 16>(copy);
        default:
            return detail::copy_cell_rows<texel_bytes, 0>(copy);
    }
}

}  // namespace tessera
