#include "server/quality/quiet_curves.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <limits>
#include <queue>

#include "server/quality/lab.h"

namespace tessera {
namespace {

constexpr std::int32_t largest_side = 128;
constexpr std::int32_t places_each_way = 3;
/// Added to each step, so that of curves that cost nothing the shortest is taken.
constexpr float length_price = 0.01F;

/// The corners between the texels of a square of the exemplar, and steps across the lines between corners.
/// A curve that goes around the middle crosses the ray from there to the right an odd number of times:
/// every corner is there twice, before and after such a crossing.
class Square {
  public:
    Square(const Rgb8Image& image, std::int32_t left, std::int32_t top, std::int32_t side)
        : image_{image},
          left_{left},
          top_{top},
          corners_{side + 1},
          middle_{side / 2},
          heart_{std::max(1, side / 5)} {
        for (std::int32_t y = 0; y < corners_; ++y)
            for (std::int32_t x = 0; x < corners_; ++x) {
                // A line to the right parts the texels above and below; one downwards those left and right
                right_.push_back(x + 1 < corners_ ? step(x, y - 1, x, y) : 0);
                down_.push_back(y + 1 < corners_ ? step(x - 1, y, x, y) : 0);
            }
    }

    /// Adds the steps of the quietest curve.
    void add_quietest(Histogram& steps) {
        float best = std::numeric_limits<float>::max();
        std::vector<std::int32_t> curve;
        for (std::int32_t x = middle_ + heart_; x + 1 < corners_; ++x) find_through(x, best, curve);
        for (std::size_t i = 0; i + 1 < curve.size(); ++i) steps.add(between(curve[i] / 2, curve[i + 1] / 2));
    }

  private:
    float step(std::int32_t x, std::int32_t y, std::int32_t to_x, std::int32_t to_y) const {
        const auto lab = [&](std::int32_t u, std::int32_t v) {
            u = std::clamp(left_ + u, 0, image_.width - 1);
            v = std::clamp(top_ + v, 0, image_.height - 1);
            return to_lab(image_.bytes.data() +
                          (std::size_t(v) * std::size_t(image_.width) + std::size_t(u)) * 3);
        };
        return difference(lab(x, y), lab(to_x, to_y));
    }
    float between(std::int32_t a, std::int32_t b) const {
        const auto first = static_cast<std::size_t>(std::min(a, b));
        return std::abs(a - b) == 1 ? right_[first] : down_[first];
    }
    bool open(std::int32_t x, std::int32_t y) const {
        return x > 0 && y > 0 && x + 1 < corners_ && y + 1 < corners_ &&
               std::max(std::abs(x - middle_), std::abs(y - middle_)) >= heart_;
    }

    /// The cheapest curve through the corner (x, middle), if it costs less than `best`.
    void find_through(std::int32_t x, float& best, std::vector<std::int32_t>& curve) {
        const std::int32_t nodes = 2 * corners_ * corners_, start = 2 * (middle_ * corners_ + x);
        std::vector<float> costs(static_cast<std::size_t>(nodes), std::numeric_limits<float>::max());
        std::vector<std::int32_t> from(static_cast<std::size_t>(nodes), -1);
        using Open = std::pair<float, std::int32_t>;
        std::priority_queue<Open, std::vector<Open>, std::greater<>> queue;
        const auto reach = [&](std::int32_t node, float cost, std::int32_t before) {
            if (cost >= best || cost >= costs[static_cast<std::size_t>(node)]) return;
            costs[static_cast<std::size_t>(node)] = cost;
            from[static_cast<std::size_t>(node)] = before;
            queue.push({cost, node});
        };
        reach(start, 0, -1);
        while (!queue.empty() && queue.top().second != start + 1) {
            const auto [cost, node] = queue.top();
            queue.pop();
            if (cost > costs[static_cast<std::size_t>(node)]) continue;
            const std::int32_t corner = node / 2, u = corner % corners_, v = corner / corners_;
            constexpr std::array<std::array<std::int32_t, 2>, 4> ways{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
            for (const auto& [du, dv] : ways) {
                if (!open(u + du, v + dv)) continue;
                // The ray lies just above the row of the middle
                const bool crosses = dv != 0 && u > middle_ && std::max(v, v + dv) == middle_;
                const std::int32_t to = corner + dv * corners_ + du;
                reach(2 * to + ((node % 2) ^ int{crosses}), cost + between(corner, to) + length_price, node);
            }
        }
        if (queue.empty()) return;
        best = queue.top().first;
        curve.clear();
        for (std::int32_t node = start + 1; node >= 0; node = from[static_cast<std::size_t>(node)])
            curve.push_back(node);
    }

    const Rgb8Image& image_;
    std::int32_t left_, top_, corners_, middle_, heart_;
    std::vector<float> right_, down_;
};

}  // namespace

Result<Histogram> steps_of_quiet_curves(const Rgb8Image& exemplar, std::int32_t side,
                                        const ProgressPart& progress) {
    Histogram steps{0, 300};
    side = std::min(side, largest_side) & ~1;
    if (side < 8 || side > std::min(exemplar.width, exemplar.height)) return steps;
    for (std::int32_t row = 0; row < places_each_way; ++row)
        for (std::int32_t column = 0; column < places_each_way; ++column) {
            progress.advance(double(row * places_each_way + column) / (places_each_way * places_each_way));
            if (progress.progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
            const auto at = [](std::int32_t i, std::int32_t room) {
                return i * room / (places_each_way - 1);
            };
            Square{exemplar, at(column, exemplar.width - side), at(row, exemplar.height - side), side}
                .add_quietest(steps);
        }
    progress.advance(1);
    return steps;
}

}  // namespace tessera
