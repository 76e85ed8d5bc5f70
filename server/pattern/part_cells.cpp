#include "server/pattern/part_cells.h"

#include <algorithm>
#include <utility>

#include "server/pattern/instance_texture.h"
#include "server/pattern/pattern_kept.h"
#include "server/pattern/pattern_mips.h"

namespace tessera {
namespace {

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

}  // namespace

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

std::unique_ptr<const PartCells> make_part_cells(const JointPart& part, const Grid& grid) {
    SharedInstances instances;
    return make_cells(part, grid, instances);
}

}  // namespace tessera
