// The animation law over millions of random cases: no frame ever jumps, and what it says of validity is what
// stepping finds. A failure prints the case that brings it back.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "shared/motion/evenness.h"
#include "shared/motion/targets.h"
#include "shared/motion/transitions.h"

namespace tessera {
namespace {

using Random = std::mt19937_64;

std::int64_t below(Random& random, std::int64_t count) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(count));
}

/// Whether a cell may go from one frame to another in a step.
bool flows(const TimeLine& line, std::int32_t from, std::int32_t to) {
    return to == from || to == from + 1 || (from == line.frames() - 1 && to == 0);
}

TimeLine random_line(Random& random) {
    std::vector<std::uint32_t> steps(static_cast<std::size_t>(1 + below(random, 9)));
    const bool even = below(random, 2) == 0;
    for (auto& step : steps) step = even ? 1 : static_cast<std::uint32_t>(1 + below(random, 4));
    return TimeLine{steps};
}

/// Mostly short, so that runs collide often; else of any size.
Cycle random_cycle(Random& random) {
    Cycle cycle{below(random, 60) - 30, below(random, 20)};
    switch (below(random, 12)) {
        case 0:
            cycle.rest = endless_rest;
            break;
        case 1:
            cycle = {below(random, 2'000'000'000), below(random, 1'000'000'000)};
            break;
        case 2:
            cycle.phase = static_cast<std::int64_t>(random());
            break;
        default:
            break;
    }
    return cycle;
}

Step random_step(Random& random) {
    switch (below(random, 4)) {
        case 0:
            return 1'000'000'000'000'000 + below(random, 1'000'000);
        case 1:
            return below(random, 2'000'000) - 1'000'000;
        default:
            return below(random, 100);
    }
}

/// A cell whose parameters change up to five times, as soon as they may or later.
struct Case {
    explicit Case(std::uint64_t seed) : random{seed}, line{random_line(random)} {
        first = random_step(random);
        ChangeTimes times{line};
        cycles.push_back(random_cycle(random));
        Step asked = first;
        for (std::int64_t left = below(random, 6); left > 0; --left) {
            asked += below(random, 3) == 0 ? below(random, 60) : below(random, 8);
            const Cycle cycle = random_cycle(random);
            const auto said = times.effect_of(asked);
            const auto effect = times.add(asked);
            same &= said.step == effect.step && said.replaces == effect.replaces;
            if (effect.replaces)
                cycles.back() = cycle;
            else
                cycles.push_back(cycle);
        }
        changes.assign(times.steps().begin(), times.steps().end());
        last = (changes.empty() ? first : changes.back()) + 3 * line.run() + 10;
    }

    Random random;
    TimeLine line;
    std::vector<Cycle> cycles;
    std::vector<Step> changes;
    Step first = 0, last = 0;
    bool same = true;
};

TEST(AnimationLaw, NeverJumps) {
    std::uint64_t steps = 0;
    for (std::uint64_t seed = 0; seed < 400'000; ++seed) {
        const Case c{seed};
        ASSERT_TRUE(c.same) << seed;
        std::int32_t last = frame_at(c.line, c.cycles, c.changes, c.first - 3);
        for (Step step = c.first - 2; step < c.last; ++step, ++steps) {
            const std::int32_t frame = frame_at(c.line, c.cycles, c.changes, step);
            ASSERT_TRUE(flows(c.line, last, frame))
                << "case " << seed << " goes from " << last << " to " << frame << " at step " << step;
            last = frame;
        }
        ASSERT_EQ(last, frame_at(c.line, std::span{c.cycles}.last(1), {}, c.last - 1))
            << "case " << seed << " does not come to its last parameters";
    }
    EXPECT_GT(steps, 10'000'000u);
}

TEST(AnimationLaw, IsThatOfThePaperBeforeAndAfterAChange) {
    __extension__ using Wide = __int128;
    for (std::uint64_t seed = 0; seed < 200'000; ++seed) {
        Random random{seed};
        const TimeLine line = random_line(random);
        const Cycle cycle = random_cycle(random);
        const Step step = random_step(random);
        const Wide rest = Wide{cycle.rest} + line.lead(), length = rest + line.run();
        Wide left = (Wide{step} + cycle.phase) % length;
        if (left < 0) left += length;
        const Wide position = cycle.rest == endless_rest || left < rest ? Wide{0} : left - rest;
        ASSERT_EQ(position_at(line, cycle, step), static_cast<std::int64_t>(position)) << "case " << seed;
    }
}

/// The rule as the paper has it, t_f = t0 − 1 for a cell at rest.
std::int32_t papers_frame(const TimeLine& line, const Cycle& from, const Cycle& to, Step at, Step step) {
    const std::int64_t n = line.run(), p = position_at(line, from, at);
    const Step t_f = p == 0 ? at - 1 : at + n - p;
    if (step <= t_f || step < at) return line.frame_at(position_at(line, from, step));
    const std::int64_t collides = position_at(line, to, t_f);
    if (collides != 0 && step < t_f + n - collides) return 0;
    return line.frame_at(position_at(line, to, step));
}

TEST(AnimationLaw, DepartsFromThePaperOnlyWhereThatJumps) {
    // The mend is needed (the paper's rule jumps in about one case of a hundred), and it is small: a cell
    // that does not rest at t0 shows just what the paper says
    int jumps = 0, cases = 0;
    for (std::uint64_t seed = 0; seed < 100'000; ++seed) {
        Random random{seed};
        const TimeLine line{std::vector<std::uint32_t>(static_cast<std::size_t>(2 + below(random, 7)), 1)};
        const Cycle from{below(random, 40), below(random, 20)}, to{from.phase, below(random, 20)};
        const Step at = below(random, 1000);
        bool jumped = false;
        std::int32_t last = papers_frame(line, from, to, at, at - 2);
        for (Step step = at - 1; step < at + 3 * line.run(); ++step) {
            const std::int32_t frame = papers_frame(line, from, to, at, step);
            jumped |= !flows(line, last, frame);
            last = frame;
            if (position_at(line, from, at) != 0) {
                ASSERT_EQ(frame_at(line, from, to, at, step), frame) << "case " << seed << ", step " << step;
            }
        }
        jumps += jumped ? 1 : 0;
        ++cases;
    }
    EXPECT_GT(jumps, cases / 400);
    EXPECT_LT(jumps, cases / 20);
}

TEST(Validity, IsWhatSteppingFinds) {
    std::uint64_t checked = 0;
    for (std::uint64_t seed = 0; seed < 60'000; ++seed) {
        Case c{seed};
        const Step step = c.first + below(c.random, c.last - c.first);
        const Shown shown = shown_at(c.line, c.cycles, c.changes, step);
        ASSERT_EQ(shown.frame, frame_at(c.line, c.cycles, c.changes, step)) << "case " << seed;
        ASSERT_TRUE(shown.validity.holds(step)) << "case " << seed;
        const Step until = std::min(shown.validity.until, c.last + 200);
        for (Step at = step; at < until; ++at, ++checked)
            ASSERT_EQ(frame_at(c.line, c.cycles, c.changes, at), shown.frame)
                << "case " << seed << ", step " << at;
        const Step from = std::max(shown.validity.from, c.first - 200);
        for (Step at = step; at >= from; --at, ++checked)
            ASSERT_EQ(frame_at(c.line, c.cycles, c.changes, at), shown.frame)
                << "case " << seed << ", step " << at;
        if (shown.validity.until != never) {
            ASSERT_NE(frame_at(c.line, c.cycles, c.changes, shown.validity.until), shown.frame)
                << "case " << seed;
        }
        if (shown.validity.from != always) {
            ASSERT_NE(frame_at(c.line, c.cycles, c.changes, shown.validity.from - 1), shown.frame)
                << "case " << seed;
        }
    }
    EXPECT_GT(checked, 1'000'000u);
}

TEST(Changes, TakeEffectNoLaterThanTheySay) {
    // From steps_between_changes() after a change on, a cell shows the new parameters only
    for (std::uint64_t seed = 0; seed < 200'000; ++seed) {
        Random random{seed};
        const TimeLine line = random_line(random);
        const Cycle from = random_cycle(random), to = random_cycle(random);
        const Step at = random_step(random);
        const Step settled = at + steps_between_changes(line);
        for (Step step = settled; step < settled + 8; ++step)
            ASSERT_EQ(frame_at(line, from, to, at, step), line.frame_at(position_at(line, to, step)))
                << "case " << seed << ", step " << step;
        ASSERT_EQ(frame_at(line, from, to, at, at), line.frame_at(position_at(line, from, at)));
    }
}

TEST(Evenness, IsNeverLessThanWhatAStepShows) {
    double least = 1, most = 0;
    for (std::uint64_t seed = 0; seed < 2'000; ++seed) {
        Random random{seed};
        const TimeLine line = random_line(random);
        const std::int64_t rest = below(random, 40);
        std::vector<WeightedPhase> phases(static_cast<std::size_t>(1 + below(random, 120)));
        const bool consecutive = below(random, 2) == 0;
        const std::int64_t first = below(random, 1000) - 500;
        for (std::size_t i = 0; i < phases.size(); ++i)
            phases[i] = {first + (consecutive ? static_cast<std::int64_t>(i) : below(random, 500)),
                         1.0 / static_cast<double>(phases.size())};
        const double stated = uneven_frames(line, rest, phases);
        const std::int64_t cycle = rest + line.lead() + line.run();
        for (Step step = 0; step < cycle; ++step) {
            std::vector<double> shares(static_cast<std::size_t>(line.frames()));
            for (const WeightedPhase& phase : phases)
                shares[static_cast<std::size_t>(
                    line.frame_at(position_at(line, {phase.phase, rest}, step)))] += phase.weight;
            double elsewhere = 0;
            for (std::int32_t frame = 0; frame < line.frames(); ++frame) {
                const std::int64_t shown =
                    line.end_of(frame) - line.begin_of(frame) + (frame == 0 ? rest + line.lead() : 0);
                elsewhere += std::abs(shares[static_cast<std::size_t>(frame)] -
                                      static_cast<double>(shown) / static_cast<double>(cycle)) /
                             2;
            }
            ASSERT_LE(elsewhere, stated + 1e-9) << "case " << seed << ", step " << step;
        }
        if (consecutive && phases.size() % static_cast<std::size_t>(cycle) == 0) {
            EXPECT_LT(stated, 1e-9);
        }
        least = std::min(least, stated);
        most = std::max(most, stated);
    }
    EXPECT_LT(least, 0.01);
    EXPECT_GT(most, 0.5);
}

TEST(Targets, ChangeWhereSteppingFinds) {
    std::uint64_t checked = 0;
    for (std::uint64_t seed = 0; seed < 3'000; ++seed) {
        Random random{seed};
        const TimeLine line = random_line(random);
        std::vector<MovingTarget> targets;
        for (std::int64_t left = 1 + below(random, 3); left > 0; --left) {
            std::vector<MovingTarget::Leg> legs(3);
            std::array<std::uint32_t, 3> steps{20, 1, 43};
            std::shuffle(steps.begin(), steps.end(), random);
            for (std::size_t leg = 0; leg < 3; ++leg)
                legs[leg] = {{below(random, 200), below(random, 200)}, steps[leg]};
            targets.emplace_back(legs, below(random, 100));
        }
        const std::int64_t near = below(random, 30);
        const TargetDistance distance{line, near, near + 1 + below(random, 60), targets};
        const MotionPoint cell{below(random, 200), below(random, 200)};
        const Step step = random_step(random);
        const auto answer = distance.shown_at(cell, step);
        ASSERT_EQ(answer.frame, distance.frame_at(cell, step));
        for (Step at = std::max(answer.validity.from, step - 64);
             at < std::min(answer.validity.until, step + 65); ++at, ++checked)
            ASSERT_EQ(distance.frame_at(cell, at), answer.frame) << "case " << seed << ", step " << at;
        ASSERT_EQ(answer.validity.until == never, answer.validity.from == always) << "case " << seed;
        if (answer.validity.until != never) {
            ASSERT_NE(distance.frame_at(cell, answer.validity.until), answer.frame) << "case " << seed;
            ASSERT_NE(distance.frame_at(cell, answer.validity.from - 1), answer.frame) << "case " << seed;
        }
    }
    EXPECT_GT(checked, 50'000u);
}

}  // namespace
}  // namespace tessera
