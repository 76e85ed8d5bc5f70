#pragma once

#include <cstdint>
#include <vector>

#include "server/prepare/candidates.h"
#include "server/prepare/content_cut.h"

namespace tessera {

/// A place of the photograph with the shape in which a patch shows it.
struct ShapedContent {
    ExchangeAsset::Offset at;
    BitMask shape;
};

/// What is weighed against each other when contents are cut and chosen.
struct ChoiceScale {
    std::int32_t contents = 24;       ///< Wanted for each patch.
    std::int64_t mean_lightness = 0;  ///< Of the photograph, in PerceptualColor's units.
    std::int64_t variance = 1;        ///< Of its lightness.
    std::int64_t gradient = 1;        ///< Its mean color_distance() of neighbours.
    std::int64_t borders = 1;         ///< Of the patch map: neighbours of different patches.
    std::int64_t texels = 1;          ///< Of the tile.
    /// What a repetition of one (a plain periodic tile's) costs in seams: as if along all of them so many
    /// 16ths of the mean gradient more were seen.
    std::int64_t repetition_weight = 0;

    /// What along a border is no more than happens inside the photograph.
    std::uint32_t usual() const { return static_cast<std::uint32_t>(gradient); }
    ChoiceScale(const PerceptualImage& photo, const Segmentation& segmentation, std::int32_t wanted);
};

/// What patches show, texel by texel as deviations of lightness from the photograph's mean.
struct ShownSum {
    std::int64_t texels = 0;  ///< Of patches, each counted once for each content.
    std::int64_t sum = 0;
    std::int64_t squares = 0;
    std::int64_t squared_means =
        0;  ///< The squares of the means over all contents, as often as there are contents.

    void add(const ShownSum& other);
    /// The variance of the mean over all contents in parts of the variance of what is shown, in 10000ths: how
    /// much of the picture is the same in every period.
    std::int64_t repetition() const;
};

/// One patch: its candidates with their shapes, and the contents chosen of them. The smallest sum of two
/// prices is looked for: of what is seen along borders, and of what repeats, which is how far the mean of all
/// that the patch shows is from being flat.
class PatchContents {
  public:
    /// `scale` and `photo` outlive it.
    PatchContents(PatchGround ground, const PerceptualImage& photo, const ChoiceScale& scale);

    /// Cuts the candidate's shape, as if of the others the average was known.
    void add_candidate(ExchangeAsset::Offset at);
    /// Takes the best of the candidates that lie `distance` apart from those taken; false if there is none.
    bool take_best(std::int32_t distance, const PhotoUses& uses);
    /// Cuts each content's shape again, now that the others are known, and what the neighbours show.
    void recut(const ColorsBeside& beside);

    ShownSum shown() const;
    /// What a texel of the patch shows, in the box's coordinates: the tile's colour and each content's.
    std::vector<PerceptualColor> colors_at(std::int32_t x, std::int32_t y) const;
    const PatchGround& ground() const { return ground_; }
    const std::vector<ShapedContent>& contents() const { return chosen_; }

  private:
    using Deviations = std::vector<std::int16_t>;

    /// What a content shows: how far each texel's lightness is from the photograph's mean; 0 outside the
    /// patch.
    Deviations deviations(const ShapedContent& content) const;
    void add_to_sums(const Deviations& deviations, std::int32_t sign);
    std::int64_t product_with_sums(const Deviations& deviations) const;
    std::int64_t repetition(std::int64_t product, std::int64_t shown) const;
    std::int16_t deviation(const PerceptualColor& color) const {
        return static_cast<std::int16_t>(color.lightness - scale_->mean_lightness);
    }

    PatchGround ground_;
    const PerceptualImage* photo_;
    const ChoiceScale* scale_;
    std::int64_t border_ = 1;  ///< Length of the patch's own.
    Deviations tile_;
    std::vector<ShapedContent> candidates_, chosen_;
    std::vector<std::int64_t> seams_;  ///< Of the candidates: summed distances.
    std::vector<Deviations> candidate_deviations_, chosen_deviations_;
    std::vector<std::int32_t> sums_;  ///< Of the deviations of all chosen contents and of the tile's own.
};

}  // namespace tessera
