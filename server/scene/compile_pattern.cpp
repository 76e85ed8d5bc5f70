#include "server/scene/compile_pattern.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "proto/pattern.pb.h"

#include "server/pattern/pattern_texture.h"
#include "server/pattern/targeted_texture.h"
#include "server/scene/pattern_files.h"
#include "server/scene/scene.h"

namespace tessera {
namespace {

std::string_view name_of(Rate rate) {
    switch (rate) {
        case Rate::scene:
            return "scene";
        case Rate::step:
            return "step";
        case Rate::cell:
            return "cell";
        case Rate::texel:
            break;
    }
    return "texel";
}

/// Columns wide enough for what is in them: name, kind, rate, note.
std::string to_text(const std::vector<PlanLine>& lines) {
    std::size_t names = 0, kinds = 0;
    for (const PlanLine& line : lines) {
        names = std::max(names, line.name.size());
        kinds = std::max(kinds, line.kind.size());
    }
    std::string text;
    for (const PlanLine& line : lines) {
        std::string row = "  " + line.name + std::string(names - line.name.size() + 2, ' ');
        row.append(line.kind).append(kinds - line.kind.size() + 2, ' ');
        // What is dropped never runs
        const std::string_view rate = line.dropped ? "-" : name_of(line.rate);
        row.append(rate);
        if (!line.note.empty()) row.append(std::max<std::size_t>(7, rate.size() + 1) - rate.size(), ' ');
        text += row + line.note + '\n';
    }
    return text;
}

/// After how many slices a texture is the same again: 1 if all its slices are, 0 if that never comes.
std::int32_t period_of(const PlannedTexture& texture) {
    const auto* cells = std::get_if<ReferencePlan>(&texture.what);
    if (cells == nullptr) return 1;
    if (cells->grid.cell_slices == 0) return cells->patterns->slices;
    return cells->program->basis() == CellProgram::Basis::constant ? cells->grid.cell_slices : 0;
}

std::int32_t slices_of(const Plan& plan) {
    std::int64_t slices = 1;
    for (const PlannedTexture& texture : plan.textures) {
        const std::int32_t period = period_of(texture);
        if (period == 0) return 0;
        slices = std::lcm(slices, std::int64_t{period});
        if (slices > (1 << 24)) return 0;
    }
    return static_cast<std::int32_t>(slices);
}

}  // namespace

Result<Plan> plan_pattern(const proto::Pattern& message, BlockFiles& files) {
    auto plan = compile_plan(message, files);
    if (!plan) return plan.error();
    if (const std::size_t bytes = pattern_bytes(*plan); bytes > max_pattern_bytes)
        return Error{ErrorCode::invalid_input,
                     "pattern: its blocks would take about " + std::to_string(bytes >> 20) +
                         " MiB, more than " + std::to_string(max_pattern_bytes >> 20) +
                         "; use smaller or fewer patterns and maps, or fewer types, turns and scales"};
    return plan;
}

Result<void> compile_pattern(BlockFiles& files, PatternKept* kept, const std::filesystem::path& file,
                             const proto::Pattern& message, std::span<const MovingTarget> targets,
                             Scene& scene) {
    const auto plan = plan_pattern(message, files);
    if (!plan) return Error{plan.error().code, file.string() + ": " + plan.error().detail};
    scene.texture = make_targeted_texture(make_pattern_texture(*plan, kept), *plan, targets);
    scene.editable_maps = std::make_shared<const std::vector<EditableMap>>(plan->maps);
    scene.slices = slices_of(*plan);
    scene.clocked =
        std::any_of(plan->textures.begin(), plan->textures.end(), [](const PlannedTexture& texture) {
            const auto* cells = std::get_if<ReferencePlan>(&texture.what);
            return cells != nullptr && cells->program->clocked();
        });
    scene.animated = scene.clocked || moved_by_targets(*scene.texture);
    scene.parameters = plan->parameters;
    scene.block_list = to_text(plan->lines);
    return {};
}

}  // namespace tessera
