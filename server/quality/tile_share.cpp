#include <algorithm>
#include <cmath>

#include "server/quality/measures.h"

namespace tessera {
namespace {

constexpr std::int32_t cell_texels = 8;

/// `cells` are complete.
void summarise(TileShare::Figure& figure, std::int32_t side) {
    const auto at = [&](std::int32_t x, std::int32_t y) {
        return double(figure.cells[std::size_t(y) * std::size_t(side) + std::size_t(x)]);
    };
    double border_cells = 0;
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            figure.mean += at(x, y);
            figure.greatest = std::max(figure.greatest, at(x, y));
            if (x != 0 && y != 0 && x != side - 1 && y != side - 1) continue;
            figure.border += at(x, y);
            ++border_cells;
        }
    figure.mean /= double(side) * side;
    figure.border /= border_cells;
    figure.corner = std::max({at(0, 0), at(side - 1, 0), at(0, side - 1), at(side - 1, side - 1)});
}

/// How often what so many tiles beside each other show is alike, cell by cell.
Repetition::Shift greatest_shifted(const std::vector<std::uint32_t>& shown, std::int32_t tiles) {
    constexpr std::int32_t farthest = 8;
    const std::size_t count = std::size_t(tiles) * std::size_t(tiles), cells = shown.size() / count;
    // So many cells tell: each of them in thousands of tiles
    const std::size_t every = std::max<std::size_t>(1, cells / 128) | 1;
    Repetition::Shift greatest;
    for (std::int32_t dy = 0; dy <= std::min(farthest, tiles / 2); ++dy)
        for (std::int32_t dx = -std::min(farthest, tiles / 2); dx <= std::min(farthest, tiles / 2); ++dx) {
            if (dy == 0 && dx <= 0) continue;
            std::int64_t alike = 0, all = 0;
            for (std::size_t cell = 0; cell < cells; cell += every)
                for (std::int32_t y = 0; y + dy < tiles; ++y) {
                    const std::uint32_t* here =
                        shown.data() + cell * count + std::size_t(y) * std::size_t(tiles);
                    const std::uint32_t* there = here + std::ptrdiff_t{dy} * tiles + dx;
                    const std::int32_t first = std::max(0, -dx), last = tiles - std::max(0, dx);
                    for (std::int32_t x = first; x < last; ++x) alike += here[x] == there[x] ? 1 : 0;
                    all += last - first;
                }
            const double rate = double(alike) / double(all);
            if (rate > greatest.value) greatest = {double(dx), double(dy), rate};
        }
    return greatest;
}

}  // namespace

Result<TileShare> measure_tile_share(const ExchangeTexture& texture, std::int32_t tile_side,
                                     TileSample sample, const ProgressPart& progress) {
    TileShare share;
    const std::int32_t cells = share.cells_a_side = tile_side / cell_texels;
    const bool whole = sample == TileSample::whole_tiles;
    const std::int32_t tiles =
        whole ? std::clamp(8192 / tile_side, 4, 16) : std::clamp(16384 / tile_side, 8, 64);  // each way
    share.occurrences = std::int64_t{tiles} * tiles;
    const std::int64_t first = -std::int64_t{tiles} / 2 * tile_side;
    const std::int32_t rows = whole ? tile_side : 1, step = whole ? tile_side : cell_texels;
    const std::int32_t piece = std::min(tiles * tile_side, 4096);

    // What each cell shows in each occurrence
    const auto count = static_cast<std::size_t>(share.occurrences);
    std::vector<std::uint32_t> shown(std::size_t(cells) * std::size_t(cells) * count);
    for (std::int32_t tile_y = 0; tile_y < tiles; ++tile_y)
        for (std::int32_t top = 0; top < tile_side; top += step) {
            progress.advance((tile_y + double(top) / tile_side) / tiles);
            if (progress.progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
            for (std::int32_t x = 0; x < tiles * tile_side; x += piece) {
                const std::int64_t y = first + std::int64_t{tile_y} * tile_side + top;
                const auto sources =
                    texture.sources({0, first + x, whole ? y : y + cell_texels / 2, piece, rows});
                if (!sources) return sources.error();
                for (std::int32_t v = whole ? cell_texels / 2 : 0; v < rows; v += cell_texels)
                    for (std::int32_t u = cell_texels / 2; u < piece; u += cell_texels) {
                        const std::int32_t column = (x + u) % tile_side / cell_texels;
                        const std::int32_t row = (top + v) / cell_texels;
                        const std::int32_t tile = tile_y * tiles + (x + u) / tile_side;
                        shown[(std::size_t(row) * std::size_t(cells) + std::size_t(column)) * count +
                              std::size_t(tile)] =
                            (*sources)[std::size_t(v) * std::size_t(piece) + std::size_t(u)];
                    }
            }
        }

    share.shifted = greatest_shifted(shown, tiles);
    for (auto begin = shown.begin(); begin != shown.end(); begin += std::ptrdiff_t(count)) {
        const auto end = begin + std::ptrdiff_t(count);
        std::sort(begin, end);
        const double all = double(count);
        double alike = 0,
               own = 0;  // ordered pairs of occurrences that show the same; occurrences of the tile
        for (auto run = begin; run != end;) {
            const auto next = std::upper_bound(run, end, *run);
            const double length = double(next - run);
            alike += length * (length - 1);
            if (*run == 0) own = length;
            run = next;
        }
        share.tile.cells.push_back(static_cast<float>(own / all));
        share.repeat.cells.push_back(static_cast<float>(alike / (all * (all - 1))));
    }
    summarise(share.tile, cells);
    summarise(share.repeat, cells);

    // Pairs of independent draws are themselves independent, two by two
    const double pairs = double(share.occurrences) * double(share.occurrences - 1) / 2;
    share.chance = share.repeat.mean + 3 * std::sqrt(share.repeat.mean * (1 - share.repeat.mean) / pairs);
    const auto beyond = std::count_if(share.repeat.cells.begin(), share.repeat.cells.end(),
                                      [&](float rate) { return double(rate) > share.chance; });
    share.beyond_chance = double(beyond) / double(share.repeat.cells.size());
    progress.advance(1);
    return share;
}

}  // namespace tessera
