#include "server/pattern/draw_law.h"

#include <algorithm>
#include <bit>

#include "server/texture/exchange.h"

namespace tessera {
namespace {

/// After how many cells or texels, as a power of two, a map repeats.
std::optional<int> period_of(const StoredMap& map) {
    const auto width = static_cast<std::uint32_t>(map.width), height = static_cast<std::uint32_t>(map.height);
    if (map.edge != StoredMap::Edge::wrap || !std::has_single_bit(width) || !std::has_single_bit(height))
        return std::nullopt;
    return map.cells_log2 + std::countr_zero(std::max(width, height));
}

std::optional<DrawLaw> law_of(const GivenPlan& plan) {
    if (plan.texture->kind() == "constant") return DrawLaw{};
    const auto* exchange = dynamic_cast<const ExchangeTexture*>(plan.texture.get());
    const auto unit = exchange != nullptr ? exchange->unit_level() : std::nullopt;
    if (!unit) return std::nullopt;
    return DrawLaw{*unit, *unit};
}

}  // namespace

std::optional<DrawLaw> draw_law(const ReferencePlan& plan) {
    const CellProgram& program = *plan.program;
    if (program.moves() || plan.grid.cell_slices > 0 || plan.patterns->slices > 1) return std::nullopt;
    DrawLaw law{plan.grid.cell_log2, plan.grid.cell_log2};
    switch (program.basis()) {
        case CellProgram::Basis::constant:
        case CellProgram::Basis::typed:
        case CellProgram::Basis::stationary:
            return law;
        case CellProgram::Basis::varying: {
            const auto varying = program.varying();
            const auto period = varying ? period_of(*varying->map) : std::nullopt;
            if (!period) return std::nullopt;
            law.period_log2 += *period;
            return law;
        }
        case CellProgram::Basis::other:
            break;
    }
    return std::nullopt;
}

std::optional<DrawLaw> draw_law(const Plan& plan, std::size_t texture) {
    const auto& what = plan.textures[texture].what;
    if (const auto* reference = std::get_if<ReferencePlan>(&what)) return draw_law(*reference);
    if (const auto* given = std::get_if<GivenPlan>(&what)) return law_of(*given);
    DrawLaw whole;
    const auto* map = std::get_if<PixelMapPlan>(&what);
    if (map != nullptr) {
        const auto period = period_of(*map->map);
        if (!period) return std::nullopt;
        whole.period_log2 = *period;
    }
    for (const std::size_t part : map != nullptr ? map->textures : std::get<LayersPlan>(what).textures) {
        const auto law = draw_law(plan, part);
        if (!law) return std::nullopt;
        whole.cell_log2 = std::max(whole.cell_log2, law->cell_log2);
        whole.period_log2 = std::max(whole.period_log2, law->period_log2);
    }
    whole.period_log2 = std::max(whole.period_log2, whole.cell_log2);
    return whole;
}

}  // namespace tessera
