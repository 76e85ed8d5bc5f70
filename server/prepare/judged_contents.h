#pragma once

#include <cstdint>
#include <vector>

#include "server/prepare/content_choice.h"
#include "server/texture/exchange_asset.h"

namespace tessera {

/// What a person said of one patch's contents in an earlier asset.
class JudgedContents {
  public:
    JudgedContents() = default;
    explicit JudgedContents(const ExchangeAsset::Patch& earlier);

    /// How many more contents than wanted must be found, so that enough are left.
    std::int32_t count() const { return static_cast<std::int32_t>(judged_.size()); }

    /// Pinned contents, then what was found and is none of the judged ones again, `wanted` in all; then the
    /// dropped ones, which stay listed.
    std::vector<ExchangeAsset::Content> with(const std::vector<ShapedContent>& found,
                                             std::int32_t wanted) const;

  private:
    std::vector<ExchangeAsset::Content> judged_;
    std::int32_t distance_ = 0;  ///< What lies nearer to a judged content shows the same.
};

}  // namespace tessera
