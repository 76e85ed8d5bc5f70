#include "server/texture/stamps.h"

#include <algorithm>

namespace tessera {
namespace {

/// One stamp at one level as a dense box of the tile's texel grid.
struct Box {
    std::int32_t x = 0, y = 0, width = 0, height = 0;
    std::vector<double> rgb;

    Box(std::int32_t left, std::int32_t top, std::int32_t right, std::int32_t bottom)
        : x{left},
          y{top},
          width{right - left},
          height{bottom - top},
          rgb(std::size_t(width) * std::size_t(height) * 3) {}
    double* at(std::int32_t px, std::int32_t py) noexcept {
        return rgb.data() + (std::size_t(py - y) * std::size_t(width) + std::size_t(px - x)) * 3;
    }
};

/// weight·(content − mean) at level 0, linear.
Box level_0_stamp(const PatchMap::Patch& patch, const ExemplarTexels::Content& content,
                  const ColorSteps& mean) {
    Box box{patch.x, patch.y, patch.x + patch.width, patch.y + patch.height};
    double* out = box.rgb.data();
    const std::uint16_t* weight = patch.weights.data();
    for (std::int32_t y = 0; y < patch.height; ++y) {
        const std::uint16_t* steps =
            content.source->steps.data() +
            (content.offset + std::size_t(y) * std::size_t(content.source->width)) * 4;
        for (std::int32_t x = 0; x < patch.width; ++x, ++weight, steps += 4, out += 3)
            for (std::size_t c = 0; c < 3; ++c)
                out[c] =
                    double(*weight) * (double(steps[c]) - mean[c]) / (double(PatchMap::weight_one) * 65535.0);
    }
    return box;
}

Box halved(Box& fine) {
    Box coarse{fine.x >> 1, fine.y >> 1, (fine.x + fine.width + 1) >> 1, (fine.y + fine.height + 1) >> 1};
    for (std::int32_t y = fine.y; y < fine.y + fine.height; ++y)
        for (std::int32_t x = fine.x; x < fine.x + fine.width; ++x)
            for (std::size_t c = 0; c < 3; ++c) coarse.at(x >> 1, y >> 1)[c] += 0.25 * fine.at(x, y)[c];
    return coarse;
}

}  // namespace

Stamps::Stamps(const PatchMap& map, const ExemplarTexels& texels, const ColorSteps& mean) {
    // Lay out each level: patches one after another, a patch's contents one after another
    for (const PatchMap::Level& level : map.levels()) {
        Level made;
        std::size_t floats = 0;
        if (!levels_.empty()) {
            for (std::size_t p = 0; p < map.patches().size(); ++p) {
                made.patch_begin.push_back(floats);
                made.content_stride.push_back(std::size_t{level.stamp_texels[p]} * 3);
                floats += made.content_stride.back() * texels.content_count(p);
            }
            made.values.resize(floats + 16);  // kernels read whole vectors
        }
        levels_.push_back(std::move(made));
    }

    // The spans of each patch, so that a stamp is packed in one walk
    struct Row {
        std::int32_t y = 0;
        PatchMap::Span span;
    };
    std::vector<std::vector<std::vector<Row>>> rows(levels_.size(),
                                                    std::vector<std::vector<Row>>(map.patches().size()));
    for (std::size_t level = 1; level < levels_.size(); ++level)
        for (std::int32_t y = 0; y < 2 * map.levels()[level].side; ++y)
            for (const PatchMap::Span& span : map.levels()[level].row(y))
                rows[level][span.patch].push_back({y, span});

    for (std::size_t p = 0; p < map.patches().size(); ++p)
        for (std::size_t content = 0; content < texels.content_count(p); ++content) {
            Box box = level_0_stamp(map.patches()[p], texels.content(p, content), mean);
            for (std::size_t level = 1; level < levels_.size(); ++level) {
                box = halved(box);
                float* stamp = levels_[level].values.data() + levels_[level].patch_begin[p] +
                               content * levels_[level].content_stride[p];
                for (const auto& [y, span] : rows[level][p])
                    std::transform(box.at(span.begin, y), box.at(span.begin, y) + (span.end - span.begin) * 3,
                                   stamp + std::size_t{span.offset} * 3,
                                   [](double value) { return static_cast<float>(value); });
            }
        }
}

std::size_t Stamps::memory_bytes() const noexcept {
    std::size_t bytes = 0;
    for (const Level& level : levels_) bytes += level.values.size() * sizeof(float);
    return bytes;
}

}  // namespace tessera
