#include "server/texture/level_0.h"

#include <algorithm>

namespace tessera {
namespace {

/// A patch in one tile row: where its box lies and which of the box's rows this is.
struct Strip {
    Level0::Term term;       ///< x: the first column's place in the box; weights unused.
    std::int32_t begin = 0;  ///< Columns of the tile that the box covers.
    std::int32_t end = 0;
    const std::uint16_t* weights = nullptr;  ///< Of column `begin`.

    std::uint16_t weight(std::int32_t x) const {
        return x < begin || x >= end ? std::uint16_t{0} : weights[x - begin];
    }
};

std::vector<Strip> strips_of(const PatchMap& map, std::int32_t y) {
    const std::int32_t side = map.side();
    std::vector<Strip> strips;
    for (std::uint8_t above = 0; above < 2; ++above)
        for (const PatchMap::Span& span : map.levels()[0].row(y + above * side)) {
            const PatchMap::Patch& patch = map.patches()[span.patch];
            for (std::uint8_t left = 0; left < 2; ++left) {
                Strip strip;
                strip.begin = std::max(patch.x - left * side, 0);
                strip.end = std::min(patch.x + patch.width - left * side, side);
                if (strip.begin >= strip.end) continue;
                strip.term = {
                    span.patch, left, above, strip.begin + left * side - patch.x, y + above * side - patch.y,
                    0};
                strip.weights =
                    patch.weights.data() + std::ptrdiff_t(strip.term.y) * patch.width + strip.term.x;
                strips.push_back(strip);
            }
        }
    return strips;
}

}  // namespace

Level0::Level0(const PatchMap& map) {
    for (std::int32_t y = 0; y < map.side(); ++y) {
        row_begin_.push_back(static_cast<std::uint32_t>(runs_.size()));
        cut_row(map, y);
    }
    row_begin_.push_back(static_cast<std::uint32_t>(runs_.size()));
}

void Level0::cut_row(const PatchMap& map, std::int32_t y) {
    const std::vector<Strip> strips = strips_of(map, y);

    // Cut where the set of patches changes
    struct Piece {
        std::int32_t begin = 0, end = 0;
        std::vector<std::size_t> strips;
    };
    std::vector<Piece> pieces;
    for (std::int32_t x = 0; x < map.side(); ++x) {
        std::vector<std::size_t> meeting;
        for (std::size_t s = 0; s < strips.size(); ++s)
            if (strips[s].weight(x) != 0) meeting.push_back(s);
        if (!pieces.empty() && pieces.back().strips == meeting) {
            pieces.back().end = x + 1;
        } else {
            pieces.push_back({x, x + 1, std::move(meeting)});
        }
    }

    // Join neighbouring blends: fewer, longer runs are faster, and a weight of zero adds nothing. Every box
    // must reach over the joined run, so that what is read lies inside the exemplar.
    constexpr std::size_t most_terms = 4;
    std::vector<Piece> joined;
    for (Piece& piece : pieces) {
        if (!joined.empty() && joined.back().strips.size() > 1 && piece.strips.size() > 1) {
            Piece both{joined.back().begin, piece.end, {}};
            std::set_union(joined.back().strips.begin(), joined.back().strips.end(), piece.strips.begin(),
                           piece.strips.end(), std::back_inserter(both.strips));
            const bool reach = std::all_of(both.strips.begin(), both.strips.end(), [&](std::size_t s) {
                return strips[s].begin <= both.begin && strips[s].end >= both.end;
            });
            if (reach && both.strips.size() <= most_terms) {
                joined.back() = std::move(both);
                continue;
            }
        }
        joined.push_back(std::move(piece));
    }

    for (const Piece& piece : joined) {
        runs_.push_back({piece.begin, piece.end, static_cast<std::uint32_t>(terms_.size()),
                         static_cast<std::uint32_t>(piece.strips.size())});
        for (const std::size_t s : piece.strips) {
            Term term = strips[s].term;
            term.x += piece.begin - strips[s].begin;
            if (piece.strips.size() > 1) {
                term.weights = static_cast<std::uint32_t>(weights_.size());
                for (std::int32_t x = piece.begin; x < piece.end; ++x)
                    weights_.insert(weights_.end(), 4, strips[s].weight(x));
                weights_.insert(weights_.end(), 12, 0);  // kernels read whole blocks of four texels
            }
            terms_.push_back(term);
        }
    }
}

}  // namespace tessera
