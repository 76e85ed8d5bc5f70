#include "server/pattern/instance_images.h"

#include <algorithm>
#include <array>
#include <limits>

#include "server/filter/turned_image.h"
#include "server/pattern/premultiplied_steps.h"

namespace tessera {
namespace {

/// More looks than this are not listed one by one: their images alone are beyond any memory.
constexpr std::size_t most_looks = std::size_t{1} << 24;

struct Counts {
    std::size_t patterns, turns, scales;
    explicit Counts(const ReferencePlan& plan)
        : patterns{static_cast<std::size_t>(plan.patterns->count)},
          turns{plan.transform->turns.size()},
          scales{plan.transform->scales.size()} {}
    std::size_t looks() const noexcept { return patterns * turns * scales; }
    std::size_t index(std::int32_t pattern, std::size_t turn, std::size_t scale) const noexcept {
        return (static_cast<std::size_t>(pattern) * turns + turn) * scales + scale;
    }
};

std::int32_t image_side(const ReferencePlan& plan, std::size_t turn, std::size_t scale) {
    return bounding_side(plan.patterns->side, plan.transform->scales[scale], plan.transform->turns[turn]);
}

}  // namespace

std::vector<bool> InstanceImages::shown_looks(const ReferencePlan& plan) {
    const Counts counts{plan};
    std::vector<bool> shown(counts.looks());
    const auto show = [&](std::int32_t pattern, std::size_t turn, std::size_t scale) {
        if (pattern >= 0) shown[counts.index(pattern, turn, scale)] = true;
    };
    const auto show_type = [&](std::uint16_t type) {
        const Look look = plan.program->look_of_type(type);
        show(look.pattern, look.turn, look.scale);
    };
    switch (plan.program->basis()) {
        case CellProgram::Basis::constant:
            show_type(0);
            break;
        case CellProgram::Basis::typed:
            for (std::uint32_t type = 0; type < plan.grid.quadtree->types(); ++type)
                show_type(static_cast<std::uint16_t>(type));
            break;
        case CellProgram::Basis::stationary:
            for (const LookShare& share : plan.program->shares({}))
                show(share.pattern, share.turn, share.scale);
            break;
        default:
            shown.assign(counts.looks(), true);
    }
    return shown;
}

std::uint64_t InstanceImages::bytes(const ReferencePlan& plan) {
    const Counts counts{plan};
    if (counts.looks() > most_looks) return std::numeric_limits<std::uint64_t>::max();
    const std::vector<bool> shown = shown_looks(plan);
    std::uint64_t total = counts.looks() * sizeof(std::int32_t) + plan.patterns->codes.size() * 2;
    for (std::size_t turn = 0; turn < counts.turns; ++turn)
        for (std::size_t scale = 0; scale < counts.scales; ++scale) {
            const std::int32_t side = image_side(plan, turn, scale);
            const std::uint64_t image = SummedArea::bytes(side, side) + sizeof(SummedArea);
            for (std::int32_t pattern = 0; pattern < plan.patterns->count; ++pattern)
                if (shown[counts.index(pattern, turn, scale)])
                    total += image * static_cast<std::uint64_t>(plan.patterns->slices);
        }
    return total;
}

InstanceImages::InstanceImages(const ReferencePlan& plan)
    : turns_{plan.transform->turns.size()},
      scales_{plan.transform->scales.size()},
      slices_{plan.patterns->slices} {
    const Counts counts{plan};
    const std::vector<bool> shown = shown_looks(plan);
    const std::vector<std::uint16_t> steps = premultiplied_steps(*plan.patterns);
    first_.assign(counts.looks(), -1);
    for (std::size_t turn = 0; turn < turns_; ++turn)
        for (std::size_t scale = 0; scale < scales_; ++scale) {
            const std::size_t before = images_.size();
            const std::int32_t side = image_side(plan, turn, scale);
            for (std::int32_t pattern = 0; pattern < plan.patterns->count; ++pattern) {
                if (!shown[counts.index(pattern, turn, scale)]) continue;
                first_[counts.index(pattern, turn, scale)] = static_cast<std::int32_t>(images_.size());
                for (std::int32_t slice = 0; slice < slices_; ++slice) images_.emplace_back(side, side);
            }
            if (images_.size() > before) render(plan, turn, scale, steps);
        }
}

/// Weights depend on the turn and the scale only: they are found once, and serve every pattern.
void InstanceImages::render(const ReferencePlan& plan, std::size_t turn, std::size_t scale,
                            const std::vector<std::uint16_t>& steps) {
    const std::int32_t side = image_side(plan, turn, scale);
    TurnedImage turned{{.side = plan.patterns->side,
                        .scale = plan.transform->scales[scale],
                        .turns = plan.transform->turns[turn],
                        .width = side,
                        .middle_x = 0.5 * side,
                        .middle_y = 0.5 * side}};
    const auto pattern_side = static_cast<std::size_t>(plan.patterns->side);
    std::vector<std::uint16_t> texels(static_cast<std::size_t>(side) * 4);
    for (std::int32_t y = 0; y < side; ++y) {
        turned.set_row(y);
        for (std::int32_t pattern = 0; pattern < plan.patterns->count; ++pattern) {
            const std::int32_t first = first_[look_index(pattern, turn, scale)];
            if (first < 0) continue;
            for (std::int32_t slice = 0; slice < slices_; ++slice) {
                const std::size_t image =
                    static_cast<std::size_t>(pattern) * static_cast<std::size_t>(slices_) +
                    static_cast<std::size_t>(slice);
                turned.sum(steps.data() + image * pattern_side * pattern_side * 4, texels.data());
                images_[static_cast<std::size_t>(first + slice)].set_row(y, texels.data());
            }
        }
    }
}

LookMeans InstanceImages::means(int cell_log2) const {
    LookMeans result{.turns = static_cast<std::int32_t>(turns_),
                     .scales = static_cast<std::int32_t>(scales_),
                     .slices = slices_,
                     .means = {}};
    result.means.resize(first_.size() * static_cast<std::size_t>(slices_));
    const double unit = 65535.0 * static_cast<double>(std::uint64_t{1} << 2 * cell_log2);
    for (std::size_t look = 0; look < first_.size(); ++look) {
        if (first_[look] < 0) continue;
        for (std::int32_t slice = 0; slice < slices_; ++slice) {
            const SummedArea& image = images_[static_cast<std::size_t>(first_[look] + slice)];
            const SummedArea::Sums sums = image.sum(0, 0, image.width(), image.height());
            auto& mean =
                result.means[look * static_cast<std::size_t>(slices_) + static_cast<std::size_t>(slice)];
            for (std::size_t channel = 0; channel < 4; ++channel)
                mean[channel] = static_cast<double>(sums[channel]) / unit;
        }
    }
    return result;
}

std::size_t InstanceImages::memory_bytes() const noexcept {
    std::size_t bytes = sizeof *this + first_.size() * sizeof(std::int32_t);
    for (const SummedArea& image : images_) bytes += sizeof image + image.memory_bytes();
    return bytes;
}

void instance_row(const SummedArea& image, std::int64_t left, std::int64_t top, int level, std::int64_t y,
                  std::int64_t from_x, std::int64_t to_x, float* out) noexcept {
    const std::int64_t side = std::int64_t{1} << level;
    const auto inside = [](std::int64_t at, std::int32_t size) {
        return static_cast<std::int32_t>(std::clamp<std::int64_t>(at, 0, size));
    };
    const std::int32_t y0 = inside(y * side - top, image.height()),
                       y1 = inside((y + 1) * side - top, image.height());
    const double factor = 1.0 / (65535.0 * static_cast<double>(side * side));
    std::int32_t x0 = inside(from_x * side - left, image.width());
    if (level <= 8) {
        // Boxes of at most 2^16 texels: one difference each, shared with the neighbour
        const std::uint32_t* upper = image.line(y0);
        const std::uint32_t* lower = image.line(y1);
        std::array<std::uint32_t, 4> before;
        for (std::size_t c = 0; c < 4; ++c)
            before[c] =
                lower[static_cast<std::size_t>(x0) * 4 + c] - upper[static_cast<std::size_t>(x0) * 4 + c];
        for (std::int64_t x = from_x; x < to_x; ++x, out += 4) {
            const auto at = static_cast<std::size_t>(inside((x + 1) * side - left, image.width())) * 4;
            for (std::size_t c = 0; c < 4; ++c) {
                const std::uint32_t sum = lower[at + c] - upper[at + c];
                out[c] = static_cast<float>(static_cast<double>(sum - before[c]) * factor);
                before[c] = sum;
            }
        }
        return;
    }
    for (std::int64_t x = from_x; x < to_x; ++x, out += 4) {
        const std::int32_t x1 = inside((x + 1) * side - left, image.width());
        const SummedArea::Sums sums = image.sum(x0, y0, x1, y1);
        for (std::size_t c = 0; c < 4; ++c)
            out[c] = static_cast<float>(static_cast<double>(sums[c]) * factor);
        x0 = x1;
    }
}

}  // namespace tessera
