#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/progress/progress.h"
#include "server/quality/histogram.h"
#include "server/quality/progress_part.h"
#include "server/texture/exchange.h"
#include "shared/result/result.h"

namespace tessera {

/// The textures of one asset that are measured.
struct MeasuredTextures {
    std::shared_ptr<const ExchangeTexture> hard;     ///< Not blended.
    std::shared_ptr<const ExchangeTexture> blended;  ///< As it is served.
    std::shared_ptr<const ExchangeTexture>
        kolar;  ///< interchange: `choice: kolar`, for comparison. May be null.
};
MeasuredTextures textures_of(const ExchangeAsset& asset, std::uint64_t seed = 0);

/// Adjacent texels in units of CIELAB.
struct Steps {
    double mean = 0;
    double percentile_99 = 0;
};

/// Steps between adjacent texels of level 0 that show different sources; for wang also between tiles. The
/// hard ratio is the product of two: how quiet the places are that borders run through, and how badly the
/// sources fit there.
struct Seams {
    std::uint64_t pairs = 0;
    Steps exemplar;                   ///< Between all adjacent texels of the exemplar.
    Steps hard, blended;              ///< At the same places.
    Steps hard_ratio, blended_ratio;  ///< Against the exemplar's.
    /// At the same places, what either side's own source goes on with there: what would be seen without a
    /// seam. None between wang's tiles, which end there.
    std::uint64_t natural_steps = 0;
    Steps natural;
    Steps natural_ratio;   ///< Against the exemplar's: below 1 where borders keep to quiet places.
    Steps excess;          ///< hard against natural: 1 where sources meet as if they were one.
    double new_edges = 0;  ///< Share of pairs whose step is seen, and is in neither source.
    std::uint64_t quiet_steps = 0;
    Steps quiet_ratio;  ///< The quietest curves of the exemplar itself (quiet_curves.h), against its own.
    std::vector<float>
        energy;  ///< tile_side²: at each place of the tile, its hard steps' mean ratio; 0 without seams.
    std::vector<float>
        frequency;  ///< tile_side²: how many of its two steps, right and down, are seams: 0 to 2.
};

/// Autocorrelation of lightness: 1 where a shift changes nothing, as a shift by one tile does not change the
/// plain periodic tile.
struct Repetition {
    struct Shift {
        double x = 0, y = 0;  ///< In tiles.
        double value = 0;
    };
    struct Level {
        int level = 0;
        std::vector<Shift>
            shifts;       ///< By whole tiles, up to 3 each way; opposite shifts are alike, and listed once.
        Shift greatest;   ///< Of these.
        double mean = 0;  ///< Of these.
        double elsewhere = 0;  ///< The greatest of as many shifts half a tile off: what chance shows.
        /// The greatest by 4 to 8 tiles, up to half the sample, at level 0: where units of several tiles are
        /// decided at once, they may be alike. As few as four pairs of such units are in one shift.
        std::optional<Shift> farther;
    };
    std::vector<Level> levels;  ///< 0, and 4 and 5 where the tile has texels there.
    /// Lightness of each place of the tile, 0 to 100, on average over the occurrences in the sample: whatever
    /// of the period can be seen, is seen here. Of a large tile, every so many texels.
    std::int32_t mean_side = 0;
    std::vector<float> mean_lightness;
};

/// What each place of the tile shows, over all occurrences of the tile in a sample.
struct TileShare {
    struct Figure {
        double mean = 0;
        double greatest = 0;
        double corner = 0;         ///< The greatest of the four cells around the tile's corner.
        double border = 0;         ///< Mean over the cells along the tile's border.
        std::vector<float> cells;  ///< cells_a_side², rows from the top
    };
    std::int32_t cells_a_side = 0;  ///< Cells of 8×8 texels, looked at in their middle.
    std::int64_t occurrences = 0;
    Figure tile;    ///< How often the tile itself shows.
    Figure repeat;  ///< How likely two occurrences of the tile show the same source.
    /// How often a place shows what it shows so many tiles away, up to 8 each way, on average over the tile's
    /// places: the greatest of these. Counted over many more tiles than correlations are.
    Repetition::Shift shifted;
    double chance =
        0;  ///< What independent draws with the mean repeat rate show, and three standard deviations.
    double beyond_chance = 0;  ///< Share of cells that repeat more often than that.
};

/// Distances of histograms from the exemplar's, in units of CIELAB: how far values must move on average.
struct Fidelity {
    struct Distances {
        double lightness = 0, green_red = 0, blue_yellow = 0;
        double steps = 0;  ///< Of differences between adjacent texels.
    };
    Distances texture;  ///< Of the blended texture.
    Distances tile;     ///< Of the plain tile.
    struct Curves {
        Histogram lightness{0, 100}, green_red{-128, 128}, blue_yellow{-128, 128}, steps{0, 100};
    };
    Curves exemplar_curves, texture_curves;
};

/// A figure with the limit it must keep.
struct Gate {
    std::string name;
    double value = 0;
    double limit = 0;
    bool passed() const noexcept { return value <= limit; }
};

struct Quality {
    Seams seams;
    Repetition repetition;
    TileShare share;
    std::optional<TileShare> kolar;
    Fidelity fidelity;
    std::vector<Gate> gates;
    bool passed() const noexcept;
};

/// Errors of all: cancelled, and the texture's own.
Result<Seams> measure_seams(const ExchangeAsset& asset, const ExchangeTexture& hard,
                            const ExchangeTexture& blended, const ProgressPart& progress);
/// Of a sample of 4096² texels: at tiles of more than 512 texels, texels some way apart, so that it holds 8×8
/// tiles.
Result<Repetition> measure_repetition(const ExchangeTexture& texture, std::int32_t tile_side,
                                      const ProgressPart& progress);
/// How to look at many occurrences of the tile: row by row, or, where every look at a tile decides anew and
/// that takes long, at fewer of them, each at once.
enum class TileSample { rows, whole_tiles };
Result<TileShare> measure_tile_share(const ExchangeTexture& texture, std::int32_t tile_side,
                                     TileSample sample, const ProgressPart& progress);
Result<Fidelity> measure_fidelity(const ExchangeAsset& asset, const ExchangeTexture& texture,
                                  const ProgressPart& progress);

/// What the asset's method must keep.
std::vector<Gate> gates_of(const ExchangeAsset& asset, const Seams& seams, const Repetition& repetition,
                           const TileShare& share);

/// All of it, with the gates of the asset's method.
Result<Quality> measure_quality(const ExchangeAsset& asset, const MeasuredTextures& textures,
                                const ProgressPart& progress);

/// Rectangles of the exemplar whose adjacent texels belong together: the whole; for wang each of its tiles.
struct TexelRect {
    std::int32_t x = 0, y = 0, width = 0, height = 0;
};
std::vector<TexelRect> exemplar_parts(const ExchangeAsset& asset);

}  // namespace tessera
