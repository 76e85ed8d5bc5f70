#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/texture/exchange.h"
#include "server/texture/exchange_layout.h"
#include "server/texture/exchange_texels.h"

namespace tessera {

/// A by-example texture, compiled; ExchangeWalk evaluates it.
class CompiledExchange final : public ExchangeTexture {
  public:
    CompiledExchange(std::shared_ptr<const ExchangeLayout> layout, TexelSource exemplar,
                     const TexelSource& tile);

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override;
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                Rgba8Image& out) const override;
    Result<std::vector<std::uint32_t>> sources(const TexelRegion& region) const override;
    std::optional<int> unit_level() const noexcept override {
        return layout_->choice == Choice::kolar ? std::nullopt : std::optional{layout_->unit_level};
    }
    std::shared_ptr<const ExchangeData> with_texels(std::span<const DataImages> images) const override;

    std::string_view kind() const noexcept override;
    std::string description() const override;
    std::size_t memory_bytes() const noexcept override;

  private:
    std::shared_ptr<const ExchangeLayout> layout_;
    ExchangeTexels texels_;
};

/// Further images under the same layout.
class CompiledData final : public ExchangeData {
  public:
    CompiledData(std::shared_ptr<const ExchangeLayout> layout, std::span<const DataImages> images);

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                std::span<const std::size_t> sources, const TakeRow& take_row) const override;
    std::size_t memory_bytes() const noexcept override;

  private:
    std::shared_ptr<const ExchangeLayout> layout_;
    std::vector<ExchangeTexels> texels_;
};

}  // namespace tessera
