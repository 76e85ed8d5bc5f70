#include "server/prepare/content_choice.h"

#include <algorithm>
#include <cstdlib>

namespace tessera {
namespace {

/// See ChoiceScale::repetition_weight; what fits most photographs about.
constexpr int first_repetition_weight = 24;
/// The part of a patch's depth, in percent from its border, in which cuts may run.
constexpr int free_depth = 60;

}  // namespace

ChoiceScale::ChoiceScale(const PerceptualImage& photo, const Segmentation& segmentation, std::int32_t wanted)
    : contents{wanted}, texels{std::ssize(segmentation.labels)} {
    repetition_weight = 16 * first_repetition_weight;
    std::int64_t lightness = 0, squares = 0, distances = 0, pairs = 0;
    for (const PerceptualColor& color : photo.colors) {
        lightness += color.lightness;
        squares += std::int64_t{color.lightness} * color.lightness;
    }
    const std::int64_t count = std::ssize(photo.colors);
    mean_lightness = lightness / count;
    variance = std::max<std::int64_t>(64, squares / count - mean_lightness * mean_lightness);
    for (std::int32_t y = 0; y + 1 < photo.height; ++y)
        for (std::int32_t x = 0; x + 1 < photo.width; ++x, pairs += 2)
            distances += color_distance(photo.at(x, y), photo.at(x + 1, y)) +
                         color_distance(photo.at(x, y), photo.at(x, y + 1));
    gradient = std::max<std::int64_t>(1, distances / pairs);

    std::int32_t side = 1;
    while (std::int64_t{side} * side < texels) side *= 2;
    const auto label = [&](std::int32_t x, std::int32_t y) {
        return segmentation.labels[static_cast<std::size_t>((y & (side - 1)) * side + (x & (side - 1)))];
    };
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            borders += (label(x, y) != label(x + 1, y) ? 1 : 0) + (label(x, y) != label(x, y + 1) ? 1 : 0);
}

void ShownSum::add(const ShownSum& other) {
    texels += other.texels;
    sum += other.sum;
    squares += other.squares;
    squared_means += other.squared_means;
}

std::int64_t ShownSum::repetition() const {
    const std::int64_t mean = sum / texels;
    return 10000 * (squared_means / texels - mean * mean) /
           std::max<std::int64_t>(1, squares / texels - mean * mean);
}

PatchContents::PatchContents(PatchGround ground, const PerceptualImage& photo, const ChoiceScale& scale)
    : ground_{std::move(ground)}, photo_{&photo}, scale_{&scale}, tile_(ground_.depths.size()) {
    for (std::int32_t y = 0; y < ground_.height; ++y)
        for (std::int32_t x = 0; x < ground_.width; ++x) {
            if (!ground_.holds(x, y)) continue;
            tile_[ground_.index(x, y)] = deviation(ground_.tile_at(x, y));
            border_ += int{!ground_.holds(x - 1, y)} + int{!ground_.holds(x + 1, y)} +
                       int{!ground_.holds(x, y - 1)} + int{!ground_.holds(x, y + 1)};
        }
    sums_.assign(tile_.begin(), tile_.end());
}

/// The price of a product of deviations, one of them summed over `shown` contents, in color_distance()s.
/// Repetition is the squared mean over contents, summed over texels, in parts of the variance; seams are a
/// mean over all borders.
std::int64_t PatchContents::repetition(std::int64_t product, std::int64_t shown) const {
    const std::int64_t weight = scale_->repetition_weight * scale_->gradient * scale_->borders / 16;
    return 2 * weight * (product / shown) / (scale_->texels * scale_->variance / 1024) / 1024;
}

PatchContents::Deviations PatchContents::deviations(const ShapedContent& content) const {
    Deviations shown = tile_;
    for (std::int32_t y = 0; y < ground_.height; ++y)
        for (std::int32_t x = 0; x < ground_.width; ++x)
            if (content.shape.at(x, y))
                shown[ground_.index(x, y)] = deviation(photo_->at(content.at.x + x, content.at.y + y));
    return shown;
}

void PatchContents::add_to_sums(const Deviations& deviations, std::int32_t sign) {
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += sign * deviations[i];
}

std::int64_t PatchContents::product_with_sums(const Deviations& deviations) const {
    std::int64_t product = 0;
    for (std::size_t i = 0; i < sums_.size(); ++i) product += std::int64_t{sums_[i]} * deviations[i];
    return product;
}

void PatchContents::add_candidate(ExchangeAsset::Offset at) {
    // As much for each texel as it would be if the others left the tile a third of them
    const auto usual = static_cast<std::int32_t>(repetition(scale_->variance * 64, 3) / 64);
    const std::vector<std::int32_t> prices(tile_.size(), std::max(1, usual));
    ShapedContent content{at, cut_content(ground_, *photo_, at, ground_.deepest * free_depth / 100,
                                          scale_->usual(), prices, {})};
    seams_.push_back(static_cast<std::int64_t>(sum_seam(ground_, *photo_, at, content.shape).distances));
    candidate_deviations_.push_back(deviations(content));
    candidates_.push_back(std::move(content));
}

bool PatchContents::take_best(std::int32_t distance, const PhotoUses& uses) {
    std::size_t best = candidates_.size();
    std::int64_t best_price = 0;
    const std::int64_t shown = scale_->contents + 1;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        const auto at = candidates_[i].at;
        if (std::any_of(chosen_.begin(), chosen_.end(),
                        [&](const ShapedContent& other) { return !lie_apart(other.at, at, distance); }))
            continue;
        // Shown as often as the average costs a tenth of a mean gradient along the border
        const std::int64_t use = scale_->gradient * border_ *
                                 static_cast<std::int64_t>(uses.relative(at, ground_.width, ground_.height)) /
                                 2560;
        const std::int64_t price =
            seams_[i] + repetition(product_with_sums(candidate_deviations_[i]), shown) + use;
        if (best == candidates_.size() || price < best_price) {
            best = i;
            best_price = price;
        }
    }
    if (best == candidates_.size()) return false;
    add_to_sums(candidate_deviations_[best], 1);
    chosen_.push_back(std::move(candidates_[best]));
    chosen_deviations_.push_back(std::move(candidate_deviations_[best]));
    candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(best));
    candidate_deviations_.erase(candidate_deviations_.begin() + static_cast<std::ptrdiff_t>(best));
    seams_.erase(seams_.begin() + static_cast<std::ptrdiff_t>(best));
    return true;
}

ShownSum PatchContents::shown() const {
    ShownSum shown;
    const std::int64_t contents = std::ssize(chosen_) + 1;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
        if (ground_.depths[i] == 0) continue;
        shown.texels += contents;
        shown.sum += sums_[i];
        shown.squared_means += std::int64_t{sums_[i]} * sums_[i] / contents;
        shown.squares += std::int64_t{tile_[i]} * tile_[i];
        for (const Deviations& content : chosen_deviations_)
            shown.squares += std::int64_t{content[i]} * content[i];
    }
    return shown;
}

std::vector<PerceptualColor> PatchContents::colors_at(std::int32_t x, std::int32_t y) const {
    std::vector<PerceptualColor> colors{ground_.tile_at(x, y)};
    for (const auto& [at, shape] : chosen_)
        colors.push_back(shape.at(x, y) ? photo_->at(at.x + x, at.y + y) : ground_.tile_at(x, y));
    return colors;
}

void PatchContents::recut(const ColorsBeside& beside) {
    std::vector<std::int32_t> prices(tile_.size());
    const std::int64_t shown = std::ssize(chosen_) + 1;
    for (std::size_t c = 0; c < chosen_.size(); ++c) {
        ShapedContent& content = chosen_[c];
        add_to_sums(chosen_deviations_[c], -1);
        for (std::int32_t y = 0; y < ground_.height; ++y)
            for (std::int32_t x = 0; x < ground_.width; ++x) {
                if (!ground_.holds(x, y)) continue;
                const std::size_t i = ground_.index(x, y);
                const std::int64_t exchanged =
                    std::int64_t{tile_[i]} - deviation(photo_->at(content.at.x + x, content.at.y + y));
                prices[i] = static_cast<std::int32_t>(std::clamp<std::int64_t>(
                    repetition(64 * sums_[i] * exchanged, shown) / 64, -20000, 20000));
            }
        content.shape = cut_content(ground_, *photo_, content.at, ground_.deepest * free_depth / 100,
                                    scale_->usual(), prices, beside);
        chosen_deviations_[c] = deviations(content);
        add_to_sums(chosen_deviations_[c], 1);
    }
}

}  // namespace tessera
