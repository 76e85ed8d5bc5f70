#include "server/prepare/candidates.h"

#include <algorithm>
#include <cstdlib>

namespace tessera {

using Offset = ExchangeAsset::Offset;

bool lie_apart(const Offset& a, const Offset& b, std::int32_t distance) {
    return std::max(std::abs(a.x - b.x), std::abs(a.y - b.y)) >= distance;
}

std::vector<Candidate> spread(const std::vector<Candidate>& sorted, const std::vector<Offset>& taken,
                              std::int32_t distance, std::size_t count) {
    std::vector<Candidate> chosen;
    for (const Candidate& candidate : sorted) {
        if (chosen.size() == count) break;
        const auto far_from = [&](const Offset& other) { return lie_apart(candidate.at, other, distance); };
        if (std::all_of(taken.begin(), taken.end(), far_from) &&
            std::all_of(chosen.begin(), chosen.end(), [&](const Candidate& c) { return far_from(c.at); }))
            chosen.push_back(candidate);
    }
    return chosen;
}

Liveliness::Liveliness(const PerceptualImage& photo)
    : width_{photo.width},
      sums_(static_cast<std::size_t>(photo.width + 1) * static_cast<std::size_t>(photo.height + 1)) {
    const auto stride = static_cast<std::size_t>(width_ + 1);
    for (std::int32_t y = 0; y < photo.height; ++y) {
        std::uint64_t row = 0;
        for (std::int32_t x = 0; x < photo.width; ++x) {
            const PerceptualColor here = photo.at(x, y);
            row += static_cast<std::uint64_t>(difference(here, photo.at(std::max(0, x - 1), y)) +
                                              difference(here, photo.at(x, std::max(0, y - 1))));
            const std::size_t i = static_cast<std::size_t>(y + 1) * stride + static_cast<std::size_t>(x + 1);
            sums_[i] = sums_[i - stride] + row;
        }
    }
    mean_ =
        sums_.back() / (static_cast<std::uint64_t>(photo.width) * static_cast<std::uint64_t>(photo.height)) +
        1;
}

std::uint64_t Liveliness::sum_to(std::int32_t x, std::int32_t y) const {
    return sums_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) +
                 static_cast<std::size_t>(x)];
}

std::uint64_t Liveliness::weigh(std::uint64_t cost, const Offset& at, std::int32_t width,
                                std::int32_t height) const {
    const std::uint64_t sum = sum_to(at.x + width, at.y + height) - sum_to(at.x, at.y + height) -
                              sum_to(at.x + width, at.y) + sum_to(at.x, at.y);
    const std::uint64_t here = sum / (static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height));
    return cost * 2 * mean_ / (here + mean_);
}

PhotoUses::PhotoUses(const PerceptualImage& photo)
    : width_{photo.width / cell + 1},
      height_{photo.height / cell + 1},
      counts_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

std::uint64_t PhotoUses::relative(const Offset& at, std::int32_t width, std::int32_t height) const {
    std::uint64_t sum = 0, cells = 0;
    for (std::int32_t y = at.y / cell; y <= (at.y + height - 1) / cell; ++y)
        for (std::int32_t x = at.x / cell; x <= (at.x + width - 1) / cell; ++x, ++cells)
            sum += counts_[index(x, y)];
    const std::uint64_t mean = 256 * total_ / counts_.size() + 64;
    return 256 * (256 * sum / cells) / mean;
}

void PhotoUses::add(const Offset& at, std::int32_t width, std::int32_t height) {
    for (std::int32_t y = at.y / cell; y <= (at.y + height - 1) / cell; ++y)
        for (std::int32_t x = at.x / cell; x <= (at.x + width - 1) / cell; ++x, ++total_)
            ++counts_[index(x, y)];
}

}  // namespace tessera
