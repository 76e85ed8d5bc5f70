#include "server/scene/png_file.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <memory>

#include <libdeflate.h>

namespace tessera {
namespace {

void append_number(std::vector<std::uint8_t>& out, std::uint32_t number) {
    for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<std::uint8_t>(number >> shift));
}

std::uint32_t read_number(const unsigned char* bytes) {
    return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 |
           bytes[3];
}

/// The neighbour closest to left + up − corner (PNG specification, 9.4).
int paeth(int left, int up, int corner) {
    const int to_left = std::abs(up - corner);
    const int to_up = std::abs(left - corner);
    const int to_corner = std::abs(left + up - 2 * corner);
    if (to_left <= to_up && to_left <= to_corner) return left;
    return to_up <= to_corner ? up : corner;
}

int predict(int filter, int left, int up, int corner) {
    switch (filter) {
        case 1:
            return left;
        case 2:
            return up;
        case 3:
            return (left + up) / 2;
        case 4:
            return paeth(left, up, corner);
        default:
            return 0;
    }
}

/// Each row behind the filter whose residuals are smallest in sum: the specification's own heuristic.
std::vector<std::uint8_t> filter_rows(std::size_t row_bytes, std::size_t texel_bytes, std::size_t height,
                                      std::span<const std::uint8_t> rows) {
    std::vector<std::uint8_t> filtered;
    filtered.reserve((row_bytes + 1) * height);
    const std::vector<std::uint8_t> black(row_bytes);
    std::array<std::vector<std::uint8_t>, 5> residuals;
    for (auto& residual : residuals) residual.resize(row_bytes);
    for (std::size_t y = 0; y < height; ++y) {
        const std::uint8_t* row = rows.data() + y * row_bytes;
        const std::uint8_t* above = y == 0 ? black.data() : row - row_bytes;
        std::size_t best = 0;
        std::uint64_t best_sum = ~std::uint64_t{0};
        for (std::size_t filter = 0; filter < residuals.size(); ++filter) {
            std::uint64_t sum = 0;
            for (std::size_t i = 0; i < row_bytes; ++i) {
                const int left = i < texel_bytes ? 0 : row[i - texel_bytes];
                const int corner = i < texel_bytes ? 0 : above[i - texel_bytes];
                const int residual = row[i] - predict(static_cast<int>(filter), left, above[i], corner);
                residuals[filter][i] = static_cast<std::uint8_t>(residual);
                sum += static_cast<std::uint64_t>(std::abs(static_cast<std::int8_t>(residuals[filter][i])));
            }
            if (sum < best_sum) {
                best_sum = sum;
                best = filter;
            }
        }
        filtered.push_back(static_cast<std::uint8_t>(best));
        filtered.insert(filtered.end(), residuals[best].begin(), residuals[best].end());
    }
    return filtered;
}

}  // namespace

std::vector<std::uint8_t> start_png(std::int32_t width, std::int32_t height, PngColor color, int bits) {
    std::vector<std::uint8_t> png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    std::vector<std::uint8_t> header;
    append_number(header, static_cast<std::uint32_t>(width));
    append_number(header, static_cast<std::uint32_t>(height));
    header.insert(header.end(), {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(color), 0, 0, 0});
    append_png_chunk(png, "IHDR", header);
    return png;
}

void append_png_chunk(std::vector<std::uint8_t>& png, std::string_view name,
                      std::span<const std::uint8_t> data) {
    append_number(png, static_cast<std::uint32_t>(data.size()));
    const std::size_t start = png.size();
    png.insert(png.end(), name.begin(), name.end());
    png.insert(png.end(), data.begin(), data.end());
    append_number(png, libdeflate_crc32(0, png.data() + start, png.size() - start));
}

std::vector<std::uint8_t> to_png(std::int32_t width, std::int32_t height, PngColor color, int bits,
                                 std::span<const std::uint8_t> rows) {
    const std::size_t samples = color == PngColor::rgb ? 3 : color == PngColor::rgba ? 4 : 1;
    const std::size_t texel_bits = samples * static_cast<std::size_t>(bits);
    const std::size_t row_bytes = (static_cast<std::size_t>(width) * texel_bits + 7) / 8;
    const std::vector<std::uint8_t> filtered = filter_rows(
        row_bytes, std::max<std::size_t>(1, texel_bits / 8), static_cast<std::size_t>(height), rows);

    const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor{
        libdeflate_alloc_compressor(6), libdeflate_free_compressor};
    std::vector<std::uint8_t> packed(libdeflate_zlib_compress_bound(compressor.get(), filtered.size()));
    packed.resize(libdeflate_zlib_compress(compressor.get(), filtered.data(), filtered.size(), packed.data(),
                                           packed.size()));
    std::vector<std::uint8_t> png = start_png(width, height, color, bits);
    append_png_chunk(png, "IDAT", packed);
    append_png_chunk(png, "IEND", {});
    return png;
}

Result<void> check_png(const std::filesystem::path& file) {
    const Error truncated{ErrorCode::invalid_input, "it ends too early"};
    std::ifstream in{file, std::ios::binary};
    if (!in.ignore(8)) return truncated;  // the signature
    std::vector<char> block(1 << 16);
    for (;;) {
        std::array<unsigned char, 8> head{};
        if (!in.read(reinterpret_cast<char*>(head.data()), std::ssize(head))) return truncated;
        std::uint32_t left = read_number(head.data());
        std::uint32_t sum = libdeflate_crc32(0, head.data() + 4, 4);
        while (left > 0) {
            const std::uint32_t now = std::min(left, static_cast<std::uint32_t>(block.size()));
            if (!in.read(block.data(), now)) return truncated;
            sum = libdeflate_crc32(sum, block.data(), now);
            left -= now;
        }
        std::array<unsigned char, 4> tail{};
        if (!in.read(reinterpret_cast<char*>(tail.data()), std::ssize(tail))) return truncated;
        if (read_number(tail.data()) != sum) return Error{ErrorCode::invalid_input, "a checksum is wrong"};
        if (std::equal(head.begin() + 4, head.end(), "IEND")) return {};
    }
}

}  // namespace tessera
