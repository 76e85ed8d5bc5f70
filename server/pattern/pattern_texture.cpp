#include "server/pattern/pattern_texture.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "server/pattern/area_expectation.h"
#include "server/pattern/cell_texture.h"
#include "server/pattern/instance_texture.h"
#include "server/pattern/layer_types.h"
#include "server/pattern/layered_texture.h"
#include "server/pattern/pixel_map_texture.h"
#include "server/pattern/texel_range.h"
#include "server/texture/constant_texture.h"

namespace tessera {
namespace {

class Compiler {
  public:
    explicit Compiler(const Plan& plan)
        : plan_{plan}, ranges_{texel_ranges(plan)}, made_(plan.textures.size()) {}

    /// Each texture once, and only those that are asked for.
    std::shared_ptr<const Texture> texture(std::size_t index) {
        if (!made_[index])
            made_[index] =
                std::visit([&](const auto& what) { return make(what); }, plan_.textures[index].what);
        return made_[index];
    }

  private:
    std::shared_ptr<const Texture> make(const ReferencePlan& plan) {
        if (plan.transform) return make_instance_texture(plan);
        return make_cell_texture(plan);
    }
    std::shared_ptr<const Texture> make(const GivenPlan& plan) { return plan.texture; }

    std::shared_ptr<const Texture> make(const PixelMapPlan& plan) {
        std::vector<bool> shown(plan.textures.size());
        for (const std::int32_t family : plan.map->values) shown[static_cast<std::size_t>(family)] = true;
        std::vector<Layer> parts(plan.textures.size());
        for (std::size_t family = 0; family < parts.size(); ++family)
            if (shown[family])
                parts[family] = {texture(plan.textures[family]), ranges_[plan.textures[family]]};
        return make_pixel_map_texture(*plan.map, std::move(parts));
    }

    std::shared_ptr<const Texture> make(const LayersPlan& plan) {
        std::vector<std::size_t> flat;
        for (const std::size_t part : plan.textures) flatten(part, flat);
        // What is transparent everywhere, or lies below what is opaque everywhere, is dead
        std::erase_if(flat, [&](std::size_t part) { return ranges_[part].transparent(); });
        const auto opaque = std::find_if(flat.rbegin(), flat.rend(),
                                         [&](std::size_t part) { return ranges_[part].opaque(); });
        if (opaque != flat.rend()) flat.erase(flat.begin(), opaque.base() - 1);
        if (flat.empty()) return make_constant_texture({0, 0, 0, 0});

        std::vector<Layer> layers;
        for (std::size_t from = 0; from < flat.size();) {
            const std::size_t to = run_end(flat, from);
            std::shared_ptr<const Texture> joint;
            if (to - from > 1) joint = together({flat.data() + from, to - from});
            if (joint) {
                TexelRange range = ranges_[flat[from]];
                for (std::size_t k = from + 1; k < to; ++k) range = range_over(ranges_[flat[k]], range);
                layers.push_back({std::move(joint), range});
            } else {
                for (std::size_t k = from; k < to; ++k)
                    layers.push_back({texture(flat[k]), ranges_[flat[k]]});
            }
            from = to;
        }
        return make_layered_texture(std::move(layers));
    }

    void flatten(std::size_t index, std::vector<std::size_t>& flat) const {
        if (const auto* layers = std::get_if<LayersPlan>(&plan_.textures[index].what))
            for (const std::size_t part : layers->textures) flatten(part, flat);
        else
            flat.push_back(index);
    }

    const ReferencePlan* typed(std::size_t index) const {
        const auto* reference = std::get_if<ReferencePlan>(&plan_.textures[index].what);
        return reference != nullptr && is_typed_layer(*reference) ? reference : nullptr;
    }
    bool constant(std::size_t index) const {
        const auto* given = std::get_if<GivenPlan>(&plan_.textures[index].what);
        return given != nullptr && given->texture->kind() == "constant";
    }

    /// Layers from `from` on that one quadtree decides, constants among them.
    std::size_t run_end(const std::vector<std::size_t>& flat, std::size_t from) const {
        const ReferencePlan* first = nullptr;
        std::size_t end = from;
        for (; end < flat.size(); ++end) {
            if (constant(flat[end])) continue;
            const ReferencePlan* layer = typed(flat[end]);
            if (layer == nullptr) break;
            if (first == nullptr) first = layer;
            if (layer->grid.quadtree != first->grid.quadtree ||
                layer->grid.cell_log2 != first->grid.cell_log2 ||
                layer->grid.cell_slices != first->grid.cell_slices)
                break;
        }
        return std::max(end, from + 1);
    }

    std::shared_ptr<const Texture> together(std::span<const std::size_t> run) const {
        std::vector<TypedLayer> layers;
        const Grid* grid = nullptr;
        for (const std::size_t index : run) {
            const ReferencePlan* reference = typed(index);
            if (reference != nullptr) grid = &reference->grid;
            layers.push_back({reference, ranges_[index].least});
        }
        if (grid == nullptr) return nullptr;  // Constants alone
        const auto types = make_layer_types(*grid, layers);
        return types ? make_typed_texture(*grid, types) : nullptr;
    }

    const Plan& plan_;
    std::vector<TexelRange> ranges_;
    std::vector<std::shared_ptr<const Texture>> made_;
};

/// Of how many slices tables are kept.
std::uint64_t kept_slices(const ReferencePlan& plan) {
    return std::min<std::uint64_t>(
        static_cast<std::uint64_t>(plan.grid.cell_slices > 0 ? plan.grid.cell_slices : plan.patterns->slices),
        8);
}

/// The tables of a typed quadtree's nodes.
std::uint64_t tables_bytes(const ReferencePlan& plan) {
    if (!plan.grid.quadtree) return 0;
    return std::uint64_t{plan.grid.quadtree->types()} * 40 * 80 * kept_slices(plan);
}

std::uint64_t bytes_of(const ReferencePlan& plan) {
    // A MIP chain of floats and codes, and what sums are made in
    const std::uint64_t texels = plan.patterns->codes.size() / 4;
    std::uint64_t bytes = tables_bytes(plan) + plan.program->memory_bytes() +
                          area_expectation_bytes(*plan.program) * kept_slices(plan);
    if (!plan.transform) return bytes + texels * 60;
    const std::uint64_t images = InstanceImages::bytes(plan);
    if (images > std::numeric_limits<std::uint64_t>::max() / 2) return images;
    return bytes + images + (std::uint64_t{32} << 20);
}

}  // namespace

std::shared_ptr<const Texture> make_pattern_texture(const Plan& plan) {
    return Compiler{plan}.texture(plan.textures.size() - 1);
}

std::size_t pattern_bytes(const Plan& plan) {
    std::uint64_t total = 0;
    for (const PlannedTexture& texture : plan.textures) {
        std::uint64_t bytes = 0;
        if (const auto* reference = std::get_if<ReferencePlan>(&texture.what))
            bytes = bytes_of(*reference);
        else if (const auto* map = std::get_if<PixelMapPlan>(&texture.what))
            bytes = map->map->values.size() * 6 + (std::uint64_t{1} << 20);
        else if (const auto* layers = std::get_if<LayersPlan>(&texture.what))
            bytes = layers->textures.size() > 1 ? std::uint64_t{32} << 20 : 0;
        if (bytes > std::numeric_limits<std::uint64_t>::max() - total)
            return std::numeric_limits<std::size_t>::max();
        total += bytes;
    }
    return static_cast<std::size_t>(total);
}

}  // namespace tessera
