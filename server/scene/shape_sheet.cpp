#include "server/scene/shape_sheet.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

namespace tessera {
namespace {

/// Shelves start at whole bytes, so that rows are copied and not shifted.
constexpr std::int32_t whole_bytes(std::int32_t width) { return (width + 7) / 8 * 8; }

/// A content's shape, or null where it fills its patch.
using Shapes = std::vector<const BitMask*>;

bool all_fill_their_patches(const ExchangeAsset& asset) {
    for (std::size_t p = 0; p < asset.patches.size(); ++p) {
        const BitMask whole = whole_shape(asset, p);
        for (const auto& content : asset.patches[p].contents)
            if (content.shape.width != 0 && content.shape != whole) return false;
    }
    return true;
}

std::int32_t sheet_width(const std::vector<BitMask>& shapes) {
    std::int64_t texels = 0;
    std::int32_t widest = 8;
    for (const BitMask& shape : shapes) {
        texels += std::int64_t{whole_bytes(shape.width)} * shape.height;
        widest = std::max(widest, whole_bytes(shape.width));
    }
    std::int32_t square = 8;
    while (std::int64_t{square} * square < texels) square += 8;
    return std::max(widest, std::min(square, max_sheet_side));
}

}  // namespace

BitMask whole_shape(const ExchangeAsset& asset, std::size_t patch) {
    const auto& [x, y, width, height, contents, set, group] = asset.patches[patch];
    BitMask shape{width, height};
    const std::int32_t mask = asset.tile_side - 1;
    for (std::int32_t v = 0; v < height; ++v)
        for (std::int32_t u = 0; u < width; ++u)
            if (asset.labels.empty() ||
                asset.labels[std::size_t((y + v) & mask) * std::size_t(asset.tile_side) +
                             std::size_t((x + u) & mask)] == patch)
                shape.set(u, v);
    return shape;
}

Result<ShapeSheet> pack_shapes(const ExchangeAsset& asset) {
    ShapeSheet sheet;
    if (all_fill_their_patches(asset)) return sheet;
    std::vector<BitMask> shapes;
    for (std::size_t p = 0; p < asset.patches.size(); ++p)
        for (const auto& content : asset.patches[p].contents)
            shapes.push_back(content.shape.width != 0 ? content.shape : whole_shape(asset, p));

    // Fill shelf after shelf: as high as their first shape, which is the highest of what is left
    std::vector<std::size_t> order(shapes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return shapes[i].height; });
    const std::int32_t width = sheet_width(shapes);
    sheet.places.resize(shapes.size());
    std::int64_t top = 0, bottom = 0;
    std::int32_t x = 0;
    for (const std::size_t i : order) {
        if (x + shapes[i].width > width) top = bottom, x = 0;
        if (x == 0) bottom = top + shapes[i].height;
        if (bottom > max_sheet_side || bottom * width > max_sheet_texels)
            return Error{ErrorCode::invalid_input,
                         "its shapes fill more than " + std::to_string(max_sheet_texels >> 20) +
                             " Mtexels; prepare with a smaller tile, or fewer patches or contents"};
        sheet.places[i] = {x, static_cast<std::int32_t>(top)};
        x += whole_bytes(shapes[i].width);
    }
    sheet.image = BitMask{width, static_cast<std::int32_t>(bottom)};
    const std::size_t row_bytes = static_cast<std::size_t>(width / 8);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const std::size_t bytes = static_cast<std::size_t>(whole_bytes(shapes[i].width) / 8);
        for (std::size_t y = 0; y < static_cast<std::size_t>(shapes[i].height); ++y)
            std::memcpy(sheet.image.bytes.data() +
                            (static_cast<std::size_t>(sheet.places[i].y) + y) * row_bytes +
                            sheet.places[i].x / 8,
                        shapes[i].bytes.data() + y * bytes, bytes);
    }
    return sheet;
}

BitMask cut_shape(const BitMask& sheet, std::int32_t x, std::int32_t y, std::int32_t width,
                  std::int32_t height) {
    BitMask shape{width, height};
    for (std::int32_t v = 0; v < height; ++v)
        for (std::int32_t u = 0; u < width; ++u)
            if (sheet.at(x + u, y + v)) shape.set(u, v);
    return shape;
}

}  // namespace tessera
