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

}  // namespace

Result<TileShare> measure_tile_share(const ExchangeTexture& texture, std::int32_t tile_side,
                                     const ProgressPart& progress) {
    TileShare share;
    const std::int32_t cells = share.cells_a_side = tile_side / cell_texels;
    const std::int32_t tiles = std::clamp(16384 / tile_side, 8, 64);  // each way
    share.occurrences = std::int64_t{tiles} * tiles;
    const std::int64_t first = -std::int64_t{tiles} / 2 * tile_side;

    // One row of cells after the other, over all tiles: what each cell shows in each of them
    std::vector<std::vector<std::uint32_t>> shown(std::size_t(cells), std::vector<std::uint32_t>{});
    for (std::int32_t row = 0; row < cells; ++row) {
        progress.advance(double(row) / cells);
        if (progress.progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
        for (auto& of_cell : shown) of_cell.clear();
        const std::int32_t piece = std::min(tiles * tile_side, 4096);
        for (std::int32_t y = 0; y < tiles; ++y)
            for (std::int32_t x = 0; x < tiles * tile_side; x += piece) {
                const auto sources = texture.sources(
                    {0, first + x, first + std::int64_t{y} * tile_side + row * cell_texels + cell_texels / 2,
                     piece, 1});
                if (!sources) return sources.error();
                for (std::int32_t u = cell_texels / 2; u < piece; u += cell_texels)
                    shown[std::size_t((x + u) % tile_side / cell_texels)].push_back(
                        (*sources)[std::size_t(u)]);
            }
        for (auto& of_cell : shown) {
            std::sort(of_cell.begin(), of_cell.end());
            const double all = double(of_cell.size());
            double alike = 0,
                   own = 0;  // ordered pairs of occurrences that show the same; occurrences of the tile
            for (auto run = of_cell.begin(); run != of_cell.end();) {
                const auto end = std::upper_bound(run, of_cell.end(), *run);
                const double count = double(end - run);
                alike += count * (count - 1);
                if (*run == 0) own = count;
                run = end;
            }
            share.tile.cells.push_back(static_cast<float>(own / all));
            share.repeat.cells.push_back(static_cast<float>(alike / (all * (all - 1))));
        }
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
