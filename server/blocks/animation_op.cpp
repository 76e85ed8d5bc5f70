#include "server/blocks/animation_op.h"

#include <algorithm>
#include <array>

#include "shared/motion/cycle_place.h"

namespace tessera {

namespace {

__extension__ using Wide = __int128;

constexpr std::size_t max_settings = 65;

/// Whether nothing can narrow it any more.
bool is_one_step(const Validity& validity) noexcept { return validity.until - 1 == validity.from; }

}  // namespace

Cycle AnimationOp::cycle_of(const AnimationSetting& setting, const std::int32_t* const* in,
                            std::int32_t i) const noexcept {
    const auto& [phase, rest, density] = setting;
    Cycle cycle{phase.constant, rest.constant};
    if (phase.input >= 0) cycle.phase = in[phase.input][i] >> phase.number_log2;
    if (rest.input < 0) return cycle;
    const std::int32_t value = in[rest.input][i];
    if (value < 0 || (value > 0 && density >= endless_density))
        cycle.rest = endless_rest;
    else
        cycle.rest = static_cast<std::int64_t>(std::min<Wide>(
            Wide{value} * static_cast<std::int64_t>(density) >> (16 + rest.number_log2), endless_rest));
    return cycle;
}

AnimationOp::Settled AnimationOp::settled_at(Step step) const noexcept {
    const std::size_t change = change_at(changes_, step);
    Settled settled{static_cast<int>(change), {}};
    if (change > 0)
        settled.holds.from = add_steps(changes_[change - 1], steps_between_changes(frames_->line));
    // At the very step of the next change cells still follow this setting
    if (change < changes_.size()) settled.holds.until = changes_[change] + 1;
    if (step < settled.holds.from) return {-1, {changes_[change - 1] + 1, settled.holds.from}};
    return settled;
}

void AnimationOp::run(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const {
    if (stretch.probe != nullptr) return answer(*stretch.probe, stretch, in, out);
    const Settled settled = settled_at(stretch.step);
    if (settled.setting < 0) return pass(stretch, in, out);
    const AnimationSetting& setting = settings_[static_cast<std::size_t>(settled.setting)];
    const TimeLine& line = frames_->line;
    const std::int32_t* patterns = frames_->patterns.data();
    // Of cells at rest, the fewest steps since one began and until one ends, here and below; others are few
    std::int64_t since = endless_rest, left = endless_rest;
    for (std::int32_t i = 0; i < stretch.count; ++i) {
        const Cycle cycle = cycle_of(setting, in, i);
        std::int32_t frame = 0;
        if (cycle.rest < endless_rest) {
            const auto [at, before] = place_at(line, cycle, stretch.step);
            std::int64_t begin = 0, end = before + 1;
            if (at > before) {
                frame = line.frame_at(at - before);
                begin = before + line.begin_of(frame);
                end = before + line.end_of(frame);
            }
            since = std::min(since, at - begin);
            left = std::min(left, end - at);
        }
        out[i] = patterns[frame];
    }
    if (stretch.validity == nullptr || line.frames() == 1) return;
    Validity validity;
    if (since < endless_rest) validity = {add_steps(stretch.step, -since), add_steps(stretch.step, left)};
    // What lasts until after a change is worked out cell by cell
    if (changes_.empty() || (validity.from > settled.holds.from && validity.until < settled.holds.until))
        stretch.validity->meet(validity);
    else if (!is_one_step(*stretch.validity))
        pass(stretch, in, out);
}

/// Any step, of cells that know of all settings.
void AnimationOp::pass(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const {
    std::array<Cycle, max_settings> cycles;
    const auto endless = [](const Cycle& cycle) { return cycle.rest >= endless_rest; };
    // Two settings decide the frame; where it changes next and changed last, nearly always two more
    const std::size_t change = change_at(changes_, stretch.step);
    const std::size_t from = change < 1 ? 0 : change - 1;
    const std::size_t near_from = change < 2 ? 0 : change - 2,
                      near_end = std::min(change + 3, settings_.size());
    const std::span<const Step> changes{changes_};
    const auto shown = [&](std::size_t first, std::size_t end, std::int32_t i) {
        for (std::size_t setting = first; setting < end; ++setting)
            cycles[setting] = cycle_of(settings_[setting], in, i);
        const std::span<const Cycle> some = std::span{cycles}.subspan(first, end - first);
        if (std::all_of(some.begin(), some.end(), endless)) return Shown{};
        return shown_at(frames_->line, some, changes.subspan(first, end - first - 1), stretch.step);
    };
    for (std::int32_t i = 0; i < stretch.count; ++i) {
        if (stretch.validity == nullptr || is_one_step(*stretch.validity)) {
            for (std::size_t setting = from; setting <= change; ++setting)
                cycles[setting] = cycle_of(settings_[setting], in, i);
            const std::span<const Cycle> both = std::span{cycles}.subspan(from, change - from + 1);
            const std::int32_t frame =
                std::all_of(both.begin(), both.end(), endless)
                    ? 0
                    : frame_at(frames_->line, both, changes.subspan(from, change - from), stretch.step);
            out[i] = frames_->patterns[static_cast<std::size_t>(frame)];
            continue;
        }
        Shown is = shown(near_from, near_end, i);
        // What lasts into settings further off
        if ((near_from > 0 &&
             is.validity.from <= add_steps(changes_[near_from - 1], steps_between_changes(frames_->line))) ||
            (near_end < settings_.size() && is.validity.until > changes_[near_end - 1]))
            is = shown(0, settings_.size(), i);
        stretch.validity->meet(is.validity);
        out[i] = frames_->patterns[static_cast<std::size_t>(is.frame)];
    }
}

void AnimationOp::answer(const AnimationProbe& probe, const Stretch& stretch, const std::int32_t* const* in,
                         std::int32_t* out) const {
    const TimeLine& line = frames_->line;
    const auto shown = static_cast<double>(line.end_of(probe.frame) - line.begin_of(probe.frame));
    for (std::int32_t i = 0; i < stretch.count; ++i) {
        const Cycle cycle = cycle_of(settings_[probe.setting], in, i);
        out[i] = frames_->patterns[static_cast<std::size_t>(probe.frame)];
        if (probe.cycles != nullptr) probe.cycles[i] = cycle;
        if (probe.shares == nullptr) continue;
        const bool moves = cycle.rest < endless_rest;
        const auto rest = static_cast<double>(cycle.rest + line.lead());
        if (probe.frame == 0)
            probe.shares[i] *= moves ? (rest + shown) / (rest + static_cast<double>(line.run())) : 1.0;
        else
            probe.shares[i] *= moves ? shown / (rest + static_cast<double>(line.run())) : 0.0;
    }
}

}  // namespace tessera
