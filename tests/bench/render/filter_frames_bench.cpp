// What a frame of the plane costs by filter, through pages, at 800x700: medians of interleaved rounds, and
// their ratio to trilinear, which other work on the machine hardly moves. A picture that is not sharp, or
// that is far from the supersampled one, is not timed. The first frame of each filter is timed apart: its
// shader is compiled in it.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "tests/unit/client/render/offscreen.h"
#include "tests/unit/client/render/painted_pages.h"

namespace {

using namespace tessera;
using Clock = std::chrono::steady_clock;

constexpr int width = 800, height = 700;
constexpr Extent extent{20};

double milliseconds_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// Of all threads of this process: what a frame costs whatever else runs.
double cpu_milliseconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double median_of(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

[[noreturn]] void refuse(const std::string& why) {
    std::fprintf(stderr, "filter_frames_bench: %s\n", why.c_str());
    std::exit(1);
}

/// Smooth waves with a tint for each cell: what filters show of it differs by little, and of a wrong page by
/// much.
std::string page_of(PageKey page) {
    return testing::paint_page(page, [](int level, std::int64_t x, std::int64_t y) -> testing::Code4 {
        const auto cell = [&](std::int64_t at, int side) {
            return static_cast<unsigned>((at << level) >> side);
        };
        const unsigned tint = hash(1, 2, cell(x, 15), cell(y, 15)) & 63;
        return {static_cast<std::uint8_t>(90 + tint), static_cast<std::uint8_t>(150 - tint),
                static_cast<std::uint8_t>(60 + tint), 255};
    });
}

struct View {
    const char* name;
    Camera camera;
};

Camera camera_of(double pitch, double height_texels) {
    return {.ground = {134'217'728, 134'217'728, 0.5, 0.5},
            .height_texels = height_texels,
            .yaw_degrees = 30,
            .pitch_degrees = -pitch};
}

double mean_difference(const Rgba8Image& a, const Rgba8Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.bytes.size(); ++i) sum += std::abs(int{a.bytes[i]} - int{b.bytes[i]});
    return sum / static_cast<double>(a.bytes.size());
}

struct Timed {
    FilterChoice choice;
    double first_ms = 0, plan_ms = 0;
    std::size_t pages = 0;
    std::vector<double> draws{}, costs{};
};

/// Draws, and waits for the picture's last texel.
double draw_once(testing::Offscreen& screen, const View& view, FilterChoice choice) {
    const PlaneStyle style{.filter = choice};
    const auto begin = Clock::now();
    if (const auto drawn = screen.scene->draw(screen.target, screen.view(view.camera), style); !drawn)
        refuse(drawn.error().detail);
    glFinish();
    return milliseconds_since(begin);
}

void settle(testing::Offscreen& screen, const View& view, FilterChoice choice) {
    screen.settle(view.camera, choice);
    screen.update(view.camera, choice);
}

void run(const View& view, int rounds) {
    std::vector<Timed> all;
    for (const Filter filter : filters)
        if (filter != Filter::driver_anisotropic) all.push_back({.choice = {.filter = filter}});
    testing::Offscreen screen{extent, page_of, width, height, {.slots = 640}};
    const FilterChoice reference{.filter = Filter::supersample, .subsamples = 4};
    settle(screen, view, reference);
    const Rgba8Image expected = screen.draw(view.camera, {.filter = reference});
    for (Timed& timed : all) {
        settle(screen, view, timed.choice);
        timed.first_ms = draw_once(screen, view, timed.choice);
        const double off = mean_difference(screen.draw(view.camera, {.filter = timed.choice}), expected);
        if (!(off < 2)) refuse(std::string{name_of(timed.choice.filter)} + " shows another picture");
        std::vector<double> plans;
        for (int i = 0; i < 9; ++i) {
            const auto begin = Clock::now();
            // Moves, so that nothing is remembered
            Camera moved = view.camera;
            moved.yaw_degrees += 0.01 * i;
            const auto pages = needed_pages(screen.view(moved), extent, 0, sampling_of(timed.choice));
            plans.push_back(milliseconds_since(begin));
            timed.pages = pages.size();
        }
        timed.plan_ms = median_of(plans);
    }
    for (int round = 0; round < rounds; ++round) {
        for (Timed& timed : all) {
            const bool is_slow = timed.choice.filter == Filter::supersample;
            if (is_slow && round % 8 != 0) continue;
            settle(screen, view, timed.choice);
            const double before = cpu_milliseconds();
            timed.draws.push_back(draw_once(screen, view, timed.choice));
            timed.costs.push_back(cpu_milliseconds() - before);
        }
    }
    double trilinear = 0;
    for (const Timed& timed : all)
        if (timed.choice.filter == Filter::trilinear) trilinear = median_of(timed.costs);
    std::printf("\n%s\n%-16s %9s %8s %8s %10s %9s %7s %9s\n", view.name, "filter", "median ms", "best ms",
                "CPU ms", "trilinears", "first ms", "pages", "plan ms");
    for (const Timed& timed : all)
        std::printf("%-16s %9.2f %8.2f %8.2f %10.2f %9.1f %7zu %9.2f\n",
                    std::string{name_of(timed.choice.filter)}.c_str(), median_of(timed.draws),
                    std::ranges::min(timed.draws), median_of(timed.costs), median_of(timed.costs) / trilinear,
                    timed.first_ms, timed.pages, timed.plan_ms);
}

}  // namespace

int main(int argc, char** argv) {
    const int rounds = argc > 1 ? std::max(std::atoi(argv[1]), 3) : 24;
    std::printf("%dx%d, %d rounds\n", width, height, rounds);
    try {
        for (const View& view : {View{"grazing plane (pitch 12)", camera_of(12, 750)},
                                 View{"first view (pitch 40)", camera_of(40, 512)},
                                 View{"near top-down (pitch 80)", camera_of(80, 512)}})
            run(view, rounds);
    } catch (const std::exception& error) {
        refuse(error.what());
    }
}
