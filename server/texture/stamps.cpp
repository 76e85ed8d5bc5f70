#include "server/texture/stamps.h"

#include <algorithm>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// A stamp at one level as a dense box, in sums of level-0 texels: integers, so that nothing is rounded on
/// the way.
struct Box {
    std::int32_t x = 0, y = 0, width = 0, height = 0;
    std::vector<std::int64_t> rgb;

    Box(std::int32_t left, std::int32_t top, std::int32_t right, std::int32_t bottom)
        : x{left},
          y{top},
          width{right - left},
          height{bottom - top},
          rgb(std::size_t(width) * std::size_t(height) * 3) {}
    std::int64_t* row(std::int32_t row_y) noexcept {
        return rgb.data() + std::size_t(row_y - y) * std::size_t(width) * 3;
    }
};

/// Σ weight·(content − tile), in steps times weight_one, summed over the texels of level 1.
Box level_1_stamp(const Shapes& shapes, const Shapes::Shape& shape, const TexelSource& exemplar,
                  const TexelSource& tile) {
    Box box{shape.x >> 1, shape.y >> 1, (shape.x + shape.width + 1) >> 1, (shape.y + shape.height + 1) >> 1};
    const std::int32_t wrap = tile.height() - 1;
    for (std::int32_t y = 0; y < shape.height; ++y) {
        std::int64_t* out = box.row((shape.y + y) >> 1);
        for (const Shapes::Segment& segment : shapes.row(shape, y)) {
            const std::uint16_t* weights =
                segment.weights == Shapes::Segment::all_one ? nullptr : shapes.weights(segment);
            for (std::int32_t x = segment.begin; x < segment.end; ++x) {
                const std::int64_t weight =
                    weights == nullptr ? Shapes::weight_one : weights[x - segment.begin];
                std::int64_t* to = out + std::ptrdiff_t{((shape.x + x) >> 1) - box.x} * 3;
                for (std::int32_t c = 0; c < 3; ++c)
                    to[c] += weight * (std::int64_t{exemplar.step(shape.from_x + x, shape.from_y + y, c)} -
                                       tile.step((shape.x & wrap) + x, (shape.y + y) & wrap, c));
            }
        }
    }
    return box;
}

Box halved(Box& fine) {
    Box coarse{fine.x >> 1, fine.y >> 1, (fine.x + fine.width + 1) >> 1, (fine.y + fine.height + 1) >> 1};
    for (std::int32_t y = fine.y; y < fine.y + fine.height; ++y) {
        const std::int64_t* from = fine.row(y);
        std::int64_t* to = coarse.row(y >> 1);
        for (std::int32_t x = fine.x; x < fine.x + fine.width; ++x)
            for (std::int32_t c = 0; c < 3; ++c)
                to[((x >> 1) - coarse.x) * 3 + c] += from[(x - fine.x) * 3 + c];
    }
    return coarse;
}

/// The rows of a stamp, as floats.
void pack(Box& box, int level, const StampSpans::Level& spans, std::size_t shape, std::vector<float>& out) {
    const double scale = 1.0 / (double(std::int64_t{1} << (2 * level)) * Shapes::weight_one * linear_one);
    std::int32_t y = spans.stamps[shape].y;
    for (const StampSpans::Span& span : spans.of(shape)) {
        const std::int64_t* row = box.row(y++);
        if (span.begin == span.end) continue;
        const std::int64_t* from = row + std::ptrdiff_t{span.begin - box.x} * 3;
        float* to = out.data() + std::size_t{span.offset} * StampSpans::row_floats;
        for (std::int32_t i = 0; i < (span.end - span.begin) * 3; ++i)
            to[i] = static_cast<float>(static_cast<double>(from[i]) * scale);
    }
}

}  // namespace

TileLevels::TileLevels(const TexelSource& tile) {
    const std::int32_t side = tile.height();
    std::vector<std::int64_t> sums(std::size_t(side) * std::size_t(side) * 3);
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            for (std::int32_t c = 0; c < 3; ++c)
                sums[(std::size_t(y) * std::size_t(side) + std::size_t(x)) * 3 + std::size_t(c)] =
                    tile.step(x, y, c);
    levels_.emplace_back();
    levels_[0].side = side;
    for (std::int32_t fine = side; fine > 1; fine /= 2) {
        Level level;
        level.side = fine / 2;
        level.stride = level.side + std::max(repeat, level.side);
        std::vector<std::int64_t> coarse(std::size_t(level.side) * std::size_t(level.side) * 3);
        for (std::int32_t y = 0; y < fine; ++y)
            for (std::int32_t x = 0; x < fine; ++x)
                for (std::size_t c = 0; c < 3; ++c)
                    coarse[(std::size_t(y / 2) * std::size_t(level.side) + std::size_t(x / 2)) * 3 + c] +=
                        sums[(std::size_t(y) * std::size_t(fine) + std::size_t(x)) * 3 + c];
        sums = std::move(coarse);
        const double texels = double(side / level.side) * double(side / level.side);
        for (std::int32_t y = 0; y < level.side; ++y)
            for (std::int32_t x = 0; x < level.stride; ++x)
                for (std::size_t c = 0; c < 3; ++c)
                    level.values.push_back(static_cast<float>(
                        static_cast<double>(
                            sums[(std::size_t(y) * std::size_t(level.side) + std::size_t(x % level.side)) *
                                     3 +
                                 c]) /
                        (texels * linear_one)));
        levels_.push_back(std::move(level));
    }
}

void TileLevels::fill(int level, std::int64_t x, std::int64_t y, std::int32_t width,
                      float* rgb) const noexcept {
    const Level& in = levels_[std::size_t(level)];
    const std::int64_t wrap = in.side - 1;
    const float* from = row(level, static_cast<std::int32_t>(y & wrap));
    for (std::int32_t done = 0; done < width;) {
        const auto start = static_cast<std::int32_t>((x + done) & wrap);
        // Whole repetitions, so that the next piece starts where this one did
        const std::int32_t count = std::min(width - done, in.stride - in.side);
        std::copy_n(from + std::ptrdiff_t{start} * 3, std::ptrdiff_t{count} * 3,
                    rgb + std::ptrdiff_t{done} * 3);
        done += count;
    }
}

std::size_t TileLevels::memory_bytes() const noexcept {
    std::size_t bytes = 0;
    for (const Level& level : levels_) bytes += level.values.size() * sizeof(float);
    return bytes;
}

namespace {

struct Row {
    std::int32_t begin = 0, end = 0;
};

/// What all rows reach over.
Row reach(const std::vector<Row>& rows) {
    Row all;
    for (const Row& row : rows)
        if (row.begin != row.end)
            all =
                all.begin == all.end ? row : Row{std::min(all.begin, row.begin), std::max(all.end, row.end)};
    return all;
}

}  // namespace

StampSpans::StampSpans(const Shapes& shapes, int tile_level) : levels_(std::size_t(tile_level) + 1) {
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        const Shapes::Shape& shape = shapes[s];
        std::int32_t y = shape.y;
        std::vector<Row> rows, coarse;
        for (std::int32_t line = 0; line < shape.height; ++line) {
            const auto segments = shapes.row(shape, line);
            rows.push_back(segments.empty()
                               ? Row{}
                               : Row{shape.x + segments.front().begin, shape.x + segments.back().end});
        }
        for (int level = 1; level <= tile_level; ++level) {
            coarse.assign(std::size_t(((y + static_cast<std::int32_t>(rows.size()) + 1) >> 1) - (y >> 1)),
                          {});
            for (const Row& fine : rows) {
                Row& over = coarse[std::size_t(((y + (&fine - rows.data())) >> 1) - (y >> 1))];
                if (fine.begin == fine.end) continue;
                const Row half{fine.begin >> 1, (fine.end + 1) >> 1};
                over = over.begin == over.end
                           ? half
                           : Row{std::min(over.begin, half.begin), std::max(over.end, half.end)};
            }
            std::swap(rows, coarse);
            y >>= 1;
            Level& out = levels_[std::size_t(level)];
            const Row all = reach(rows);
            const bool box = (all.end - all.begin) * 3 <= box_floats;
            out.stamps.push_back({y, static_cast<std::uint32_t>(rows.size()),
                                  static_cast<std::uint32_t>(out.spans.size()), box});
            for (const Row& own : rows) {
                const Row& row = box ? all : own;
                const auto floats = static_cast<std::size_t>((row.end - row.begin) * 3);
                out.spans.push_back(
                    {row.begin, row.end, static_cast<std::uint32_t>(out.floats / row_floats)});
                out.floats += (floats + row_floats - 1) / row_floats * row_floats;
            }
        }
    }
    for (Level& level : levels_) level.spans.shrink_to_fit();
}

std::size_t StampSpans::memory_bytes() const noexcept {
    std::size_t bytes = 0;
    for (const Level& level : levels_)
        bytes += level.stamps.size() * sizeof(Stamp) + level.spans.size() * sizeof(Span);
    return bytes;
}

Stamps::Stamps(const Shapes& shapes, const StampSpans& spans, const TexelSource& exemplar,
               const TexelSource& repeated_tile, int tile_level)
    : levels_(std::size_t(tile_level) + 1) {
    for (int level = 1; level <= tile_level; ++level)
        levels_[std::size_t(level)].resize(spans.level(level).floats + 16);  // kernels read whole vectors
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        Box box = level_1_stamp(shapes, shapes[s], exemplar, repeated_tile);
        for (int level = 1; level <= tile_level; ++level) {
            if (level > 1) box = halved(box);
            pack(box, level, spans.level(level), s, levels_[std::size_t(level)]);
        }
    }
}

std::size_t Stamps::memory_bytes() const noexcept {
    std::size_t bytes = 0;
    for (const std::vector<float>& level : levels_) bytes += level.size() * sizeof(float);
    return bytes;
}

}  // namespace tessera
