#include <algorithm>
#include <cmath>

#include "server/filter/page_cache.h"
#include "server/filter/texel_pages.h"
#include "shared/math/srgb.h"

namespace tessera {

namespace {

class TexturePages final : public TexelPages {
  public:
    TexturePages(std::shared_ptr<const Texture> texture, Accuracy accuracy, std::size_t cache_bytes)
        : texture_{std::move(texture)}, accuracy_{accuracy}, cache_{cache_bytes} {}

    Result<std::shared_ptr<const TexelPage>> page(std::uint8_t level, std::int64_t x, std::int64_t y,
                                                  std::int64_t slice, const Budget& budget) const override {
        return cache_.get({x, y, slice, level}, budget, [&] { return make(level, x, y, slice, budget); });
    }

    std::size_t memory_bytes() const noexcept override {
        return cache_.memory_bytes() + texture_->memory_bytes();
    }

  private:
    TexelPageCache::Made make(std::uint8_t level, std::int64_t x, std::int64_t y, std::int64_t slice,
                              const Budget& budget) const {
        Budget mine = budget;
        mine.accuracy = accuracy_;
        LinearImage texels;
        const auto evaluation = texture_->evaluate(
            {level, x * page_side_texels, y * page_side_texels, page_side_texels, page_side_texels, slice},
            mine, texels);
        if (!evaluation) return evaluation.error();
        auto page = std::make_shared<TexelPage>();
        page->steps.resize(texels.values.size());
        double furthest = 0;  // What steps, and their ends at 0 and 1, lose
        for (std::size_t i = 0; i < texels.values.size(); ++i) {
            page->steps[i] = to_steps(texels.values[i]);
            const double lost = std::fabs(static_cast<double>(texels.values[i]) - page->steps[i] / 65535.0);
            furthest = std::max(furthest, lost);
        }
        page->bound_codes = evaluation->bound_codes + furthest / code_in_linear;
        page->confidence = evaluation->confidence;
        return page;
    }

    std::shared_ptr<const Texture> texture_;
    Accuracy accuracy_;
    mutable TexelPageCache cache_;
};

}  // namespace

std::shared_ptr<const TexelPages> pages_of_texture(std::shared_ptr<const Texture> texture, Accuracy accuracy,
                                                   std::size_t cache_bytes) {
    return std::make_shared<TexturePages>(std::move(texture), accuracy, cache_bytes);
}

}  // namespace tessera
