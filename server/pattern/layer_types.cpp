#include "server/pattern/layer_types.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "server/pattern/instance_texture.h"
#include "server/pattern/pattern_mips.h"

namespace tessera {
namespace {

constexpr int most_cell_log2 = 10;
constexpr std::uint64_t most_texels = std::uint64_t{1} << 28;
/// Images that lie ready, of all different cells together.
constexpr std::uint64_t kept_bytes = std::uint64_t{16} << 20;

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

/// Which types show the same in all layers.
struct Distinct {
    std::vector<std::uint32_t> of_type;
    std::vector<std::uint16_t> types;  ///< One of each.
};

Distinct distinct_types(const Grid& grid, std::span<const TypedLayer> layers) {
    Distinct distinct;
    std::map<std::vector<std::uint64_t>, std::uint32_t> known;
    for (std::uint32_t type = 0; type < grid.quadtree->types(); ++type) {
        std::vector<std::uint64_t> looks;
        for (const TypedLayer& layer : layers) {
            if (layer.reference == nullptr) continue;
            const Look look = layer.reference->program->look_of_type(static_cast<std::uint16_t>(type));
            looks.push_back(static_cast<std::uint32_t>(look.pattern));
            looks.push_back(look.pattern < 0 || layer.reference->transform == nullptr
                                ? 0
                                : std::uint64_t{look.x} << 32 | std::uint64_t{look.y} << 16 |
                                      std::uint64_t{look.turn} << 8 | look.scale);
        }
        const auto [at, is_new] = known.try_emplace(std::move(looks), distinct.types.size());
        if (is_new) distinct.types.push_back(static_cast<std::uint16_t>(type));
        distinct.of_type.push_back(at->second);
    }
    return distinct;
}

/// After how many slices all layers repeat. At most 2^20: beyond, 0.
std::int32_t common_slices(const Grid& grid, std::span<const TypedLayer> layers) {
    if (grid.cell_slices > 0) return grid.cell_slices;
    std::int64_t slices = 1;
    for (const TypedLayer& layer : layers)
        if (layer.reference != nullptr) {
            slices = std::lcm(slices, std::int64_t{layer.reference->patterns->slices});
            if (slices > 1 << 20) return 0;
        }
    return static_cast<std::int32_t>(slices);
}

class LayerTypes final : public TypeImages {
  public:
    LayerTypes(const Grid& grid, std::span<const TypedLayer> layers, Distinct distinct, std::int32_t slices)
        : cell_log2_{grid.cell_log2},
          repeat_{grid.cell_slices == 0},
          slices_{slices},
          distinct_{std::move(distinct)} {
        for (const TypedLayer& layer : layers) {
            Part part{nullptr, layer.color};
            if (layer.reference != nullptr && layer.reference->transform != nullptr)
                part.images = make_instance_types(*layer.reference);
            else if (layer.reference != nullptr)
                part.images = std::make_shared<PatternTypes>(*layer.reference);
            parts_.push_back(std::move(part));
        }
        // Coarse images lie ready, as many levels as take little
        const std::uint64_t images = distinct_.types.size() * static_cast<std::uint64_t>(slices);
        first_kept_ = cell_log2_ + 1;
        while (first_kept_ > 0 && (images << 2 * (cell_log2_ - first_kept_ + 1)) * 16 * 4 / 3 <= kept_bytes)
            --first_kept_;
        kept_.resize(static_cast<std::size_t>(cell_log2_ + 1 - first_kept_));
        for (std::size_t image = 0; image < images && !kept_.empty(); ++image) {
            LinearImage cell;
            composite(distinct_.types[image % distinct_.types.size()],
                      static_cast<std::int32_t>(image / distinct_.types.size()), cell);
            for (int level = 0;; ++level) {
                if (level >= first_kept_) {
                    auto& kept = kept_[static_cast<std::size_t>(level - first_kept_)];
                    kept.insert(kept.end(), cell.values.begin(), cell.values.end());
                }
                if (level == cell_log2_) break;
                cell = halved(cell);
            }
        }
    }

    void draw(std::uint16_t type, int level, std::int32_t slice, LinearImage& out) const override {
        if (level < first_kept_) {
            composite(type, slice, out);
            for (int l = 0; l < level; ++l) out = halved(out);
            return;
        }
        const std::int32_t side = std::int32_t{1} << (cell_log2_ - level);
        const std::size_t values = static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 4;
        const std::size_t image =
            static_cast<std::size_t>(slice) * distinct_.types.size() + distinct_.of_type[type];
        const float* from = kept_[static_cast<std::size_t>(level - first_kept_)].data() + image * values;
        out.width = out.height = side;
        out.values.assign(from, from + values);
    }
    std::int32_t slices() const noexcept override { return repeat_ ? slices_ : 1; }
    std::size_t memory_bytes() const noexcept override {
        std::size_t bytes = sizeof *this + distinct_.of_type.size() * sizeof(std::uint32_t) +
                            distinct_.types.size() * sizeof(std::uint16_t);
        for (const auto& kept : kept_) bytes += kept.size() * sizeof(float);
        for (const Part& part : parts_)
            if (part.images) bytes += part.images->memory_bytes();
        return bytes;
    }
    std::string description() const override {
        std::string text = std::to_string(parts_.size()) + " layers decided together (";
        for (std::size_t k = 0; k < parts_.size(); ++k)
            text += (k > 0 ? "; " : "") + (parts_[k].images ? parts_[k].images->description() : "a colour");
        return text + "), " + std::to_string(distinct_.types.size()) + " different cells";
    }

  private:
    struct Part {
        std::shared_ptr<const TypeImages> images;  ///< Null: the colour.
        std::array<float, 4> color{};
    };

    /// Level 0 of a cell, premultiplied over from the ground up.
    void composite(std::uint16_t type, std::int32_t slice, LinearImage& out) const {
        const std::int32_t side = std::int32_t{1} << cell_log2_;
        out = LinearImage{side, side};
        LinearImage layer;
        for (const Part& part : parts_) {
            const float* over = part.color.data();
            if (part.images) {
                part.images->draw(type, 0, repeat_ ? slice % part.images->slices() : slice, layer);
                over = layer.values.data();
            }
            for (std::size_t i = 0; i < out.values.size(); i += 4, over += part.images ? 4 : 0) {
                const float rest = 1 - over[3];
                for (std::size_t c = 0; c < 4; ++c) out.values[i + c] = over[c] + rest * out.values[i + c];
            }
        }
    }

    int cell_log2_;
    bool repeat_;
    std::int32_t slices_;
    Distinct distinct_;
    std::vector<Part> parts_;
    int first_kept_ = 0;
    std::vector<std::vector<float>> kept_;  ///< [level − first_kept_]: slices of the different cells.
};

}  // namespace

bool is_typed_layer(const ReferencePlan& plan) {
    const auto basis = plan.program->basis();
    return plan.grid.quadtree != nullptr &&
           (basis == CellProgram::Basis::typed || basis == CellProgram::Basis::constant) &&
           (plan.transform == nullptr || !plan.transform->overflow);
}

std::shared_ptr<const TypeImages> make_layer_types(const Grid& grid, std::span<const TypedLayer> layers) {
    if (grid.cell_log2 > most_cell_log2) return nullptr;
    const std::int32_t slices = common_slices(grid, layers);
    Distinct distinct = distinct_types(grid, layers);
    const std::uint64_t images = distinct.types.size() * static_cast<std::uint64_t>(slices);
    if (images == 0 || images > most_texels || ((images * layers.size()) << 2 * grid.cell_log2) > most_texels)
        return nullptr;
    return std::make_shared<LayerTypes>(grid, layers, std::move(distinct), slices);
}

}  // namespace tessera
