#include "server/texture/edge_codes.h"

#include "shared/math/srgb.h"

namespace tessera {

EdgeCodes::EdgeCodes(const Shapes& shapes, const TexelSource& exemplar, const TexelSource& tile)
    : codes_(shapes.weight_count() * 4) {
    const auto& codes = steps_to_srgb();
    const std::int32_t wrap = tile.height() - 1;
    constexpr std::uint32_t one = Shapes::weight_one;
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        const Shapes::Shape& shape = shapes[s];
        for (std::int32_t y = 0; y < shape.height; ++y)
            for (const Shapes::Segment& segment : shapes.row(shape, y)) {
                if (segment.weights == Shapes::Segment::all_one) continue;
                std::uint8_t* to = codes_.data() + std::size_t{segment.weights} * 4;
                const std::uint16_t* weight = shapes.weights(segment);
                for (std::int32_t x = segment.begin; x < segment.end; ++x, ++weight, to += 4) {
                    for (std::int32_t c = 0; c < 3; ++c) {
                        const std::uint32_t shown = exemplar.step(shape.from_x + x, shape.from_y + y, c);
                        const std::uint32_t under = tile.step((shape.x & wrap) + x, (shape.y + y) & wrap, c);
                        to[c] = codes[(shown * *weight + under * (one - *weight) + one / 2) / one];
                    }
                    to[3] = 255;
                }
            }
    }
}

}  // namespace tessera
