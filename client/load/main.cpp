// tessera-load: loads a server with the pages of a scene, and measures what a viewer would have waited.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <memory>

#include <sys/resource.h>
#include <unistd.h>

#include "client/link/scene_info.h"
#include "client/load/camera_walk.h"
#include "client/load/load_options.h"
#include "client/load/progress_view.h"
#include "client/load/report.h"
#include "client/view/camera_path.h"

namespace {

using namespace tessera;

int fail(const std::string& why, int exit_code = 1) {
    std::cerr << "tessera-load: " << why << "\n";
    return exit_code;
}

/// The frames of a camera path, 30 a second, at most an hour of them.
Result<std::vector<Camera>> flight_of_file(const std::string& file, Extent extent) {
    const auto path = CameraPath::read(file, extent);
    if (!path) return path.error();
    constexpr double frames_per_second = 30, longest = 3600;
    const double seconds = std::clamp(path->end_seconds() - path->begin_seconds(), 0.0, longest);
    const auto count = static_cast<std::size_t>(seconds * frames_per_second) + 1;
    std::vector<Camera> frames;
    for (std::size_t i = 0; i < count; ++i)
        frames.push_back(path->at(path->begin_seconds() + static_cast<double>(i) / frames_per_second));
    return frames;
}

Result<std::unique_ptr<PageWalk>> make_walk(const LoadOptions& options, Extent extent) {
    auto levels = parse_level_weights(options.levels, extent);
    if (!levels) return levels.error();
    std::unique_ptr<PageWalk> walk;
    if (options.walk == "sweep") {
        walk = std::make_unique<SweepWalk>(extent, std::move(*levels), options.seed, options.sweep_side);
    } else if (options.walk == "camera") {
        auto frames = options.camera_file.empty()
                          ? Result<std::vector<Camera>>{generated_flight(extent, *levels, options.seed)}
                          : flight_of_file(options.camera_file, extent);
        if (!frames) return frames.error();
        walk = std::make_unique<CameraWalk>(extent, std::move(*levels), std::move(*frames),
                                            CameraWalk::Settings{});
    } else {
        walk = std::make_unique<RandomWalk>(extent, std::move(*levels), options.seed, options.working_set);
    }
    return walk;
}

/// Each connection takes a descriptor.
bool make_room_for(std::size_t connections) {
    rlimit limit{};
    const rlim_t wanted = connections + 64;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= wanted) return true;
    limit.rlim_cur = std::min(wanted, limit.rlim_max);
    return setrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur >= wanted;
}

}  // namespace

int main(int argc, char** argv) {
    CommandLine line = read_command_line(argc, argv);
    if (!line.go_on) return line.exit_code;
    LoadOptions& options = line.options;
    LoadPlan& plan = options.plan;

    auto scene = read_scene_info(options.server, options.scene);
    if (!scene) return fail(scene.error().detail);
    plan.scene = std::move(*scene);
    if (plan.options.gutter > plan.scene.max_gutter)
        return fail("--gutter " + std::to_string(plan.options.gutter) + ": the server gives at most " +
                        std::to_string(plan.scene.max_gutter),
                    2);
    if (const auto there = check_channels(plan.scene, plan.options.channels); !there)
        return fail(there.error().detail, 2);
    const auto walk = make_walk(options, plan.scene.extent);
    if (!walk) return fail(walk.error().detail, 2);
    if (!make_room_for(plan.connections))
        return fail("--connections " + std::to_string(plan.connections) +
                    ": the system allows fewer open files; see ulimit -n");
    std::ofstream json_file;
    if (!options.json_file.empty() && options.json_file != "-") {
        json_file.open(options.json_file);  // before the run: a wrong path shall not cost its result
        if (!json_file) return fail("cannot write " + options.json_file + "; does its folder exist?", 2);
    }

    ProgressView view{isatty(STDERR_FILENO) != 0};
    if (!options.quiet) plan.progress_every = view.period();
    const LoadOutcome outcome =
        run_load(plan, **walk, [&](const LoadProgress& progress) { view.show(progress); });
    view.clear();

    std::vector<AssertionOutcome> assertions;
    bool all_hold = true;
    for (const Assertion& assertion : options.assertions) {
        assertions.push_back(check(assertion, outcome.tally));
        all_hold = all_hold && assertions.back().holds;
    }
    const std::string json = json_report(options, outcome, assertions);
    if (options.json_file == "-") {
        std::cout << json;
    } else if (!options.quiet) {
        std::cout << text_report(options, outcome, assertions);
    }
    if (json_file.is_open() && !(json_file << json).flush()) return fail("cannot write " + options.json_file);
    if (!std::cout.flush()) return fail("cannot write to stdout");

    if (!all_hold && options.quiet) {
        // A failed check must say which, whatever else is kept quiet
        for (const AssertionOutcome& assertion : assertions)
            if (!assertion.holds) std::cerr << "tessera-load: " << assertion_text(assertion) << '\n';
        if (!outcome.tally.first_problem.empty())
            std::cerr << "tessera-load: " << outcome.tally.first_problem << '\n';
    }
    if (!all_hold) return 3;
    if (outcome.interrupted) return 130;
    if (outcome.tally.ok == 0 && options.assertions.empty())
        return fail("no page came" +
                    (outcome.tally.first_problem.empty() ? "" : "; " + outcome.tally.first_problem));
    return 0;
}
