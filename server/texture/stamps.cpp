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

/// Σ weight·(content − tile), in steps times weight_one.
Box level_0_stamp(const Shapes& shapes, const Shapes::Shape& shape, const TexelSource& exemplar,
                  const TexelSource& tile) {
    Box box{shape.x, shape.y, shape.x + shape.width, shape.y + shape.height};
    const std::int32_t wrap = tile.height() - 1;
    for (std::int32_t y = 0; y < shape.height; ++y) {
        std::int64_t* out = box.row(shape.y + y);
        for (const Shapes::Segment& segment : shapes.row(shape, y))
            for (std::int32_t x = segment.begin; x < segment.end; ++x) {
                const std::int64_t weight = segment.weights == Shapes::Segment::all_one
                                                ? std::int64_t{Shapes::weight_one}
                                                : shapes.weights(segment)[x - segment.begin];
                for (std::int32_t c = 0; c < 3; ++c)
                    out[x * 3 + c] =
                        weight * (std::int64_t{exemplar.step(shape.from_x + x, shape.from_y + y, c)} -
                                  tile.step((shape.x & wrap) + x, (shape.y + y) & wrap, c));
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

/// The rows' columns that are not zero, as floats.
void pack(Box& box, int level, Stamps::Level& out) {
    const double scale = 1.0 / (double(std::int64_t{1} << (2 * level)) * Shapes::weight_one * linear_one);
    Stamps::Stamp stamp{.y = box.y, .rows = 0, .first_span = static_cast<std::uint32_t>(out.spans.size())};
    for (std::int32_t y = box.y; y < box.y + box.height; ++y) {
        const std::int64_t* row = box.row(y);
        const auto empty = [&](std::int32_t x) {
            return row[x * 3] == 0 && row[x * 3 + 1] == 0 && row[x * 3 + 2] == 0;
        };
        std::int32_t begin = 0, end = box.width;
        while (begin < end && empty(begin)) ++begin;
        while (begin < end && empty(end - 1)) --end;
        out.spans.push_back(
            {box.x + begin, box.x + end, static_cast<std::uint32_t>(out.values.size() / Stamps::row_floats)});
        for (std::int32_t i = begin * 3; i < end * 3; ++i)
            out.values.push_back(static_cast<float>(static_cast<double>(row[i]) * scale));
        out.values.resize((out.values.size() + Stamps::row_floats - 1) / Stamps::row_floats *
                          Stamps::row_floats);
        ++stamp.rows;
    }
    out.stamps.push_back(stamp);
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

Stamps::Stamps(const Shapes& shapes, const TexelSource& exemplar, const TexelSource& repeated_tile,
               int tile_level)
    : levels_(std::size_t(tile_level) + 1) {
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        Box box = level_0_stamp(shapes, shapes[s], exemplar, repeated_tile);
        for (int level = 1; level <= tile_level; ++level) {
            box = halved(box);
            pack(box, level, levels_[std::size_t(level)]);
        }
    }
    for (Level& level : levels_) {
        level.values.resize(level.values.size() + 16);  // kernels read whole vectors
        level.values.shrink_to_fit();
        level.spans.shrink_to_fit();
    }
}

std::size_t Stamps::memory_bytes() const noexcept {
    std::size_t bytes = 0;
    for (const Level& level : levels_)
        bytes += level.stamps.size() * sizeof(Stamp) + level.spans.size() * sizeof(Span) +
                 level.values.size() * sizeof(float);
    return bytes;
}

}  // namespace tessera
