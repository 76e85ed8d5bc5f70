#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/blocks/cell_op.h"
#include "shared/motion/transitions.h"

namespace tessera {

/// Frames of an animation: 3.4.
struct FrameLine {
    std::vector<std::int32_t> patterns;
    TimeLine line;
    std::int32_t least = 0, most = 0;
};

/// Steps of a field: a constant of any size, or what an input gives, rounded down.
struct AnimationSteps {
    std::int64_t constant = 0;
    int input = -1;       ///< Of the op, if it is no constant.
    int number_log2 = 0;  ///< The input is in steps of 2^-number_log2.
    bool operator==(const AnimationSteps&) const = default;
};

/// The parameters φ, Z and a until they change.
struct AnimationSetting {
    AnimationSteps phase, rest;  ///< A constant rest is a·Z already.
    std::uint64_t density = 65536;
    bool operator==(const AnimationSetting&) const = default;
};

/// Animation Map (3.4), with its temporal transitions: see shared/motion.
class AnimationOp final : public CellOp {
  public:
    /// One setting more than `changes`.
    AnimationOp(std::shared_ptr<const FrameLine> frames, std::vector<AnimationSetting> settings,
                std::vector<Step> changes)
        : frames_{std::move(frames)}, settings_{std::move(settings)}, changes_{std::move(changes)} {}

    void run(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const override;

    const FrameLine& frames() const noexcept { return *frames_; }
    std::span<const AnimationSetting> settings() const noexcept { return settings_; }

    /// The setting that all cells follow at `step`, and in which steps they do; none while they pass from one
    /// to the next.
    struct Settled {
        int setting = -1;
        Validity holds{};
    };
    Settled settled_at(Step step) const noexcept;
    /// The settings, from the first to the last, that any cell follows at `step`, and in which steps so.
    struct Followed {
        std::size_t first = 0, last = 0;
        Validity holds{};
    };
    Followed followed_at(Step step) const noexcept;
    /// The settings, from the first to the last, of whose looks any cell shows one at `step`. A cell that
    /// still waits for the new cycle to begin shows the first frame, which is among what it shows then.
    Followed looked_at(Step step) const noexcept;

    /// What a cell shows at a step, right as far as it lies `within`, which holds then. `phase`: under all
    /// settings; `rests`: a·Z under each. `followed`: what was at the step asked for before, and what is now.
    Shown shown_within(std::int64_t phase, std::span<const std::int64_t> rests, Step step,
                       const Validity& within, Followed& followed) const noexcept;

    /// Whether it is known to show the first frame in all steps `within`: told sooner.
    bool rests_within(std::int64_t phase, std::span<const std::int64_t> rests, Step step,
                      const Validity& within, Followed& followed) const noexcept;

  private:
    /// A cell's cycle under a setting: of what inputs give, or told.
    struct GivenCycles;
    struct ToldCycles;
    Cycle cycle_of(const AnimationSetting& setting, const std::int32_t* const* in,
                   std::int32_t i) const noexcept;
    void answer(const AnimationProbe& probe, const Stretch& stretch, const std::int32_t* const* in,
                std::int32_t* out) const;
    template <class CycleUnder>
    bool rests_within(const CycleUnder& cycle_under, const Validity& steps) const noexcept;
    template <class CycleUnder>
    Shown shown_in_few(const CycleUnder& cycle_under, Step step, const Validity& within) const noexcept;
    template <class CycleUnder>
    Shown shown_in(const CycleUnder& cycle_under, Step step, const Validity& within) const noexcept;
    template <class CycleUnder>
    Shown shown_in(const CycleUnder& cycle_under, Step step, const Validity& within,
                   const Followed& followed) const noexcept;
    void scatter(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const;
    void pass(const Stretch& stretch, const std::int32_t* const* in, std::int32_t* out) const;

    std::shared_ptr<const FrameLine> frames_;
    std::vector<AnimationSetting> settings_;
    std::vector<Step> changes_;
};

}  // namespace tessera
