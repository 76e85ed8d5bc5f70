#include "server/pattern/joint_types.h"

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "server/pattern/halved.h"
#include "server/pattern/part_cells.h"
#include "server/pattern/slice_cache.h"

namespace tessera {
namespace {

constexpr int most_cell_log2 = 10;
/// Texels of all different cells and parts of a slice that are composited when it is first looked at: of the
/// only one, when the scene loads.
constexpr std::uint64_t most_texels = std::uint64_t{1} << 28;
constexpr std::uint64_t most_texels_of_many = std::uint64_t{1} << 26;
/// Cells of all types and parts that are told apart.
constexpr std::uint64_t most_looks = std::uint64_t{1} << 22;
/// Images that lie ready, of all different cells together.
constexpr std::uint64_t kept_bytes = std::uint64_t{16} << 20;
constexpr std::uint64_t kept_bytes_of_many = std::uint64_t{6} << 20;

template <class Visit>
void for_references(const JointPart& part, const Visit& visit) {
    if (part.reference != nullptr) visit(*part.reference);
    for (const JointPart& of : part.parts) for_references(of, visit);
}
template <class Visit>
void for_maps(const JointPart& part, const Visit& visit) {
    if (part.map != nullptr) visit(*part.map);
    for (const JointPart& of : part.parts) for_maps(of, visit);
}

/// Textures and colours that are composited.
std::uint64_t parts_of(const JointPart& part) {
    if (part.parts.empty()) return 1;
    std::uint64_t count = 0;
    for (const JointPart& of : part.parts) count += parts_of(of);
    return count;
}

/// Which types show the same in all parts.
struct Distinct {
    std::vector<std::uint32_t> of_type;
    std::vector<std::uint16_t> types;  ///< One of each.
};

Distinct distinct_types(const Grid& grid, const JointPart& whole) {
    Distinct distinct;
    std::map<std::vector<std::uint64_t>, std::uint32_t> known;
    std::vector<std::uint16_t> cells;
    for (std::uint32_t type = 0; type < grid.quadtree->types(); ++type) {
        std::vector<std::uint64_t> looks;
        for_references(whole, [&](const ReferencePlan& reference) {
            if (!is_typed(reference)) return;
            cell_types(reference, grid.cell_log2, static_cast<std::uint16_t>(type), cells);
            for (const std::uint16_t cell : cells) {
                const Look look = reference.program->look_of_type(cell);
                looks.push_back(static_cast<std::uint32_t>(look.pattern));
                looks.push_back(look.pattern < 0 || reference.transform == nullptr
                                    ? 0
                                    : std::uint64_t{look.x} << 32 | std::uint64_t{look.y} << 16 |
                                          std::uint64_t{look.turn} << 8 | look.scale);
            }
        });
        const auto [at, is_new] = known.try_emplace(std::move(looks), distinct.types.size());
        if (is_new) distinct.types.push_back(static_cast<std::uint16_t>(type));
        distinct.of_type.push_back(at->second);
    }
    return distinct;
}

/// After how many slices all parts repeat. At most 2^20: beyond, 0.
std::int32_t common_slices(const Grid& grid, const JointPart& whole) {
    if (grid.cell_slices > 0) return grid.cell_slices;
    std::int64_t slices = 1;
    for_references(whole, [&](const ReferencePlan& reference) {
        if (slices <= 1 << 20) slices = std::lcm(slices, std::int64_t{reference.patterns->slices});
    });
    return slices <= 1 << 20 ? static_cast<std::int32_t>(slices) : 0;
}

class JointTypes final : public TypeImages {
  public:
    JointTypes(const Grid& grid, const JointPart& whole, Distinct distinct, std::int32_t slices)
        : cell_log2_{grid.cell_log2},
          repeat_{grid.cell_slices == 0},
          slices_{slices},
          distinct_{std::move(distinct)} {
        cells_ = make_part_cells(whole, grid);
        // Coarse images lie ready, as many levels as take little
        const std::uint64_t most = slices > 1 ? kept_bytes_of_many : kept_bytes;
        first_kept_ = cell_log2_ + 1;
        while (first_kept_ > 0 &&
               (std::uint64_t{distinct_.types.size()} << 2 * (cell_log2_ - first_kept_ + 1)) * 16 * 4 / 3 <=
                   most)
            --first_kept_;
    }

    void draw(std::uint16_t type, int level, std::int32_t slice, LinearImage& out) const override {
        if (level < first_kept_) {
            composite(type, slice, out);
            for (int l = 0; l < level; ++l) out = halved(out);
            return;
        }
        const std::int32_t side = std::int32_t{1} << (cell_log2_ - level);
        const std::size_t values = static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 4;
        const auto kept =
            kept_.get(slice, [&](std::int64_t at) { return made(static_cast<std::int32_t>(at)); });
        const float* from = kept->levels[static_cast<std::size_t>(level - first_kept_)].data() +
                            distinct_.of_type[type] * values;
        out.width = out.height = side;
        out.values.assign(from, from + values);
    }
    std::int32_t slices() const noexcept override { return repeat_ ? slices_ : 1; }
    std::size_t memory_bytes() const noexcept override {
        std::size_t of_a_slice = 0;
        for (int level = first_kept_; level <= cell_log2_; ++level)
            of_a_slice += (distinct_.types.size() << 2 * (cell_log2_ - level)) * 4 * sizeof(float);
        return sizeof *this + distinct_.of_type.size() * sizeof(std::uint32_t) +
               distinct_.types.size() * sizeof(std::uint16_t) + cells_->memory_bytes() +
               of_a_slice * std::min(SliceCache<Kept>::most_kept, static_cast<std::size_t>(slices_));
    }
    std::string description() const override {
        return cells_->description() + ", " + std::to_string(distinct_.types.size()) + " different cells";
    }

  private:
    /// Images of a slice's different cells, one after the other.
    struct Kept {
        std::vector<std::vector<float>> levels;  ///< [level − first_kept_]
    };
    std::shared_ptr<const Kept> made(std::int32_t slice) const {
        auto kept = std::make_shared<Kept>();
        kept->levels.resize(static_cast<std::size_t>(cell_log2_ + 1 - first_kept_));
        LinearImage cell;
        for (const std::uint16_t type : distinct_.types) {
            composite(type, slice, cell);
            for (int level = 0;; ++level) {
                if (level >= first_kept_) {
                    auto& images = kept->levels[static_cast<std::size_t>(level - first_kept_)];
                    images.insert(images.end(), cell.values.begin(), cell.values.end());
                }
                if (level == cell_log2_) break;
                cell = halved(cell);
            }
        }
        return kept;
    }

    /// Level 0 of a cell.
    void composite(std::uint16_t type, std::int32_t slice, LinearImage& out) const {
        const std::int32_t side = std::int32_t{1} << cell_log2_;
        out.width = out.height = side;
        out.values.resize(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 4);
        cells_->draw(type, slice, out);
    }

    int cell_log2_;
    bool repeat_;
    std::int32_t slices_;
    Distinct distinct_;
    std::unique_ptr<const PartCells> cells_;
    int first_kept_ = 0;
    SliceCache<Kept> kept_;
};

}  // namespace

bool is_joint(const ReferencePlan& plan) {
    const auto basis = plan.program->basis();
    return ((basis == CellProgram::Basis::typed && plan.grid.quadtree != nullptr) ||
            basis == CellProgram::Basis::constant) &&
           (plan.transform == nullptr || !plan.transform->overflow);
}

bool is_joint(const StoredMap& map) {
    return map.edge == StoredMap::Edge::wrap && map.width == map.height && map.x == 0 && map.y == 0 &&
           std::has_single_bit(static_cast<std::uint32_t>(map.width));
}

std::optional<Grid> joint_grid(const JointPart& whole) {
    std::optional<Grid> grid;
    int cell_log2 = 0;
    bool fits = true;
    for_maps(whole, [&](const StoredMap& map) {
        cell_log2 =
            std::max(cell_log2, std::countr_zero(static_cast<std::uint32_t>(map.width)) + map.cells_log2);
    });
    for_references(whole, [&](const ReferencePlan& reference) {
        cell_log2 = std::max(cell_log2, reference.grid.cell_log2);
        if (!grid) {
            grid = reference.grid;
            if (!is_typed(reference)) grid->quadtree = nullptr;
        }
        fits = fits && grid->cell_slices == reference.grid.cell_slices;
        if (!is_typed(reference)) return;
        if (grid->quadtree == nullptr)
            grid = reference.grid;
        else
            fits = fits && grid->quadtree->is_lifted(*reference.grid.quadtree,
                                                     reference.grid.cell_log2 - grid->cell_log2);
    });
    if (!grid || !fits || cell_log2 > most_cell_log2) return std::nullopt;
    // Where all cells are alike any small quadtree will do
    if (grid->quadtree == nullptr)
        grid->quadtree = std::make_shared<const TypedQuadtree>(0, 64);
    else if (grid->cell_log2 != cell_log2)
        grid->quadtree =
            std::make_shared<const TypedQuadtree>(grid->quadtree->lifted(cell_log2 - grid->cell_log2));
    grid->cell_log2 = cell_log2;
    return grid;
}

std::shared_ptr<const TypeImages> make_joint_types(const Grid& grid, const JointPart& whole) {
    const std::int32_t slices = common_slices(grid, whole);
    std::uint64_t looks = 0;
    for_references(whole, [&](const ReferencePlan& reference) {
        looks += std::uint64_t{grid.quadtree->types()} << 2 * (grid.cell_log2 - reference.grid.cell_log2);
    });
    if (slices == 0 || looks > most_looks) return nullptr;
    Distinct distinct = distinct_types(grid, whole);
    if (((distinct.types.size() * parts_of(whole)) << 2 * grid.cell_log2) >
        (slices > 1 ? most_texels_of_many : most_texels))
        return nullptr;
    return std::make_shared<JointTypes>(grid, whole, std::move(distinct), slices);
}

}  // namespace tessera
