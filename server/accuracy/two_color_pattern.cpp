#include "server/accuracy/two_color_pattern.h"

#include <cmath>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

std::int64_t floor_div(std::int64_t a, std::int64_t b) noexcept { return a / b - (a % b < 0 ? 1 : 0); }

/// Where an edge enters the next column (or row): the parameter 0 to 1, and the column (or row) it is in.
class Crossings {
  public:
    Crossings(double from, double to) : from_{from}, length_{to - from} {
        step_ = length_ > 0 ? 1 : -1;
        // A start on a border belongs to the side that the edge goes to
        index_ = static_cast<std::int64_t>(step_ > 0 ? std::floor(from) : std::ceil(from) - 1);
        find_next();
    }
    std::int64_t index() const noexcept { return index_; }
    double next() const noexcept { return next_; }
    void cross() noexcept {
        index_ += step_;
        find_next();
    }

  private:
    void find_next() noexcept {
        const double border = static_cast<double>(step_ > 0 ? index_ + 1 : index_);
        next_ = length_ == 0 ? 2 : (border - from_) / length_;
    }
    double from_, length_, next_ = 2;
    std::int64_t index_ = 0, step_ = 1;
};

}  // namespace

LinearImage draw(const TwoColorPattern& pattern) {
    LinearImage image(pattern.width * pattern.square_texels, pattern.height * pattern.square_texels);
    for (std::int32_t y = 0; y < image.height; ++y)
        for (std::int32_t x = 0; x < image.width; ++x) {
            const std::int32_t column = x / pattern.square_texels, row = y / pattern.square_texels;
            const bool ink =
                pattern.inked[std::size_t(row) * std::size_t(pattern.width) + std::size_t(column)] != 0;
            float* texel = image.row(y) + 4 * std::size_t(x);
            for (std::size_t c = 0; c < 3; ++c) texel[c] = from_srgb((ink ? pattern.ink : pattern.ground)[c]);
            texel[3] = 1;
        }
    return image;
}

InkIntegral::InkIntegral(const TwoColorPattern& pattern)
    : square_texels_{pattern.square_texels}, width_{pattern.width}, height_{pattern.height} {
    sums_.reserve(std::size_t(height_) * (std::size_t(width_) + 1));
    for (std::int32_t row = 0; row < height_; ++row) {
        std::int32_t sum = 0;
        sums_.push_back(0);
        for (std::int32_t column = 0; column < width_; ++column) {
            sum += pattern.inked[std::size_t(row) * std::size_t(width_) + std::size_t(column)];
            sums_.push_back(sum);
        }
    }
}

std::int64_t InkIntegral::before(std::int64_t column, std::int64_t row) const noexcept {
    const std::int64_t period = floor_div(column, width_);
    const std::int32_t* sums = sums_.data() + (row - floor_div(row, height_) * height_) * (width_ + 1);
    return period * sums[width_] + sums[column - period * width_];
}

bool InkIntegral::inked_at(std::int64_t column, std::int64_t row) const noexcept {
    const std::int64_t at = column - floor_div(column, width_) * width_;
    const std::int32_t* sums = sums_.data() + (row - floor_div(row, height_) * height_) * (width_ + 1);
    return sums[at + 1] != sums[at];
}

double InkIntegral::along_edge(const Place& place, TexelPoint from, TexelPoint to) const {
    const double dx = to.x - from.x, dy = to.y - from.y;
    if (dy == 0) return 0;
    Crossings columns{from.x, to.x}, rows{from.y, to.y};
    double sum = 0, begin = 0;
    while (begin < 1) {
        const double end = std::fmin(1, std::fmin(columns.next(), rows.next()));
        const std::int64_t column = place.column + columns.index(), row = place.row + rows.index();
        // Inside one square F is linear, and so its mean is its value in the middle
        const double middle = from.x + dx * (begin + end) / 2;
        const auto whole = static_cast<double>(before(column, row) - before(place.column, row));
        const double part = inked_at(column, row) ? middle - static_cast<double>(columns.index()) : 0;
        sum += (end - begin) * dy * (whole + part);
        begin = end;
        if (columns.next() <= end) columns.cross();
        if (rows.next() <= end) rows.cross();
    }
    return sum;
}

double InkIntegral::share(const Footprint& footprint) const {
    const Place place{floor_div(footprint.x, square_texels_), floor_div(footprint.y, square_texels_)};
    const double left = static_cast<double>(footprint.x - place.column * square_texels_),
                 top = static_cast<double>(footprint.y - place.row * square_texels_);
    std::array<TexelPoint, 4> corners;
    for (std::size_t i = 0; i < 4; ++i)
        corners[i] = {(left + footprint.corners[i].x) / square_texels_,
                      (top + footprint.corners[i].y) / square_texels_};
    double inked = 0, area = 0;
    TexelPoint middle;
    for (std::size_t i = 0; i < 4; ++i) {
        const TexelPoint a = corners[i], b = corners[(i + 1) % 4];
        inked += along_edge(place, a, b);
        area += (b.y - a.y) * (a.x + b.x) / 2;
        middle = {middle.x + a.x / 4, middle.y + a.y / 4};
    }
    if (std::fabs(area) < 1e-12)
        return inked_at(place.column + static_cast<std::int64_t>(std::floor(middle.x)),
                        place.row + static_cast<std::int64_t>(std::floor(middle.y)))
                   ? 1
                   : 0;
    return std::fmin(1, std::fmax(0, inked / area));
}

}  // namespace tessera
