#include "server/accuracy/truth_texels.h"

#include <vector>

#include "shared/math/hash.h"

namespace tessera {
namespace {

class ImageTexels final : public TruthTexels {
  public:
    explicit ImageTexels(std::shared_ptr<const LinearImage> image) : image_{std::move(image)} {}
    void expect(const Footprint&, std::size_t) override {}
    Result<std::array<float, 3>> at(std::int64_t x, std::int64_t y) override {
        const float* texel = image_->row(inside(y, image_->height)) + 4 * inside(x, image_->width);
        return std::array{texel[0], texel[1], texel[2]};
    }

  private:
    static std::int32_t inside(std::int64_t x, std::int32_t period) noexcept {
        const auto rest = static_cast<std::int32_t>(x % period);
        return rest < 0 ? rest + period : rest;
    }
    std::shared_ptr<const LinearImage> image_;
};

class PlanTexels final : public TruthTexels {
  public:
    PlanTexels(std::shared_ptr<const Texture> texture, std::stop_token stop)
        : texture_{std::move(texture)},
          budget_{.accuracy = Accuracy::exact, .cancelled = std::move(stop)},
          blocks_(block_slots) {}

    void expect(const Footprint& footprint, std::size_t samples) override {
        slice_ = footprint.slice;
        constexpr double block_texels = double(block_side) * block_side;
        dense_ = static_cast<double>(samples) * block_texels >= worth_a_block * area_of(footprint);
    }

    Result<std::array<float, 3>> at(std::int64_t x, std::int64_t y) override {
        if (!dense_) {
            const auto done = texture_->evaluate({0, x, y, 1, 1, slice_}, budget_, texel_);
            if (!done) return done.error();
            return std::array{texel_.values[0], texel_.values[1], texel_.values[2]};
        }
        const std::int64_t column = x >> block_shift, row = y >> block_shift;
        Block& block = blocks_[tessera::hash(0, 0, column, row) % block_slots];
        if (!block.filled || block.column != column || block.row != row || block.slice != slice_) {
            block.filled = false;
            const auto done = texture_->evaluate(
                {0, column << block_shift, row << block_shift, block_side, block_side, slice_}, budget_,
                block.texels);
            if (!done) return done.error();
            block = {true, column, row, slice_, std::move(block.texels)};
        }
        const float* texel =
            block.texels.row(static_cast<std::int32_t>(y & (block_side - 1))) + 4 * (x & (block_side - 1));
        return std::array{texel[0], texel[1], texel[2]};
    }

  private:
    static constexpr int block_shift = 6;
    static constexpr std::int32_t block_side = 1 << block_shift;
    static constexpr std::size_t block_slots = 1024;  ///< 64 MiB
    /// Samples that make a block as cheap as texel by texel.
    static constexpr double worth_a_block = 20;
    struct Block {
        bool filled = false;
        std::int64_t column = 0, row = 0, slice = 0;
        LinearImage texels;
    };

    std::shared_ptr<const Texture> texture_;
    Budget budget_;
    std::vector<Block> blocks_;
    LinearImage texel_;
    std::int64_t slice_ = 0;
    bool dense_ = true;
};

}  // namespace

std::unique_ptr<TruthTexels> truth_texels_of(std::shared_ptr<const LinearImage> image) {
    return std::make_unique<ImageTexels>(std::move(image));
}

std::unique_ptr<TruthTexels> truth_texels_of(std::shared_ptr<const Texture> texture, std::stop_token stop) {
    return std::make_unique<PlanTexels>(std::move(texture), std::move(stop));
}

}  // namespace tessera
