// Pages of the sample scenes that move, at steps that follow each other, one core, nothing cached.
//   build/release/bin/moving_scenes_bench
// prints the median and the longest time of a page where something moves, at each level.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "server/scene/scene.h"
#include "server/scenes/moving_scenes.h"
#include "shared/wire/json.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

/// Milliseconds of this thread.
double now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) / 1e6;
}

struct Place {
    std::string_view scene;
    std::int64_t x, y;
    std::int64_t by_x = 0, by_y = 0;  ///< In 240 steps.
};
constexpr std::int64_t middle = std::int64_t{1} << 17;
/// On a ball in the flower field; on the road, among feet and lamps.
constexpr Place places[] = {{"flower-field", middle - 1500, middle - 420, 2900, -280},
                            {"road", middle - 150, middle},
                            {"message-board", middle, middle}};

void measure(const Place& place) {
    const tests::TemporaryFolder folder;
    const std::filesystem::path path = folder.path / place.scene;
    std::filesystem::create_directories(path);
    const PaintedScene painted = paint_moving_scene(std::string{place.scene});
    std::ofstream{path / "scene.json"} << write_json(painted.scene);
    for (const PaintedFile& file : painted.files)
        std::ofstream{path / file.name, std::ios::binary}.write(
            reinterpret_cast<const char*>(file.bytes.data()), std::ssize(file.bytes));
    const ScenePtr scene = load_scene(path).value();
    for (const int level : {0, 1, 2, 4, 6}) {
        std::vector<double> times;
        double bound = 0;
        for (Step step = 60; step < 100; ++step) {
            const auto page = [&](std::int64_t from, std::int64_t by) {
                return static_cast<std::uint32_t>((from + by * step / 240) >> (8 + level));
            };
            TexelRegion region = region_of(
                {static_cast<std::uint8_t>(level), page(place.x, place.by_x), page(place.y, place.by_y)});
            region.step = step;
            Rgba8Image out;
            const double begin = now();
            const auto done = scene->texture->evaluate(region, Budget{}, out);
            times.push_back(now() - begin);
            bound = done->bound_codes;
        }
        std::sort(times.begin(), times.end());
        std::printf("%-14s level %d  median %8.2f ms  longest %8.2f ms  bound %.4f codes\n",
                    std::string{place.scene}.c_str(), level, times[times.size() / 2], times.back(), bound);
    }
}

}  // namespace
}  // namespace tessera

int main() {
    for (const tessera::Place& place : tessera::places) tessera::measure(place);
}
