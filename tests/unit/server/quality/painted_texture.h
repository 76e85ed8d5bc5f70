#pragma once

#include <array>
#include <functional>
#include <utility>

#include "server/texture/exchange.h"
#include "shared/math/hash.h"

namespace tessera::test {

using Codes = std::array<std::uint8_t, 3>;

/// A texture that shows what a function says, at every level alike: figures can be known beforehand.
class PaintedTexture : public ExchangeTexture {
  public:
    using Paint = std::function<Codes(std::int64_t x, std::int64_t y)>;
    using Source = std::function<std::uint32_t(std::int64_t x, std::int64_t y)>;

    explicit PaintedTexture(
        Paint paint, Source source = [](std::int64_t, std::int64_t) { return 0U; })
        : paint_{std::move(paint)}, source_{std::move(source)} {}

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                Rgba8Image& out) const override {
        if (auto may = check_budget(budget); !may) return may.error();
        out = Rgba8Image{region.width, region.height};
        for (std::int32_t y = 0; y < region.height; ++y)
            for (std::int32_t x = 0; x < region.width; ++x) {
                const Codes codes = paint_(region.x + x, region.y + y);
                std::copy(codes.begin(), codes.end(), out.row(y) + x * 4);
                out.row(y)[x * 4 + 3] = 255;
            }
        return Evaluation{.method = "painted"};
    }
    Result<Evaluation> evaluate(const TexelRegion&, const Budget&, LinearImage&) const override {
        return Error{ErrorCode::io_failure, "painted textures have codes only"};
    }
    Result<std::vector<std::uint32_t>> sources(const TexelRegion& region) const override {
        std::vector<std::uint32_t> sources;
        for (std::int32_t y = 0; y < region.height; ++y)
            for (std::int32_t x = 0; x < region.width; ++x)
                sources.push_back(source_(region.x + x, region.y + y));
        return sources;
    }
    std::shared_ptr<const ExchangeData> with_texels(std::span<const DataImages>) const override {
        return nullptr;
    }
    std::string_view kind() const noexcept override { return "painted"; }
    std::string description() const override { return "painted"; }
    std::size_t memory_bytes() const noexcept override { return 0; }

  private:
    Paint paint_;
    Source source_;
};

inline std::int64_t floor_mod(std::int64_t value, std::int64_t side) {
    return ((value % side) + side) % side;
}

/// Content exchange texel by texel, unblended, every tile deciding for itself: I = tile + Σ shape·(content −
/// tile).
inline std::shared_ptr<const PaintedTexture> paint_asset(const ExchangeAsset& asset, std::uint64_t seed = 1) {
    struct Shown {
        std::uint32_t source = 0;
        Codes codes{};
    };
    const auto shown = [&asset, seed](std::int64_t x, std::int64_t y) {
        const std::int64_t side = asset.tile_side;
        const auto codes_at = [](const Rgb8Image& image, std::int64_t u, std::int64_t v) {
            const std::uint8_t* texel = image.bytes.data() + (v * image.width + u) * 3;
            return Codes{texel[0], texel[1], texel[2]};
        };
        const auto place = static_cast<std::size_t>(floor_mod(y, side) * side + floor_mod(x, side));
        const std::size_t label = asset.labels[place];
        const auto& patch = asset.patches[label];
        const std::int64_t u = floor_mod(x - patch.x, side), v = floor_mod(y - patch.y, side);
        const std::uint64_t bits =
            hash(seed, stream("painted", label), (x - u - patch.x) / side, (y - v - patch.y) / side);
        const auto choice = uniform_below(bits, static_cast<std::uint32_t>(patch.contents.size() + 1));
        if (choice > 0) {
            const auto& content = patch.contents[choice - 1];
            if (content.shape.at(static_cast<std::int32_t>(u), static_cast<std::int32_t>(v))) {
                std::uint32_t number = choice;
                for (std::size_t p = 0; p < label; ++p)
                    number += static_cast<std::uint32_t>(asset.patches[p].contents.size());
                return Shown{number, codes_at(asset.exemplar, content.at.x + u, content.at.y + v)};
            }
        }
        return Shown{0, codes_at(asset.tile, floor_mod(x, side), floor_mod(y, side))};
    };
    return std::make_shared<PaintedTexture>(
        [shown](std::int64_t x, std::int64_t y) { return shown(x, y).codes; },
        [shown](std::int64_t x, std::int64_t y) { return shown(x, y).source; });
}

}  // namespace tessera::test
