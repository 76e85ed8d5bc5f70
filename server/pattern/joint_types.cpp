#include "server/pattern/joint_types.h"

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "server/pattern/instance_texture.h"
#include "server/pattern/pattern_kept.h"
#include "server/pattern/pattern_mips.h"
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

/// Patterns that fill their cells.
class PatternTypes final : public TypeImages {
  public:
    explicit PatternTypes(const ReferencePlan& plan) : program_{plan.program}, mips_{*plan.patterns} {}
    void draw(std::uint16_t type, int level, std::int32_t slice, LinearImage& out) const override {
        const std::int32_t image = mips_.image(program_->look_of_type(type).pattern, slice);
        const std::int32_t side = std::int32_t{1} << (mips_.side_log2() - level);
        out.width = out.height = side;
        const float* from = mips_.linear(level).row(image * side);
        out.values.assign(from, from + std::ptrdiff_t{side} * side * 4);
    }
    std::int32_t slices() const noexcept override { return mips_.slices(); }
    std::size_t memory_bytes() const noexcept override { return mips_.memory_bytes(); }
    std::string description() const override { return std::to_string(mips_.count()) + " patterns"; }

  private:
    std::shared_ptr<const CellProgram> program_;
    PatternMips mips_;
};

LinearImage halved(const LinearImage& fine) {
    LinearImage out{fine.width / 2, fine.height / 2};
    for (std::int32_t y = 0; y < out.height; ++y) {
        const float* upper = fine.row(2 * y);
        const float* lower = fine.row(2 * y + 1);
        float* texel = out.row(y);
        for (std::int32_t x = 0; x < out.width; ++x, upper += 8, lower += 8, texel += 4)
            for (std::size_t c = 0; c < 4; ++c)
                texel[c] = ((upper[c] + upper[c + 4]) + (lower[c] + lower[c + 4])) * 0.25F;
    }
    return out;
}

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

bool is_typed(const ReferencePlan& plan) { return plan.program->basis() == CellProgram::Basis::typed; }

/// Types of the reference's own cells inside a common cell, row after row.
void cell_types(const ReferencePlan& plan, int cell_log2, std::uint16_t type,
                std::vector<std::uint16_t>& types) {
    const int height = cell_log2 - plan.grid.cell_log2;
    types.assign(std::size_t{1} << 2 * height, type);
    if (!is_typed(plan)) return;
    std::vector<std::uint16_t> above;
    for (int h = height, side = 1; h > 0; --h, side *= 2) {
        above.assign(types.begin(), types.begin() + std::ptrdiff_t{side} * side);
        for (std::size_t i = 0; i < above.size(); ++i) {
            const auto& four = plan.grid.quadtree->children(h, above[i]);
            const std::size_t row = i / static_cast<std::size_t>(side),
                              column = i % static_cast<std::size_t>(side);
            for (std::size_t child = 0; child < 4; ++child)
                types[(2 * row + child / 2) * 2 * static_cast<std::size_t>(side) + 2 * column + child % 2] =
                    four[child];
        }
    }
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

/// Draws a part's share of common cells, at level 0.
class PartCells {
  public:
    virtual ~PartCells() = default;
    /// `out` is of a common cell's size.
    virtual void draw(std::uint16_t type, std::int32_t slice, LinearImage& out) const = 0;
    virtual std::size_t memory_bytes() const noexcept = 0;
    virtual std::string description() const = 0;
};

class ColourCells final : public PartCells {
  public:
    explicit ColourCells(const std::array<float, 4>& color) : color_{color} {}
    void draw(std::uint16_t, std::int32_t, LinearImage& out) const override {
        for (std::size_t i = 0; i < out.values.size(); i += 4) std::copy_n(color_.begin(), 4, &out.values[i]);
    }
    std::size_t memory_bytes() const noexcept override { return sizeof *this; }
    std::string description() const override { return "a colour"; }

  private:
    std::array<float, 4> color_;
};

/// Instances that several parts show are rendered once.
class SharedInstances {
  public:
    struct Found {
        std::shared_ptr<const InstanceImages> images;
        bool is_new = false;
    };
    Found of(const ReferencePlan& plan) {
        auto images = kept_.instances(plan);
        const bool is_new = std::find(known_.begin(), known_.end(), images) == known_.end();
        if (is_new) known_.push_back(images);
        return {std::move(images), is_new};
    }

  private:
    PatternKept kept_;
    std::vector<std::shared_ptr<const InstanceImages>> known_;
};

class ReferenceCells final : public PartCells {
  public:
    ReferenceCells(const ReferencePlan& plan, const Grid& grid, SharedInstances& instances)
        : plan_{plan}, cell_log2_{grid.cell_log2}, repeat_{grid.cell_slices == 0} {
        if (plan.transform != nullptr) {
            auto found = instances.of(plan);
            counts_images_ = found.is_new;
            images_ = make_instance_types(plan, std::move(found.images));
        } else {
            images_ = std::make_shared<PatternTypes>(plan);
        }
    }
    void draw(std::uint16_t type, std::int32_t slice, LinearImage& out) const override {
        if (repeat_) slice %= images_->slices();
        if (plan_.grid.cell_log2 == cell_log2_)
            return images_->draw(is_typed(plan_) ? type : 0, 0, slice, out);
        std::vector<std::uint16_t> types;
        cell_types(plan_, cell_log2_, type, types);
        const std::int32_t side = std::int32_t{1} << plan_.grid.cell_log2, cells = out.width / side;
        LinearImage cell;
        for (std::int32_t i = 0; i < cells * cells; ++i) {
            images_->draw(is_typed(plan_) ? types[static_cast<std::size_t>(i)] : 0, 0, slice, cell);
            for (std::int32_t y = 0; y < side; ++y)
                std::copy_n(cell.row(y), side * 4, out.row(i / cells * side + y) + i % cells * side * 4);
        }
    }
    std::size_t memory_bytes() const noexcept override {
        return sizeof *this + (counts_images_ ? images_->memory_bytes() : 0);
    }
    std::string description() const override { return images_->description(); }

  private:
    ReferencePlan plan_;
    int cell_log2_;
    bool repeat_;
    bool counts_images_ = true;  ///< Else another part does.
    std::shared_ptr<const TypeImages> images_;
};

std::unique_ptr<const PartCells> make_cells(const JointPart& part, const Grid& grid,
                                            SharedInstances& instances);

/// Layers, premultiplied over from the ground up.
class LayerCells final : public PartCells {
  public:
    LayerCells(const JointPart& whole, const Grid& grid, SharedInstances& instances) {
        for (const JointPart& part : whole.parts)
            layers_.push_back({part.color, is_colour(part) ? nullptr : make_cells(part, grid, instances)});
    }
    void draw(std::uint16_t type, std::int32_t slice, LinearImage& out) const override {
        std::fill(out.values.begin(), out.values.end(), 0.0F);
        LinearImage layer{out.width, out.height};
        for (const Layer& part : layers_) {
            const float* over = part.color.data();
            if (part.cells) {
                part.cells->draw(type, slice, layer);
                over = layer.values.data();
            }
            for (std::size_t i = 0; i < out.values.size(); i += 4, over += part.cells ? 4 : 0) {
                const float rest = 1 - over[3];
                for (std::size_t c = 0; c < 4; ++c) out.values[i + c] = over[c] + rest * out.values[i + c];
            }
        }
    }
    std::size_t memory_bytes() const noexcept override {
        std::size_t bytes = sizeof *this;
        for (const Layer& layer : layers_)
            if (layer.cells) bytes += layer.cells->memory_bytes();
        return bytes;
    }
    std::string description() const override {
        std::string text = std::to_string(layers_.size()) + " layers decided together (";
        for (std::size_t k = 0; k < layers_.size(); ++k)
            text += (k > 0 ? "; " : "") + (layers_[k].cells ? layers_[k].cells->description() : "a colour");
        return text + ")";
    }

  private:
    struct Layer {
        std::array<float, 4> color;
        std::unique_ptr<const PartCells> cells;  ///< Null: the colour.
    };
    static bool is_colour(const JointPart& part) {
        return part.reference == nullptr && part.map == nullptr && part.parts.empty();
    }
    std::vector<Layer> layers_;
};

/// A map's families, each where it has their number.
class MaskedCells final : public PartCells {
  public:
    MaskedCells(const JointPart& whole, const Grid& grid, SharedInstances& instances) : map_{*whole.map} {
        const std::vector<std::int32_t> shown = possible_values(map_);
        for (std::size_t family = 0; family < whole.parts.size(); ++family) {
            const bool is_shown =
                std::binary_search(shown.begin(), shown.end(), static_cast<std::int32_t>(family));
            families_.push_back(is_shown ? make_cells(whole.parts[family], grid, instances) : nullptr);
        }
    }
    void draw(std::uint16_t type, std::int32_t slice, LinearImage& out) const override {
        LinearImage shown{out.width, out.height};
        for (std::size_t family = 0; family < families_.size(); ++family) {
            if (!families_[family]) continue;
            families_[family]->draw(type, slice, shown);
            for (std::int32_t y = 0; y < out.height; ++y)
                for (std::int32_t x = 0; x < out.width; ++x)
                    if (map_.entry(x >> map_.cells_log2, y >> map_.cells_log2) ==
                        static_cast<std::int32_t>(family))
                        std::copy_n(shown.row(y) + x * 4, 4, out.row(y) + x * 4);
        }
    }
    std::size_t memory_bytes() const noexcept override {
        std::size_t bytes = sizeof *this + map_.values.size() * sizeof map_.values[0];
        for (const auto& family : families_)
            if (family) bytes += family->memory_bytes();
        return bytes;
    }
    std::string description() const override {
        std::string text = "a pixel map (";
        for (std::size_t family = 0; family < families_.size(); ++family)
            if (families_[family])
                text += (text.back() == '(' ? "" : "; ") + families_[family]->description();
        return text + ")";
    }

  private:
    StoredMap map_;
    std::vector<std::unique_ptr<const PartCells>> families_;  ///< Null where none is shown.
};

std::unique_ptr<const PartCells> make_cells(const JointPart& part, const Grid& grid,
                                            SharedInstances& instances) {
    if (part.reference != nullptr) return std::make_unique<ReferenceCells>(*part.reference, grid, instances);
    if (part.map != nullptr) return std::make_unique<MaskedCells>(part, grid, instances);
    if (!part.parts.empty()) return std::make_unique<LayerCells>(part, grid, instances);
    return std::make_unique<ColourCells>(part.color);
}

class JointTypes final : public TypeImages {
  public:
    JointTypes(const Grid& grid, const JointPart& whole, Distinct distinct, std::int32_t slices)
        : cell_log2_{grid.cell_log2},
          repeat_{grid.cell_slices == 0},
          slices_{slices},
          distinct_{std::move(distinct)} {
        SharedInstances instances;
        cells_ = make_cells(whole, grid, instances);
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
