#include "server/pattern/pattern_texture.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "server/pattern/area_expectation.h"
#include "server/pattern/cell_texture.h"
#include "server/pattern/draw_law.h"
#include "server/pattern/instance_texture.h"
#include "server/pattern/joint_types.h"
#include "server/pattern/layered_texture.h"
#include "server/pattern/pattern_kept.h"
#include "server/pattern/pixel_map_texture.h"
#include "server/pattern/texel_range.h"
#include "server/texture/constant_texture.h"

namespace tessera {
namespace {

class Compiler {
  public:
    Compiler(const Plan& plan, PatternKept& kept)
        : plan_{plan}, kept_{kept}, ranges_{texel_ranges(plan)}, made_(plan.textures.size()) {}

    /// Each texture once, and only those that are asked for.
    std::shared_ptr<const Texture> texture(std::size_t index) {
        if (!made_[index]) {
            const auto law = draw_law(plan_, index);
            made_[index] =
                std::visit([&](const auto& what) { return make(what, law); }, plan_.textures[index].what);
        }
        return made_[index];
    }

  private:
    std::shared_ptr<const Texture> make(const ReferencePlan& plan, const std::optional<DrawLaw>&) {
        const auto basis = plan.program->basis();
        const auto fresh = [&]() -> std::shared_ptr<const Texture> {
            if (plan.transform) return make_instance_texture(plan, kept_.instances(plan));
            return make_cell_texture(plan, kept_.mips(plan.patterns));
        };
        if (basis != CellProgram::Basis::typed && basis != CellProgram::Basis::constant) return fresh();
        return kept_.texture(key_of(plan), fresh);
    }
    std::shared_ptr<const Texture> make(const GivenPlan& plan, const std::optional<DrawLaw>&) {
        return plan.texture;
    }

    std::shared_ptr<const Texture> make(const PixelMapPlan& plan, const std::optional<DrawLaw>& law) {
        const std::vector<bool> shown = shown_families(plan);
        std::vector<Layer> parts(plan.textures.size());
        for (std::size_t family = 0; family < parts.size(); ++family)
            if (shown[family])
                parts[family] = {texture(plan.textures[family]), ranges_[plan.textures[family]]};
        const auto whole = joint_part(plan);
        return make_pixel_map_texture(*plan.map, std::move(parts), whole ? joint(*whole) : nullptr, law);
    }

    std::shared_ptr<const Texture> make(const LayersPlan& plan, const std::optional<DrawLaw>& law) {
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
            JointPart run;
            std::size_t to = from;
            for (; to < flat.size(); ++to) {
                auto part = joint_part(flat[to]);
                if (!part) break;
                run.parts.push_back(std::move(*part));
                if (to > from && !joint_grid(run)) {
                    run.parts.pop_back();
                    break;
                }
            }
            std::shared_ptr<const Texture> together;
            if (to - from > 1) together = joint(run);
            to = std::max(to, from + 1);
            if (together) {
                TexelRange range = ranges_[flat[from]];
                for (std::size_t k = from + 1; k < to; ++k) range = range_over(ranges_[flat[k]], range);
                layers.push_back({std::move(together), range});
            } else {
                for (std::size_t k = from; k < to; ++k)
                    layers.push_back({texture(flat[k]), ranges_[flat[k]]});
            }
            from = to;
        }
        return make_layered_texture(std::move(layers), law);
    }

    void flatten(std::size_t index, std::vector<std::size_t>& flat) const {
        if (const auto* layers = std::get_if<LayersPlan>(&plan_.textures[index].what))
            for (const std::size_t part : layers->textures) flatten(part, flat);
        else
            flat.push_back(index);
    }

    /// The texture as a part that types of a quadtree decide, if it is one.
    std::optional<JointPart> joint_part(std::size_t index) const {
        const auto& what = plan_.textures[index].what;
        if (const auto* reference = std::get_if<ReferencePlan>(&what)) {
            if (!is_joint(*reference)) return std::nullopt;
            return JointPart{.reference = reference};
        }
        if (const auto* given = std::get_if<GivenPlan>(&what)) {
            if (given->texture->kind() != "constant") return std::nullopt;
            return JointPart{.color = ranges_[index].least};
        }
        if (const auto* map = std::get_if<PixelMapPlan>(&what)) return joint_part(*map);
        JointPart whole;
        for (const std::size_t part : std::get<LayersPlan>(what).textures) {
            auto of = joint_part(part);
            if (!of) return std::nullopt;
            whole.parts.push_back(std::move(*of));
        }
        return whole;
    }
    std::optional<JointPart> joint_part(const PixelMapPlan& plan) const {
        if (!is_joint(*plan.map)) return std::nullopt;
        JointPart whole{.map = plan.map.get()};
        const std::vector<bool> shown = shown_families(plan);
        for (std::size_t family = 0; family < shown.size(); ++family) {
            auto part = shown[family] ? joint_part(plan.textures[family]) : JointPart{};
            if (!part) return std::nullopt;
            whole.parts.push_back(std::move(*part));
        }
        return whole;
    }
    static std::vector<bool> shown_families(const PixelMapPlan& plan) {
        std::vector<bool> shown(plan.textures.size());
        for (const std::int32_t family : possible_values(*plan.map))
            shown[static_cast<std::size_t>(family)] = true;
        return shown;
    }

    /// One typed texture of all parts; null where they have no cells in common, or too many different ones.
    std::shared_ptr<const Texture> joint(const JointPart& whole) {
        const auto grid = joint_grid(whole);
        if (!grid) return nullptr;
        return kept_.texture("joint " + key_of(whole), [&]() -> std::shared_ptr<const Texture> {
            auto types = make_joint_types(*grid, whole);
            return types ? make_typed_texture(*grid, std::move(types)) : nullptr;
        });
    }

    const Plan& plan_;
    PatternKept& kept_;
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

std::shared_ptr<const Texture> make_pattern_texture(const Plan& plan, PatternKept* kept) {
    PatternKept none;
    PatternKept& keeper = kept != nullptr ? *kept : none;
    auto texture = Compiler{plan, keeper}.texture(plan.textures.size() - 1);
    keeper.next_round();
    return texture;
}

std::size_t pattern_bytes(const Plan& plan) {
    std::uint64_t total = 0;
    for (const PlannedTexture& texture : plan.textures) {
        std::uint64_t bytes = 0;
        if (const auto* reference = std::get_if<ReferencePlan>(&texture.what))
            bytes = bytes_of(*reference);
        else if (const auto* map = std::get_if<PixelMapPlan>(&texture.what))
            bytes = map->map->values.size() * 6 +
                    ((is_joint(*map->map) ? std::uint64_t{48} : std::uint64_t{1}) << 20);
        else if (const auto* layers = std::get_if<LayersPlan>(&texture.what))
            bytes = layers->textures.size() > 1 ? std::uint64_t{64} << 20 : 0;
        if (bytes > std::numeric_limits<std::uint64_t>::max() - total)
            return std::numeric_limits<std::size_t>::max();
        total += bytes;
    }
    return static_cast<std::size_t>(total);
}

}  // namespace tessera
