#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/exchange.h"

namespace tessera {

/// An image ready to be copied from and blended: sRGB codes as pages carry them, and linear steps. Rows may
/// be read up to `padding` texels past their end.
struct TexelSource {
    static constexpr std::size_t padding = 16;

    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<std::uint8_t> codes;   ///< RGBA, 4·(width·height + padding)
    std::vector<std::uint16_t> steps;  ///< RGBA in steps of 1/65535, as many

    explicit TexelSource(const Rgb8Image& image);
    std::size_t memory_bytes() const noexcept { return codes.size() + steps.size() * sizeof(std::uint16_t); }
};

/// The texels of every content of every patch: translations of the exemplar, and for content 0 the tile
/// itself.
class ExemplarTexels {
  public:
    /// `radius` as in PatchMap: contents begin at the patch's grown origin.
    ExemplarTexels(const ExchangeAsset& asset, std::int32_t radius);

    ExemplarTexels(const ExemplarTexels&) = delete;
    ExemplarTexels& operator=(const ExemplarTexels&) = delete;

    /// Where a content's texel over the patch's origin lies.
    struct Content {
        const TexelSource* source = nullptr;
        std::size_t offset = 0;  ///< In texels.
    };
    const Content& content(std::size_t patch, std::size_t index) const noexcept {
        return contents_[first_content_[patch] + index];
    }
    /// Contents of a patch, its own included: at least 1, at most 256.
    std::uint32_t content_count(std::size_t patch) const noexcept {
        return first_content_[patch + 1] - first_content_[patch];
    }
    std::size_t patch_count() const noexcept { return first_content_.size() - 1; }
    std::size_t memory_bytes() const noexcept { return tile_.memory_bytes() + exemplar_.memory_bytes(); }

  private:
    TexelSource tile_;  ///< Repeated to the right and below by half, so that no patch wraps in it.
    TexelSource exemplar_;
    std::vector<Content> contents_;
    std::vector<std::uint32_t> first_content_;
};

}  // namespace tessera
