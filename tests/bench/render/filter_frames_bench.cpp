// What a frame of the plane costs by filter, through pages, at 800x700: medians of interleaved rounds, and
// their ratio to trilinear, which other work on the machine hardly moves. A picture that is not sharp, or
// that is far from the supersampled one, is not timed. The first frame of each filter is timed apart, by
// processor time, and so is what makes it ready before: its shaders are compiled there. "plain" is the same
// plane without pages, out of one texture of plain 8-bit codes by the driver's own trilinear filter. Returns
// 1 where a filter costs more than its limit, as a multiple of plain or of trilinear.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "tests/bench/render/plain_plane.h"
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
    double most_plains;              ///< That a trilinear frame may cost
    double most_trilinears;          ///< That a frame of 16x may cost
    double most_of_integrals = 7.2;  ///< The same, of line integrals
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
    double warm_ms = 0, first_ms = 0, plan_ms = 0;
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

/// Whether all limits hold.
bool run(const View& view, int rounds) {
    std::vector<Timed> all;
    for (const Filter filter : filters)
        if (filter != Filter::driver_anisotropic) all.push_back({.choice = {.filter = filter}});
    testing::Offscreen screen{extent, page_of, width, height, {.slots = 640}};
    const FilterChoice reference{.filter = Filter::supersample, .subsamples = 4};
    settle(screen, view, reference);
    const Rgba8Image expected = screen.draw(view.camera, {.filter = reference});
    for (Timed& timed : all) {
        settle(screen, view, timed.choice);
        double before = cpu_milliseconds();
        if (const auto warm = screen.scene->warm_up(screen.view(view.camera), timed.choice); !warm)
            refuse(warm.error().detail);
        timed.warm_ms = cpu_milliseconds() - before;
        before = cpu_milliseconds();
        draw_once(screen, view, timed.choice);
        timed.first_ms = cpu_milliseconds() - before;
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
    testing::PlainPlane plain;
    std::vector<double> plain_costs;
    plain.draw(screen.target, screen.view(view.camera));
    for (int round = 0; round < rounds; ++round) {
        const double begin = cpu_milliseconds();
        plain.draw(screen.target, screen.view(view.camera));
        plain_costs.push_back(cpu_milliseconds() - begin);
        for (Timed& timed : all) {
            const bool is_slow = timed.choice.filter == Filter::supersample;
            if (is_slow && round % 8 != 0) continue;
            settle(screen, view, timed.choice);
            const double before = cpu_milliseconds();
            timed.draws.push_back(draw_once(screen, view, timed.choice));
            timed.costs.push_back(cpu_milliseconds() - before);
        }
    }
    const auto cost_of = [&](Filter filter) {
        return median_of(
            std::ranges::find(all, filter, [](const Timed& timed) { return timed.choice.filter; })->costs);
    };
    const double trilinear = cost_of(Filter::trilinear), plains = trilinear / median_of(plain_costs),
                 trilinears = cost_of(Filter::anisotropic) / trilinear,
                 of_integrals = cost_of(Filter::line_integral) / trilinear;
    std::printf("\n%s\n%-16s %9s %8s %8s %10s %8s %9s %7s %9s\n", view.name, "filter", "median ms", "best ms",
                "CPU ms", "trilinears", "warm ms", "first ms", "pages", "plan ms");
    for (const Timed& timed : all)
        std::printf("%-16s %9.2f %8.2f %8.2f %10.2f %8.1f %9.1f %7zu %9.2f\n",
                    std::string{name_of(timed.choice.filter)}.c_str(), median_of(timed.draws),
                    std::ranges::min(timed.draws), median_of(timed.costs), median_of(timed.costs) / trilinear,
                    timed.warm_ms, timed.first_ms, timed.pages, timed.plan_ms);
    const bool holds = plains <= view.most_plains && trilinears <= view.most_trilinears &&
                       of_integrals <= view.most_of_integrals;
    std::printf(
        "trilinear costs %.2f plain frames of %.2f ms (limit %.1f), 16x %.2f trilinear ones (limit %.1f), "
        "line integrals "
        "%.2f (limit %.1f), with room for the sums of %zu pages, %.0f MB%s\n",
        plains, median_of(plain_costs), view.most_plains, trilinears, view.most_trilinears, of_integrals,
        view.most_of_integrals, screen.scene->integral_places(),
        static_cast<double>(screen.scene->integral_places() * IntegralStore::page_bytes) / 1e6,
        holds ? "" : ": TOO MUCH");
    return holds;
}

}  // namespace

int main(int argc, char** argv) {
    const int rounds = argc > 1 ? std::max(std::atoi(argv[1]), 3) : 24;
    std::printf("%dx%d, %d rounds\n", width, height, rounds);
    try {
        bool holds = true;
        for (const View& view : {View{"grazing plane (pitch 12)", camera_of(12, 750), 3.8, 3.9},
                                 View{"first view (pitch 40)", camera_of(40, 512), 3.8, 1.9},
                                 View{"near top-down (pitch 80)", camera_of(80, 512), 3.8, 1.5}})
            holds = run(view, rounds) && holds;
        return holds ? 0 : 1;
    } catch (const std::exception& error) {
        refuse(error.what());
    }
}
