#include "client/residency/footprint_pages.h"

#include <algorithm>
#include <span>
#include <unordered_map>
#include <utility>

#include "client/residency/piece_visibility.h"
#include "client/residency/pixel_reads.h"

namespace tessera {
namespace {

constexpr int block_pixels = 32, plane_block_pixels = 128;
constexpr int least_pixels = 8;  ///< A smaller block reads all that it may read, but for a few pages.

/// A page is needed once a pixel is known that reads it. Blocks of pixels tell what may be needed; those of
/// which all that they may read is known already are not looked at any closer.
class Blocks {
  public:
    Blocks(const PlaneView& view, Extent extent, double lod_bias, const Sampling& sampling)
        : view_{view}, visibility_{view}, reads_{view, extent, lod_bias, sampling} {
        pages_.reserve(1024);
    }

    std::vector<NeededPage> run() {
        std::vector<Block> blocks;
        for (const FlatPiece& piece : view_.pieces()) add_blocks(piece, blocks);
        for (Block& block : blocks) {
            reads_.look_at(*block.piece);
            share_pixels(block);
            look_at_one(block);
        }
        for (const Block& block : blocks) {
            reads_.look_at(*block.piece);
            const auto may_read = std::span{may_read_}.subspan(block.first_read, block.reads);
            if (std::ranges::find(may_read, nullptr) != may_read.end())
                look_closer(*block.piece, block.seen);
            else
                for (Known* known : may_read) seek(*block.piece, *known, block.seen.box);
        }
        std::vector<NeededPage> found;
        found.reserve(pages_.size());
        for (const auto& [key, page] : pages_)
            if (page.is_needed) found.push_back({key, std::max(page.pixels, 1.0)});
        std::ranges::sort(found, [](const NeededPage& a, const NeededPage& b) { return b.key < a.key; });
        return found;
    }

  private:
    using Seen = PieceVisibility::Seen;
    struct Block {
        const FlatPiece* piece;
        Seen seen;
        std::size_t first_read = 0, reads = 0;  ///< In may_read_
    };
    struct Page {
        double pixels = 0;
        bool is_needed = false;
    };

    using Known = std::pair<const PageKey, Page>;

    void add_blocks(const FlatPiece& piece, std::vector<Block>& blocks) {
        const Seen whole = visibility_.seen(piece, visibility_.box_known(piece));
        const PixelBox& box = whole.box;
        if (!view_.is_plane() && box.right - box.left <= block_pixels &&
            box.bottom - box.top <= block_pixels) {
            if (whole.pixels > 0) blocks.push_back({&piece, whole});
            return;
        }
        const int side = view_.is_plane() ? plane_block_pixels : block_pixels;
        // A plane's, in pixels from the top, or far above
        const double horizon =
            piece.w[1] > 1e-9 * piece.w[2] ? view_.height() / 2.0 - piece.w[2] / piece.w[1] : -1e9;
        for (int y = box.top; y < box.bottom;) {
            // Near a horizon a row's level differs from the next one's
            const int rows =
                view_.is_plane()
                    ? static_cast<int>(std::clamp((y - horizon) / 4, 1.0, static_cast<double>(side)))
                    : side;
            const int below = std::min(y + rows, box.bottom);
            for (int x = box.left; x < box.right; x += side) {
                const Seen seen = visibility_.seen(piece, {x, y, std::min(x + side, box.right), below});
                if (seen.pixels > 0) blocks.push_back({&piece, seen});
            }
            y = below;
        }
    }

    /// Of a box of which a corner lies beyond the piece's horizon, nothing can be said.
    bool is_bounded(const PixelBox& box) const {
        return reads_.sees_plane(box.left, box.top) && reads_.sees_plane(box.right - 1, box.top) &&
               reads_.sees_plane(box.left, box.bottom - 1) &&
               reads_.sees_plane(box.right - 1, box.bottom - 1);
    }
    PixelReads::Bounds bounds(const PixelBox& box) const {
        return reads_.bounds(box.left, box.top, box.right, box.bottom);
    }

    bool may_read(const PixelBox& box, PageKey page) const {
        return reads_.may_read(box.left, box.top, box.right, box.bottom, page);
    }

    /// The pages of a level that a block may read share its pixels evenly.
    void share_pixels(Block& block) {
        block.first_read = may_read_.size();
        if (is_bounded(block.seen.box)) {
            const PixelReads::Bounds may = bounds(block.seen.box);
            for (int level = may.finest; level <= may.coarsest; ++level) {
                met_.clear();
                if (!reads_.add_pages(may.ground, level, met_) && !view_.is_plane())
                    may_read_.push_back(nullptr);
                for (const PageKey key : met_) {
                    Known& known = *pages_.try_emplace(key).first;
                    known.second.pixels +=
                        static_cast<double>(block.seen.pixels) / static_cast<double>(met_.size());
                    may_read_.push_back(&known);
                }
            }
        } else {
            may_read_.push_back(nullptr);
        }
        block.reads = may_read_.size() - block.first_read;
    }

    void look_at_one(const Block& block) { look_at_pixel(block.seen.x, block.seen.y); }

    void look_at_pixel(int x, int y) {
        if (!reads_.sees_plane(x, y)) return;
        met_.clear();
        reads_.add_pages(x, y, met_);
        for (const PageKey page : met_) pages_[page].is_needed = true;
    }

    void need_all(const FlatPiece& piece, const PixelBox& box) {
        if (!view_.is_plane()) {
            for (int y = box.top; y < box.bottom; ++y)
                for (int x = box.left; x < box.right; ++x)
                    if (visibility_.seen(piece, {x, y, x + 1, y + 1}).pixels > 0) look_at_pixel(x, y);
            return;
        }
        const PixelReads::Bounds may = bounds(box);
        met_.clear();
        for (int level = may.finest; level <= may.coarsest; ++level)
            reads_.add_pages(may.ground, level, met_);
        for (const PageKey page : met_) pages_[page].is_needed = true;
    }

    bool may_need_more(const PixelBox& box) {
        if (!is_bounded(box)) return true;
        const PixelReads::Bounds may = bounds(box);
        for (int level = may.finest; level <= may.coarsest; ++level) {
            met_.clear();
            // A plane's blocks are a row high where it is that far away
            if (!reads_.add_pages(may.ground, level, met_) && !view_.is_plane()) return true;
            for (const PageKey page : met_) {
                const auto found = pages_.find(page);
                if (found == pages_.end() || !found->second.is_needed) return true;
            }
        }
        return false;
    }

    /// Whether some pixel of the box reads a page that no pixel is known to read.
    void seek(const FlatPiece& piece, Known& known, PixelBox box) {
        if (known.second.is_needed) return;
        const PixelReads::Part part = reads_.part_of(known.first);
        box.left = std::max(box.left, static_cast<int>(std::max(part.left, 0.0)));
        box.top = std::max(box.top, static_cast<int>(std::max(part.top, 0.0)));
        box.right = std::min(box.right, static_cast<int>(std::min(part.right, 1e6)) + 1);
        box.bottom = std::min(box.bottom, static_cast<int>(std::min(part.bottom, 1e6)) + 1);
        seek_within(piece, known, box);
    }

    void seek_within(const FlatPiece& piece, Known& known, const PixelBox& within, int depth = 0) {
        if (known.second.is_needed || within.is_empty()) return;
        const Seen seen = visibility_.seen(piece, within);
        if (seen.pixels == 0 || (is_bounded(seen.box) && !may_read(seen.box, known.first))) return;
        const PixelBox& box = seen.box;
        if (box.pixels() <= least_pixels) {
            if (view_.is_plane())
                known.second.is_needed = true;
            else
                need_all(piece, box);
            return;
        }
        if (depth % 2 == 0) look_at_pixel(seen.x, seen.y);
        const auto [first, second] = halves(box);
        seek_within(piece, known, first, depth + 1);
        seek_within(piece, known, second, depth + 1);
    }

    void look_closer(const FlatPiece& piece, const Seen& seen) {
        if (seen.pixels == 0 || !may_need_more(seen.box)) return;
        const PixelBox& box = seen.box;
        if (box.pixels() <= least_pixels) {
            need_all(piece, box);
            return;
        }
        look_at_pixel(seen.x, seen.y);
        const auto [first, second] = halves(box);
        look_closer(piece, visibility_.seen(piece, first));
        look_closer(piece, visibility_.seen(piece, second));
    }

    /// Across the longer side, so that parts are nearly square; but a plane's levels differ between its rows
    /// much more than along them.
    std::pair<PixelBox, PixelBox> halves(const PixelBox& box) const {
        PixelBox first = box, second = box;
        const int width = box.right - box.left, height = box.bottom - box.top;
        if (height == 1 || width >= (view_.is_plane() ? 8 : 1) * height)
            first.right = second.left = (box.left + box.right) / 2;
        else
            first.bottom = second.top = (box.top + box.bottom) / 2;
        return {first, second};
    }

    const PlaneView& view_;
    PieceVisibility visibility_;
    PixelReads reads_;
    std::unordered_map<PageKey, Page> pages_;
    std::vector<Known*> may_read_;  ///< By the blocks, one after the other; null: nothing can be said
    std::vector<PageKey> met_;
};

}  // namespace

std::vector<NeededPage> needed_by_footprints(const PlaneView& view, Extent extent, double lod_bias,
                                             const Sampling& sampling) {
    return Blocks{view, extent, lod_bias, sampling}.run();
}

}  // namespace tessera
