#include "server/texture/shapes.h"

#include <algorithm>

namespace tessera {
namespace {

/// Sums over the (2·radius + 1)² texels around each texel of the mask grown by the radius.
std::vector<std::uint32_t> counts_around(const BitMask& mask, std::int32_t radius) {
    const std::int32_t width = mask.width + 2 * radius, height = mask.height + 2 * radius;
    const std::int32_t before = 2 * radius + 1;
    // What the window's rows hold of each column, with as many columns of zeros on both sides
    std::vector<std::uint32_t> columns(std::size_t(before + mask.width + before));
    const auto add = [&](std::int32_t y, std::uint32_t sign) {
        if (y < 0 || y >= mask.height) return;
        for (std::int32_t x = 0; x < mask.width; ++x)
            columns[std::size_t(before + x)] += mask.at(x, y) ? sign : 0;
    };
    std::vector<std::uint32_t> counts(std::size_t(width) * std::size_t(height));
    std::uint32_t* count = counts.data();
    for (std::int32_t y = 0; y < height; ++y) {
        add(y, 1);
        add(y - before, ~std::uint32_t{0});  // wraps round: one less
        std::uint32_t sum = 0;
        for (std::size_t x = 0; x < std::size_t(width); ++x) {
            sum += columns[x + std::size_t(before)] - columns[x];
            *count++ = sum;
        }
    }
    return counts;
}

}  // namespace

Shapes::Shapes(const ExchangeAsset& asset, std::int32_t radius) : radius_{radius} {
    const std::int32_t wrap = asset.tile_side - 1;
    for (std::size_t p = 0; p < asset.patches.size(); ++p) {
        const ExchangeAsset::Patch& patch = asset.patches[p];
        first_of_.push_back(static_cast<std::uint32_t>(shapes_.size()));
        for (std::size_t c = 0; c < patch.contents.size(); ++c) {
            const ExchangeAsset::Content& content = patch.contents[c];
            if (content.standing == ExchangeAsset::Standing::dropped) continue;
            Shape shape;
            shape.patch = static_cast<std::uint32_t>(p);
            shape.content = static_cast<std::uint32_t>(c);
            // Content exchange tabulates tiles, so its boxes begin in theirs; others begin in theirs without
            // blending
            const std::int32_t grown = asset.method == ExchangeMethod::content_exchange ? radius : 0;
            shape.x = ((patch.x - grown) & wrap) + grown - radius;
            shape.y = ((patch.y - grown) & wrap) + grown - radius;
            shape.width = patch.width + 2 * radius;
            shape.height = patch.height + 2 * radius;
            shape.from_x = content.at.x - radius;
            shape.from_y = content.at.y - radius;
            add(content.shape, shape);
        }
    }
    first_of_.push_back(static_cast<std::uint32_t>(shapes_.size()));
    row_begin_.push_back(static_cast<std::uint32_t>(segments_.size()));
    weights_.resize(weights_.size() + 16);  // kernels read whole vectors
}

void Shapes::add(const BitMask& mask, Shape shape) {
    const std::vector<std::uint32_t> counts = counts_around(mask, radius_);
    const auto window = static_cast<std::uint32_t>((2 * radius_ + 1) * (2 * radius_ + 1));
    // Rows of one shape follow each other, and the next shape's first row ends this one's last
    shape.first_row = static_cast<std::uint32_t>(row_begin_.size());
    widest_ = std::max(widest_, shape.width);
    const std::uint32_t* count = counts.data();
    for (std::int32_t y = 0; y < shape.height; ++y, count += shape.width) {
        row_begin_.push_back(static_cast<std::uint32_t>(segments_.size()));
        for (std::int32_t x = 0; x < shape.width;) {
            const std::uint32_t kind = count[x] == 0 ? 0 : count[x] == window ? 2 : 1;
            const auto begin = static_cast<std::uint16_t>(x);
            Segment segment{.begin = begin, .end = begin, .weights = Segment::all_one};
            if (kind == 1) segment.weights = static_cast<std::uint32_t>(weights_.size());
            for (; segment.end < shape.width; ++segment.end) {
                const std::uint32_t here = count[segment.end];
                if ((here == 0 ? 0u : here == window ? 2u : 1u) != kind) break;
                if (kind == 1) weights_.push_back(static_cast<std::uint16_t>(here * weight_one / window));
            }
            if (kind != 0) segments_.push_back(segment);
            x = segment.end;
        }
    }
    shapes_.push_back(shape);
    boxes_.push_back({static_cast<std::int16_t>(shape.x), static_cast<std::int16_t>(shape.y),
                      static_cast<std::int16_t>(shape.width), static_cast<std::int16_t>(shape.height)});
}

std::size_t Shapes::memory_bytes() const noexcept {
    return shapes_.size() * (sizeof(Shape) + sizeof(Box)) + row_begin_.size() * sizeof(std::uint32_t) +
           segments_.size() * sizeof(Segment) + weights_.size() * sizeof(std::uint16_t);
}

}  // namespace tessera
