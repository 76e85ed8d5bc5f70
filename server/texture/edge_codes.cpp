#include "server/texture/edge_codes.h"

#include <algorithm>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// In linear steps times weight_one, tile and parts together.
struct Sum {
    std::uint32_t rgb[3];
};

}  // namespace

EdgeCodes::EdgeCodes(const Shapes& shapes, const JoinedShapes& joined, const TexelSource& exemplar,
                     const TexelSource& tile)
    : codes_(joined.uncopied_texels() * 4) {
    const auto& codes = steps_to_srgb();
    const std::int32_t wrap = tile.height() - 1;
    constexpr std::uint32_t one = Shapes::weight_one;
    std::vector<Sum> sums;
    for (std::size_t s = 0; s < joined.size(); ++s) {
        const JoinedShapes::Joined& shape = joined[s];
        for (std::int32_t y = 0; y < shape.height; ++y)
            for (const JoinedShapes::Span& span : joined.row(shape, y)) {
                if (span.kind == JoinedShapes::Kind::copied) continue;
                sums.clear();
                for (std::int32_t x = span.begin; x < span.end; ++x) {
                    const auto under = [&](std::int32_t c) {
                        return std::uint32_t{tile.step((shape.x + x) & wrap, (shape.y + y) & wrap, c)} * one;
                    };
                    sums.push_back({{under(0), under(1), under(2)}});
                }
                for (const JoinedShapes::Part& part : joined.parts(span)) {
                    const bool whole = part.weights == Shapes::Segment::all_one;
                    const std::uint16_t* weight =
                        whole ? nullptr : shapes.weights({part.begin, part.end, part.weights});
                    auto from = static_cast<std::int32_t>(part.from);
                    const std::int32_t v = from / exemplar.width(), u = from % exemplar.width();
                    for (std::int32_t i = 0; i < part.end - part.begin; ++i) {
                        const std::int32_t x = part.begin + i;
                        Sum& sum = sums[static_cast<std::size_t>(x - span.begin)];
                        const std::uint32_t share = whole ? one : weight[i];
                        // Differences wrap round, their sum does not
                        for (std::int32_t c = 0; c < 3; ++c)
                            sum.rgb[c] += share * (std::uint32_t{exemplar.step(u + i, v, c)} -
                                                   tile.step((shape.x + x) & wrap, (shape.y + y) & wrap, c));
                    }
                }
                std::uint8_t* to = codes_.data() + std::size_t{span.from} * 4;
                for (const Sum& sum : sums) {
                    for (std::int32_t c = 0; c < 3; ++c) to[c] = codes[(sum.rgb[c] + one / 2) / one];
                    to[3] = 255;
                    to += 4;
                }
            }
    }
}

}  // namespace tessera
