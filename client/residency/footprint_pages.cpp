#include "client/residency/footprint_pages.h"

#include <algorithm>
#include <span>
#include <unordered_map>

#include "client/residency/pixel_reads.h"

namespace tessera {
namespace {

constexpr int block_pixels = 32;
constexpr int least_pixels = 8;  ///< A smaller block reads all that it may read, but for a few pages.

/// A page is needed once a pixel is known that reads it. Blocks of pixels tell what may be needed; those of
/// which all that they may read is known already are not looked at any closer.
class Blocks {
  public:
    Blocks(const PlaneView& view, Extent extent, double lod_bias, const Sampling& sampling)
        : view_{view}, reads_{view, extent, lod_bias, sampling} {
        pages_.reserve(1024);
    }

    std::vector<NeededPage> run() {
        int first_row = 0;
        while (first_row < view_.height() && !reads_.sees_plane(first_row)) ++first_row;
        std::vector<Block> blocks;
        for (int y = first_row; y < view_.height();) {
            // Near the horizon a row's level differs from the next one's
            const int rows = std::clamp((y - first_row) / 2, 1, block_pixels);
            const int below = std::min(y + rows, view_.height());
            for (int x = 0; x < view_.width(); x += block_pixels)
                blocks.push_back({.left = x,
                                  .top = y,
                                  .right = std::min(x + block_pixels, view_.width()),
                                  .bottom = below});
            y = below;
        }
        for (Block& block : blocks) {
            share_pixels(block);
            look_at_middle(block);
        }
        for (const Block& block : blocks) {
            const auto may_read = std::span{may_read_}.subspan(block.first_read, block.reads);
            if (std::ranges::any_of(may_read, [](const Page* page) { return !page->is_needed; }))
                look_closer(block);
        }
        std::vector<NeededPage> found;
        found.reserve(pages_.size());
        for (const auto& [key, page] : pages_)
            if (page.is_needed) found.push_back({key, std::max(page.pixels, 1.0)});
        std::ranges::sort(found, [](const NeededPage& a, const NeededPage& b) { return b.key < a.key; });
        return found;
    }

  private:
    struct Block {
        int left, top, right, bottom;
        std::size_t first_read = 0, reads = 0;  ///< In may_read_
        int pixels() const { return (right - left) * (bottom - top); }
    };
    struct Page {
        double pixels = 0;
        bool is_needed = false;
    };

    /// The pages of a level that a block may read share its pixels evenly.
    void share_pixels(Block& block) {
        block.first_read = may_read_.size();
        const PixelReads::Bounds bounds = reads_.bounds(block.left, block.top, block.right, block.bottom);
        for (int level = bounds.finest; level <= bounds.coarsest; ++level) {
            met_.clear();
            reads_.add_pages(bounds.ground, level, met_);
            for (const PageKey key : met_) {
                Page& page = pages_[key];
                page.pixels += static_cast<double>(block.pixels()) / static_cast<double>(met_.size());
                may_read_.push_back(&page);
            }
        }
        block.reads = may_read_.size() - block.first_read;
    }

    void look_at_middle(const Block& block) {
        met_.clear();
        reads_.add_pages((block.left + block.right) / 2, (block.top + block.bottom) / 2, met_);
        for (const PageKey page : met_) pages_[page].is_needed = true;
    }

    void need_all(const Block& block) {
        const PixelReads::Bounds bounds = reads_.bounds(block.left, block.top, block.right, block.bottom);
        met_.clear();
        for (int level = bounds.finest; level <= bounds.coarsest; ++level)
            reads_.add_pages(bounds.ground, level, met_);
        for (const PageKey page : met_) pages_[page].is_needed = true;
    }

    bool may_need_more(const Block& block) {
        const PixelReads::Bounds bounds = reads_.bounds(block.left, block.top, block.right, block.bottom);
        for (int level = bounds.finest; level <= bounds.coarsest; ++level) {
            met_.clear();
            reads_.add_pages(bounds.ground, level, met_);
            for (const PageKey page : met_) {
                const auto found = pages_.find(page);
                if (found == pages_.end() || !found->second.is_needed) return true;
            }
        }
        return false;
    }

    void look_closer(const Block& block) {
        if (!may_need_more(block)) return;
        if (block.pixels() <= least_pixels) {
            need_all(block);
            return;
        }
        look_at_middle(block);
        // Along the longer side, so that parts are nearly square
        if (block.right - block.left >= block.bottom - block.top) {
            const int middle = (block.left + block.right) / 2;
            look_closer({.left = block.left, .top = block.top, .right = middle, .bottom = block.bottom});
            look_closer({.left = middle, .top = block.top, .right = block.right, .bottom = block.bottom});
        } else {
            const int middle = (block.top + block.bottom) / 2;
            look_closer({.left = block.left, .top = block.top, .right = block.right, .bottom = middle});
            look_closer({.left = block.left, .top = middle, .right = block.right, .bottom = block.bottom});
        }
    }

    const PlaneView& view_;
    PixelReads reads_;
    std::unordered_map<PageKey, Page> pages_;
    std::vector<Page*> may_read_;  ///< By the blocks, one after the other
    std::vector<PageKey> met_;
};

}  // namespace

std::vector<NeededPage> needed_by_footprints(const PlaneView& view, Extent extent, double lod_bias,
                                             const Sampling& sampling) {
    return Blocks{view, extent, lod_bias, sampling}.run();
}

}  // namespace tessera
