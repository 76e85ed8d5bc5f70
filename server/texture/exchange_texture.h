#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/texture/exchange.h"
#include "server/texture/independent_choice.h"
#include "server/texture/kernels.h"
#include "server/texture/kolar_choice.h"
#include "server/texture/shapes.h"
#include "server/texture/stamps.h"
#include "server/texture/texel_source.h"
#include "server/texture/unit_choice.h"
#include "server/texture/unit_sums.h"

namespace tessera {

/// What is shown where, whatever it looks like: shared by the colour and the channels beside it.
struct ExchangeLayout {
    ExchangeMethod method;
    Choice choice;
    std::int32_t tile_side;
    int tile_level;  ///< Where the tile is one texel.
    int unit_level;  ///< Where the choosing unit is.
    Shapes shapes;
    // choice: typed
    std::optional<TypedQuadtree> tree;
    Variants variants;
    // the others, whose units are tiles
    std::optional<IndependentChoice> independent;
    std::optional<KolarChoice> kolar;

    ExchangeLayout(const ExchangeAsset& asset, const ExchangeOptions& options);

    /// What the units of a rectangle show.
    UnitGrid shown_by(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height) const;
    /// How many units behind a rectangle have shapes that reach into it: those of `choice: kolar` begin up to
    /// a tile before their own. Before it, it is one for all.
    std::int64_t units_after() const noexcept { return choice == Choice::kolar ? 1 : 0; }
    /// How far the shapes of a unit reach over its right or lower border at most, in texels of level 0.
    std::int32_t overhang = 0;
    std::int32_t tallest = 0;  ///< Of all boxes.
    /// Of what a unit shows what may meet its rows of texels [first, last) of level 0.
    std::span<const Shown> rows_of(std::span<const Shown> shown, std::int64_t first, std::int64_t last) const;
    std::size_t memory_bytes() const noexcept;

  private:
    /// First row of the box, relative to the unit: the order of lists.
    std::int64_t top_of(const Shown& one) const noexcept {
        return std::int64_t{one.tile_y} * tile_side + shapes.box(one.shape).y;
    }
};

/// A by-example texture, compiled: exchange_texture.cpp builds it, exchange_pages.cpp and exchange_level_0.cpp evaluate it.
class CompiledExchange final : public ExchangeTexture {
  public:
    CompiledExchange(std::shared_ptr<const ExchangeLayout> layout, TexelSource exemplar,
                     const TexelSource& tile, TexelKind texels);

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override;
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                Rgba8Image& out) const override;
    Result<std::vector<std::uint32_t>> sources(const TexelRegion& region) const override;
    std::shared_ptr<const Texture> with_texels(const Rgb16Image& exemplar,
                                               const Rgb16Image& tile) const override;

    TexelKind texel_kind() const noexcept override { return kind_of_texels_; }
    std::string_view kind() const noexcept override;
    std::string description() const override;
    std::size_t memory_bytes() const noexcept override;

  private:
    /// Where finished rows go: as linear texels, or as the codes that pages carry.
    struct Rows {
        LinearImage* linear = nullptr;
        Rgba8Image* codes = nullptr;
        void put(std::int32_t y, std::int32_t x, const float* rgb, std::int32_t width,
                 const Kernels& kernels) const;
    };
    /// A block of the region: its first texel, its place in the output. Blocks bound what an evaluation holds
    /// beside its answer.
    struct Block {
        int level = 0;
        std::int64_t x = 0, y = 0;
        std::int32_t width = 0, height = 0;
        std::int32_t out_x = 0, out_y = 0;
    };
    class Level0Band;

    Result<Evaluation> evaluate_blocks(const TexelRegion& region, const Budget& budget,
                                       const Rows& rows) const;
    Result<Evaluation> evaluate_block(const Block& block, const Budget& budget, const Rows& rows) const;

    Result<Evaluation> blend_texels(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> sum_stamps(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> sum_variants(const VariantImages&, const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> look_up_nodes(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> enumerate_or_expect(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> descend_or_expect(const Block&, const Budget&, const Rows&) const;

    /// What the units that a block meets show.
    UnitGrid shown_in(const Block& block) const;
    /// Rounding of floats of magnitude one, a sum for each stamp that a texel may meet, in codes of linear
    /// light.
    double float_bound_codes() const;
    bool enumerates(int height, Accuracy accuracy) const;

    std::shared_ptr<const ExchangeLayout> layout_;
    TexelKind kind_of_texels_;
    TexelSource exemplar_;
    TexelSource tile_;  ///< Repeated to the right as far as the widest box.
    TileLevels tile_levels_;
    Stamps stamps_;
    std::vector<VariantImages> images_;  ///< choice: typed: of the levels up to the unit's, finest first.
    std::optional<NodeTables> nodes_;
    std::optional<IndependentSums> independent_sums_;
    double expectation_[3] = {};  ///< choice: kolar: the mean of many tiles.
    std::size_t most_shown_ = 0;  ///< By one unit.
};

}  // namespace tessera
