#include "server/pattern/texel_range.h"

#include <algorithm>
#include <optional>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// Images of instances are kept in steps of 1/65535: so much may they leave their patterns' range.
constexpr float rounding = 2e-5F;
/// Combinations of a map's states that are looked at one by one.
constexpr std::size_t most_combinations = 4096;

/// The patterns that cells can show, and whether a cell may show none.
struct ShownPatterns {
    std::vector<bool> patterns;
    bool blank = false;

    void add(std::int32_t pattern) {
        if (pattern < 0)
            blank = true;
        else
            patterns[static_cast<std::size_t>(pattern)] = true;
    }
    void add(const std::vector<LookShare>& shares) {
        for (const LookShare& share : shares)
            if (share.share > 0) add(share.pattern);
    }
};

ShownPatterns shown_patterns(const ReferencePlan& plan) {
    const CellProgram& program = *plan.program;
    ShownPatterns shown{std::vector<bool>(static_cast<std::size_t>(plan.patterns->count)), false};
    switch (program.basis()) {
        case CellProgram::Basis::constant:
            shown.add(program.look_of_type(0).pattern);
            return shown;
        case CellProgram::Basis::typed:
            for (std::uint32_t type = 0; type < plan.grid.quadtree->types(); ++type)
                shown.add(program.look_of_type(static_cast<std::uint16_t>(type)).pattern);
            return shown;
        case CellProgram::Basis::stationary:
            shown.add(program.shares({}));
            return shown;
        case CellProgram::Basis::varying: {
            const std::optional<VaryingMap> map = program.varying();
            if (!map || map->map == nullptr) break;
            const std::vector<std::int32_t> states = possible_values(*map->map);
            const std::size_t corners = map->corners ? 4 : 1;
            std::size_t combinations = 1;
            for (std::size_t k = 0; k < corners; ++k)
                combinations = std::min(combinations * states.size(), most_combinations + 1);
            if (combinations > most_combinations) break;
            for (std::size_t k = 0; k < combinations; ++k) {
                std::array<std::int32_t, 4> corner{};
                for (std::size_t c = 0, rest = k; c < corners; ++c, rest /= states.size())
                    corner[c] = states[rest % states.size()];
                shown.add(program.shares(std::span{corner}.first(corners)));
            }
            return shown;
        }
        case CellProgram::Basis::other:
            break;
    }
    shown.patterns.assign(shown.patterns.size(), true);
    shown.blank = true;
    return shown;
}

/// A constant tells its colour; a prepared photograph is opaque.
TexelRange range_of(const GivenPlan& plan) {
    TexelRange range;
    if (plan.texture->kind() == "constant") {
        LinearImage texel;
        if (!plan.texture->evaluate(TexelRegion{.width = 1, .height = 1}, Budget{}, texel)) return range;
        for (std::size_t c = 0; c < 4; ++c) {
            range.least[c] = range.most[c] = texel.values[c];
            if (texel.values[3] > 0)
                range.straight_least[c] = range.straight_most[c] =
                    c == 3 ? 1 : std::min(texel.values[c] / texel.values[3], 1.0F);
        }
    } else if (plan.texture->kind() == "content_exchange" || plan.texture->kind() == "interchange" ||
               plan.texture->kind() == "wang") {
        range.least[3] = 1;
    }
    return range;
}

}  // namespace

/// The composite a·u + (1 − a)·C, u the straight colour above, is linear in each: its extremes are at ends of
/// their ranges.
TexelRange range_over(const TexelRange& upper, const TexelRange& lower) noexcept {
    TexelRange range = range_of_either(upper, lower);
    for (std::size_t c = 0; c < 4; ++c) {
        const auto at = [&](float alpha, float straight, float below) {
            return alpha * straight + (1 - alpha) * below;
        };
        range.least[c] = std::min(at(upper.least[3], upper.straight_least[c], lower.least[c]),
                                  at(upper.most[3], upper.straight_least[c], lower.least[c]));
        range.most[c] = std::max(at(upper.least[3], upper.straight_most[c], lower.most[c]),
                                 at(upper.most[3], upper.straight_most[c], lower.most[c]));
    }
    return range;
}

TexelRange range_of_either(const TexelRange& a, const TexelRange& b) noexcept {
    if (a.transparent() && b.transparent()) return a;
    TexelRange range;
    for (std::size_t c = 0; c < 4; ++c) {
        range.least[c] = std::min(a.least[c], b.least[c]);
        range.most[c] = std::max(a.most[c], b.most[c]);
        // A transparent texture has no straight colour
        const TexelRange& first = a.transparent() ? b : a;
        const TexelRange& second = b.transparent() ? a : b;
        range.straight_least[c] = std::min(first.straight_least[c], second.straight_least[c]);
        range.straight_most[c] = std::max(first.straight_most[c], second.straight_most[c]);
    }
    return range;
}

TexelRange texel_range(const ReferencePlan& plan) {
    const PatternImages& patterns = *plan.patterns;
    const ShownPatterns shown = shown_patterns(plan);
    TexelRange range{.least = {1, 1, 1, 1},
                     .most = {0, 0, 0, 0},
                     .straight_least = {1, 1, 1, 1},
                     .straight_most = {0, 0, 0, 1}};
    const std::size_t image = static_cast<std::size_t>(patterns.side) *
                              static_cast<std::size_t>(patterns.side) *
                              static_cast<std::size_t>(patterns.slices) * 4;
    for (std::size_t pattern = 0; pattern < shown.patterns.size(); ++pattern) {
        if (!shown.patterns[pattern]) continue;
        const std::uint8_t* code = patterns.codes.data() + pattern * image;
        for (const std::uint8_t* end = code + image; code != end; code += 4) {
            const float alpha = static_cast<float>(code[3]) / 255.0F;
            for (std::size_t c = 0; c < 4; ++c) {
                const float straight = c == 3 ? 1.0F : from_srgb(code[c]);
                range.least[c] = std::min(range.least[c], straight * alpha);
                range.most[c] = std::max(range.most[c], straight * alpha);
                if (code[3] == 0) continue;
                range.straight_least[c] = std::min(range.straight_least[c], straight);
                range.straight_most[c] = std::max(range.straight_most[c], straight);
            }
        }
    }
    const bool room = plan.transform != nullptr || plan.grid.cell_slices > patterns.slices;
    if (shown.blank || room) range.least = {0, 0, 0, 0};
    if (plan.transform != nullptr && range.most[3] > 0)
        for (std::size_t c = 0; c < 3; ++c) {
            range.most[c] = std::min(range.most[c] + rounding, 1.0F);
            range.straight_least[c] = std::max(range.straight_least[c] - rounding, 0.0F);
            range.straight_most[c] = std::min(range.straight_most[c] + rounding, 1.0F);
        }
    // Where instances hang over each other, a texel may be more than any one of them
    if (plan.transform != nullptr && plan.transform->overflow && range.most[3] > 0) {
        range.most = range.straight_most;
        range.most[3] = 1;
    }
    return range;
}

std::vector<TexelRange> texel_ranges(const Plan& plan) {
    std::vector<TexelRange> ranges;
    for (const PlannedTexture& texture : plan.textures) {
        if (const auto* reference = std::get_if<ReferencePlan>(&texture.what)) {
            ranges.push_back(texel_range(*reference));
        } else if (const auto* given = std::get_if<GivenPlan>(&texture.what)) {
            ranges.push_back(range_of(*given));
        } else if (const auto* layers = std::get_if<LayersPlan>(&texture.what)) {
            TexelRange range = ranges[layers->textures.front()];
            for (std::size_t k = 1; k < layers->textures.size(); ++k)
                range = range_over(ranges[layers->textures[k]], range);
            ranges.push_back(range);
        } else {
            const auto& map = std::get<PixelMapPlan>(texture.what);
            TexelRange range = ranges[map.textures.front()];
            for (const std::size_t part : map.textures) range = range_of_either(range, ranges[part]);
            ranges.push_back(range);
        }
    }
    return ranges;
}

}  // namespace tessera
