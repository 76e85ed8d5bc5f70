#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "server/texture/exchange.h"
#include "server/texture/independent_choice.h"
#include "server/texture/kernels.h"
#include "server/texture/level_0.h"
#include "server/texture/variants.h"

namespace tessera {

/// Tiles of at most this many texels are summed from one image a tile instead of one stamp a patch.
inline constexpr std::int32_t variant_image_side = 8;

/// Where finished rows go: as linear texels, or as the codes that pages carry.
struct Rows {
    LinearImage* linear = nullptr;
    Rgba8Image* codes = nullptr;

    void put(std::int32_t y, std::int32_t x, const float* rgb, std::int32_t width,
             const Kernels& kernels) const {
        if (codes != nullptr) {
            kernels.encode(rgb, width, codes->row(y) + x * 4);
            return;
        }
        float* out = linear->row(y) + std::ptrdiff_t(x) * 4;
        for (std::int32_t i = 0; i < width; ++i) {
            std::copy_n(rgb + i * 3, 3, out + i * 4);
            out[i * 4 + 3] = 1.0F;
        }
    }
};

/// Contents of all patches for a rectangle of tiles.
class TileContents {
  public:
    TileContents(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height)
        : x_{x}, y_{y}, width_{width}, tiles_(static_cast<std::size_t>(width * height)) {}

    const std::uint8_t*& at(std::int64_t x, std::int64_t y) {
        return tiles_[static_cast<std::size_t>((y - y_) * width_ + (x - x_))];
    }
    std::vector<std::uint8_t>& storage() { return storage_; }

  private:
    std::int64_t x_, y_, width_;
    std::vector<const std::uint8_t*> tiles_;
    std::vector<std::uint8_t> storage_;  ///< Where contents are made for this page and not kept in a table.
};

/// Content exchange, compiled: content_exchange.cpp builds it, content_exchange_pages.cpp evaluates it.
class ContentExchangeTexture final : public ExchangeTexture {
  public:
    ContentExchangeTexture(const ExchangeAsset& asset, const ExchangeOptions& options);

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        out = LinearImage{region.width, region.height};
        return evaluate_blocks(region, budget, {.linear = &out});
    }
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                Rgba8Image& out) const override {
        if (out.width != region.width || out.height != region.height)
            out = Rgba8Image{region.width, region.height};
        return evaluate_blocks(region, budget, {.codes = &out});
    }

    Result<std::vector<std::uint32_t>> sources(const TexelRegion&) const override {
        return Error{ErrorCode::io_failure, "in transition"};
    }
    std::shared_ptr<const Texture> with_texels(const Rgb16Image&, const Rgb16Image&) const override {
        return nullptr;
    }
    std::string_view kind() const noexcept override { return "content_exchange"; }
    std::string description() const override;
    std::size_t memory_bytes() const noexcept override;

  private:
    /// A block of the region: its first texel, its place in the output.
    struct Block {
        int level = 0;
        std::int64_t x = 0, y = 0;
        std::int32_t width = 0, height = 0;
        std::int32_t out_x = 0, out_y = 0;
    };

    /// Blocks bound what an evaluation holds beside its answer, whatever the region.
    Result<Evaluation> evaluate_blocks(const TexelRegion& region, const Budget& budget,
                                       const Rows& rows) const;
    /// Takes the way for the block's level.
    Result<Evaluation> evaluate_block(const Block& block, const Budget& budget, const Rows& rows) const;
    /// The contents of the tiles that a block meets, with the tiles before them, whose patches hang over into
    /// it.
    TileContents contents_for(const Block& block, int tile_shift) const;
    /// Whether choices under texels of 2^height tiles are summed one by one: as far as a texel costs no more
    /// than so many look-ups, some 4 ns each. A rule of height and accuracy alone, so that every window shows
    /// the same texels.
    bool enumerates(int height, Accuracy accuracy) const;
    /// Rounding of floats of magnitude one, a sum for each patch that a texel may meet, in codes of linear
    /// light.
    double float_bound_codes() const;
    void fill_with_mean(std::vector<float>& rgb) const;

    Result<Evaluation> blend_exemplar(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> sum_stamps(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> sum_variants(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> look_up_nodes(const Block&, const Budget&, const Rows&) const;
    Result<Evaluation> enumerate_or_expect(const Block&, const Budget&, const Rows&) const;

    PatchMap map_;
    ExemplarTexels texels_;
    ColorSteps mean_;
    std::array<float, 3> mean_linear_{};
    Stamps stamps_;
    Level0 level_0_;
    int tile_level_;  ///< Where the tile is one texel.

    // choice: typed
    std::optional<TypedQuadtree> tree_;
    std::optional<Variants> variants_;
    std::vector<VariantImages>
        images_;  ///< Of the levels where the tile is variant_image_side, …, 2, 1 texels.
    std::optional<NodeTables> nodes_;
    // choice: independent
    std::optional<IndependentChoice> independent_;
};

}  // namespace tessera
