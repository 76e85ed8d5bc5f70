#include "server/pattern/instance_texture.h"

#include <utility>

#include "server/pattern/drawn_instances.h"
#include "server/pattern/overflow_texture.h"

namespace tessera {
namespace {

std::string images_text(const ReferencePlan& plan) {
    return std::to_string(plan.patterns->count) + " patterns in " +
           std::to_string(plan.transform->turns.size()) + " turns and " +
           std::to_string(plan.transform->scales.size()) + " scales";
}

class InstanceTypes final : public TypeImages {
  public:
    InstanceTypes(const ReferencePlan& plan, std::shared_ptr<const InstanceImages> images)
        : plan_{plan}, images_{std::move(images)} {}

    void draw(std::uint16_t type, int level, std::int32_t slice, LinearImage& out) const override {
        const std::int32_t side = std::int32_t{1} << (plan_.grid.cell_log2 - level);
        out.width = out.height = side;
        out.values.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 4, 0.0F);
        const Look look = plan_.program->look_of_type(type);
        const SummedArea* image = images_->find(look, slice);
        if (image == nullptr) return;
        const CellPlace at = place_in_cell(look, image->width(), plan_.grid.cell_log2, false);
        const TexelSpan columns = texels_met(at.left, image->width(), level);
        const TexelSpan rows = texels_met(at.top, image->height(), level);
        for (std::int64_t y = rows.from; y < rows.to; ++y)
            instance_row(*image, at.left, at.top, level, y, columns.from, columns.to,
                         out.row(static_cast<std::int32_t>(y)) + columns.from * 4);
    }
    std::int32_t slices() const noexcept override { return plan_.patterns->slices; }
    std::size_t memory_bytes() const noexcept override { return images_->memory_bytes(); }
    std::string description() const override { return images_text(plan_); }

  private:
    ReferencePlan plan_;
    std::shared_ptr<const InstanceImages> images_;
};

}  // namespace

std::shared_ptr<const TypeImages> make_instance_types(const ReferencePlan& plan,
                                                      std::shared_ptr<const InstanceImages> images) {
    return std::make_shared<InstanceTypes>(plan, std::move(images));
}

std::shared_ptr<const PatternTexture> make_instance_texture(const ReferencePlan& plan,
                                                            std::shared_ptr<const InstanceImages> images) {
    if (!images) images = std::make_shared<const InstanceImages>(plan);
    if (plan.transform->overflow) return make_overflow_texture(plan, std::move(images));
    switch (plan.program->basis()) {
        case CellProgram::Basis::typed:
            return make_typed_texture(plan.grid, std::make_shared<InstanceTypes>(plan, std::move(images)));
        case CellProgram::Basis::constant: {
            // One look for all types: any small quadtree says where it is
            Grid grid = plan.grid;
            grid.quadtree = std::make_shared<TypedQuadtree>(0, 64);
            return make_typed_texture(grid, std::make_shared<InstanceTypes>(plan, std::move(images)));
        }
        default:
            return make_drawn_instances(plan, std::move(images));
    }
}

}  // namespace tessera
