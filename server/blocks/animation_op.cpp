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

bool is_endless(const Cycle& cycle) noexcept { return cycle.rest >= endless_rest; }

/// Of so few steps each is looked at.
constexpr std::int64_t few_steps = 8;

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

struct AnimationOp::GivenCycles {
    const AnimationOp& of;
    const std::int32_t* const* in;
    std::int32_t i;
    Cycle operator()(std::size_t setting) const noexcept { return of.cycle_of(of.settings_[setting], in, i); }
};

struct AnimationOp::ToldCycles {
    std::int64_t phase;
    std::span<const std::int64_t> rests;
    Cycle operator()(std::size_t setting) const noexcept { return {phase, rests[setting]}; }
};

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

AnimationOp::Followed AnimationOp::followed_at(Step step) const noexcept {
    const Settled settled = settled_at(step);
    if (settled.setting < 0) {
        const std::size_t change = change_at(changes_, step);
        return {change - 1, change, settled.holds};
    }
    const auto setting = static_cast<std::size_t>(settled.setting);
    return {setting, setting, settled.holds};
}

AnimationOp::Followed AnimationOp::looked_at(Step step) const noexcept {
    const std::size_t change = change_at(changes_, step);
    Followed looked{change, change, {}};
    if (change < changes_.size()) looked.holds.until = changes_[change] + 1;
    if (change == 0) return looked;
    // The old cycle is over after one run, at the latest
    const Step begun = changes_[change - 1], over = add_steps(begun, frames_->line.run());
    if (step > over) {
        looked.holds.from = over + 1;
        return looked;
    }
    if (step == begun) return {change - 1, change - 1, {begun, begun + 1}};
    return {change - 1, change, {begun + 1, std::min(over + 1, looked.holds.until)}};
}

void AnimationOp::run(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const {
    if (stretch.probe != nullptr) return answer(*stretch.probe, stretch, in, out);
    if (stretch.scattered != nullptr) return scatter(stretch, in, out);
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
    // What lasts until after a change is worked out cell by cell, if anyone asks how long
    const Validity& asked = *stretch.validity;
    const bool settled_throughout = settled.holds.from <= asked.from && asked.until <= settled.holds.until;
    validity.meet(asked);
    if (settled_throughout || (validity.from > settled.holds.from && validity.until < settled.holds.until))
        *stretch.validity = validity;
    else if (!is_one_step(*stretch.validity))
        pass(stretch, in, out);
}

/// Whether a cell shows its first frame in all of these steps, whatever setting it follows; no, if that takes
/// long to tell.
template <class CycleUnder>
bool AnimationOp::rests_within(const CycleUnder& cycle_under, const Validity& steps) const noexcept {
    const TimeLine& line = frames_->line;
    const std::size_t end = change_at(changes_, steps.until - 1) + 1;
    for (std::size_t setting = change_at(changes_, steps.from); setting < end; ++setting) {
        const Cycle now = cycle_under(setting);
        const Validity part{
            setting == 0 ? steps.from : std::max(steps.from, changes_[setting - 1]),
            setting < changes_.size() ? std::min(steps.until, changes_[setting]) : steps.until};
        if (setting == 0 ? !rests_through(line, now, part)
                         : !rests_through(line, cycle_under(setting - 1), now, changes_[setting - 1], part))
            return false;
    }
    return true;
}

/// shown_in() of so few steps that each is looked at.
template <class CycleUnder>
Shown AnimationOp::shown_in_few(const CycleUnder& cycle_under, Step step,
                                const Validity& within) const noexcept {
    const auto frame_in = [&](Step at) {
        const std::size_t setting = change_at(changes_, at);
        const Cycle now = cycle_under(setting);
        if (setting == 0) return frames_->line.frame_at(position_at(frames_->line, now, at));
        return frame_at(frames_->line, cycle_under(setting - 1), now, changes_[setting - 1], at);
    };
    Shown shown{frame_in(step), {step, step + 1}};
    while (shown.validity.until < within.until && frame_in(shown.validity.until) == shown.frame)
        ++shown.validity.until;
    while (shown.validity.from > within.from && frame_in(shown.validity.from - 1) == shown.frame)
        --shown.validity.from;
    return shown;
}

/// At any step, of a cell that knows of all settings; right as far as it lies `within`, which holds then.
template <class CycleUnder>
Shown AnimationOp::shown_in(const CycleUnder& cycle_under, Step step, const Validity& within) const noexcept {
    // Two settings decide the frame; where it changes next and changed last, nearly always two more
    const std::size_t change = change_at(changes_, step), first = change_at(changes_, within.from),
                      end = change_at(changes_, within.until - 1) + 1;
    const std::size_t from = first < 1 ? 0 : first - 1;
    if (rests_within(cycle_under, within)) return {};
    if (add_steps(within.from, few_steps) >= within.until) return shown_in_few(cycle_under, step, within);
    const std::size_t near_from = std::max(from, change < 2 ? 0 : change - 2),
                      near_end = std::min(change + 3, end);
    const std::span<const Step> changes{changes_};
    const auto shown = [&](std::size_t begin, std::size_t stop, std::span<Cycle> cycles) {
        for (std::size_t setting = begin; setting < stop; ++setting)
            cycles[setting - begin] = cycle_under(setting);
        const std::span<const Cycle> some = cycles.first(stop - begin);
        return shown_at(frames_->line, some, changes.subspan(begin, stop - begin - 1), step);
    };
    std::array<Cycle, 5> near;
    const Shown is = shown(near_from, near_end, near);
    // What lasts into settings further off
    if ((near_from > from &&
         is.validity.from <= add_steps(changes_[near_from - 1], steps_between_changes(frames_->line))) ||
        (near_end < end && is.validity.until > changes_[near_end - 1])) {
        std::array<Cycle, max_settings> all;
        return shown(from, end, all);
    }
    return is;
}

/// The same, where it is known what cells follow at `step`: nearly always that lasts for as long as is asked.
template <class CycleUnder>
Shown AnimationOp::shown_in(const CycleUnder& cycle_under, Step step, const Validity& within,
                            const Followed& followed) const noexcept {
    const auto& [first, last, holds] = followed;
    if (holds.from > within.from || holds.until < within.until) return shown_in(cycle_under, step, within);
    const TimeLine& line = frames_->line;
    const Cycle now = cycle_under(last);
    if (first == last) {
        if (is_one_step(within)) return {frames_->line.frame_at(position_at(line, now, step)), within};
        if (rests_through(line, now, within)) return {};
        return shown_at(line, now, step);
    }
    const std::array cycles{cycle_under(first), now};
    if (rests_through(line, cycles[0], now, changes_[first], within)) return {};
    if (is_one_step(within)) return {frame_at(line, cycles[0], cycles[1], changes_[first], step), within};
    return shown_at(line, cycles, std::span{changes_}.subspan(first, 1), step);
}

Shown AnimationOp::shown_within(std::int64_t phase, std::span<const std::int64_t> rests, Step step,
                                const Validity& within, Followed& followed) const noexcept {
    if (!followed.holds.holds(step)) followed = followed_at(step);
    return shown_in(ToldCycles{phase, rests}, step, within, followed);
}

bool AnimationOp::rests_within(std::int64_t phase, std::span<const std::int64_t> rests, Step step,
                               const Validity& within, Followed& followed) const noexcept {
    if (!followed.holds.holds(step)) followed = followed_at(step);
    const auto& [first, last, holds] = followed;
    if (holds.from > within.from || holds.until < within.until)
        return rests_within(ToldCycles{phase, rests}, within);
    const Cycle now{phase, rests[last]};
    if (first == last) return rests_through(frames_->line, now, within);
    return rests_through(frames_->line, {phase, rests[first]}, now, changes_[first], within);
}

/// Any step, of cells that know of all settings.
void AnimationOp::pass(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const {
    std::array<Cycle, max_settings> cycles;
    const std::size_t change = change_at(changes_, stretch.step);
    const std::size_t from = change < 1 ? 0 : change - 1;
    const std::span<const Step> changes{changes_};
    const Followed followed = followed_at(stretch.step);
    for (std::int32_t i = 0; i < stretch.count; ++i) {
        if (stretch.validity == nullptr || is_one_step(*stretch.validity)) {
            for (std::size_t setting = from; setting <= change; ++setting)
                cycles[setting] = cycle_of(settings_[setting], in, i);
            const std::span<const Cycle> both = std::span{cycles}.subspan(from, change - from + 1);
            const std::int32_t frame =
                std::all_of(both.begin(), both.end(), is_endless)
                    ? 0
                    : frame_at(frames_->line, both, changes.subspan(from, change - from), stretch.step);
            out[i] = frames_->patterns[static_cast<std::size_t>(frame)];
            continue;
        }
        const Shown is = shown_in(GivenCycles{*this, in, i}, stretch.step, *stretch.validity, followed);
        stretch.validity->meet(is.validity);
        out[i] = frames_->patterns[static_cast<std::size_t>(is.frame)];
    }
}

/// Each cell at its own step.
void AnimationOp::scatter(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const {
    Followed followed{0, 0, {0, 0}};
    for (std::int32_t i = 0; i < stretch.count; ++i) {
        const CellAt& cell = stretch.scattered[i];
        if (!followed.holds.holds(cell.step)) followed = followed_at(cell.step);
        const Shown is = shown_in(GivenCycles{*this, in, i}, cell.step, cell.within, followed);
        if (frames_->line.frames() > 1) stretch.frames[i].meet(is.validity);
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
