// What `exact` leaves open, and what it is really off by.
//   build/release/bin/exact_bench [SCENE [LAST [SIDE]]]
// For each scene of pattern blocks (or the one named) and each level up to LAST (9): the bound that an exact
// page states, how far SIDE × SIDE (8, at most 32) of its texels are from the box reduction of level 0, in
// codes, and a texel's time.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "server/scene/scene.h"
#include "tests/property/scenes/pattern_test_scenes.h"

namespace tessera {
namespace {

double seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) / 1e9;
}

/// Sums of level 0 under each texel of `region`, in strips.
std::vector<double> truth(const Texture& texture, const TexelRegion& region) {
    const std::int64_t side = std::int64_t{1} << region.level;
    std::vector<double> sums(static_cast<std::size_t>(region.width) *
                             static_cast<std::size_t>(region.height) * 4);
    const std::int64_t across = region.width * side, down = region.height * side;
    constexpr std::int64_t most = 512;
    LinearImage part;
    for (std::int64_t y = 0; y < down; y += most)
        for (std::int64_t x = 0; x < across; x += most) {
            const TexelRegion fine{0,
                                   region.x * side + x,
                                   region.y * side + y,
                                   static_cast<std::int32_t>(std::min(most, across - x)),
                                   static_cast<std::int32_t>(std::min(most, down - y)),
                                   region.slice};
            if (!texture.evaluate(fine, Budget{.accuracy = Accuracy::exact}, part)) std::exit(2);
            for (std::int32_t v = 0; v < fine.height; ++v)
                for (std::int32_t u = 0; u < fine.width; ++u)
                    for (std::int32_t c = 0; c < 4; ++c)
                        sums[static_cast<std::size_t>(
                            (((y + v) >> region.level) * region.width + ((x + u) >> region.level)) * 4 +
                            c)] += double{part.row(v)[4 * u + c]};
        }
    for (double& sum : sums) sum /= static_cast<double>(side) * static_cast<double>(side);
    return sums;
}

void measure(const tests::PatternTestScene& what, int last, std::int32_t side) {
    const tests::WrittenScene written{what};
    const auto scene = load_scene(written.folder());
    if (!scene) std::exit(2);
    const Texture& texture = *(*scene)->texture;
    std::cout << what.name << ": " << texture.description() << "\n";
    for (int level = 1; level <= (*scene)->extent.n; ++level) {
        // Whole blocks of the lattice that composites descend by
        const TexelRegion region{static_cast<std::uint8_t>(level),
                                 (what.x >> level) & ~31,
                                 (what.y >> level) & ~31,
                                 32,
                                 32,
                                 what.slice};
        TexelRegion part = region;
        part.width = part.height = side;
        LinearImage page;
        // What is made when it is first asked for is no part of a page's time
        if (!texture.evaluate(region, Budget{.accuracy = Accuracy::exact}, page)) std::exit(2);
        const double start = seconds();
        const auto evaluation = texture.evaluate(region, Budget{.accuracy = Accuracy::exact}, page);
        const double spent = seconds() - start;
        if (!evaluation) {
            std::cout << "  level " << level << ": " << evaluation.error().detail << "\n";
            continue;
        }
        std::cout << "  level " << std::setw(2) << level << std::fixed << std::setprecision(3) << ": bound "
                  << std::setw(7) << evaluation->bound_codes << (evaluation->confidence < 1 ? "?" : " ")
                  << ", off by ";
        if (level <= last) {
            const std::vector<double> right = truth(texture, part);
            double worst = 0, squares = 0;
            for (std::size_t i = 0; i < right.size(); ++i) {
                const std::size_t row = i / 4 / static_cast<std::size_t>(side);
                const double off =
                    (double{page.values[i + row * 4 * static_cast<std::size_t>(32 - side)]} - right[i]) * 255;
                worst = std::max(worst, std::abs(off));
                squares += off * off;
            }
            std::cout << std::setw(6) << worst << " (rms "
                      << std::sqrt(squares / static_cast<double>(right.size())) << ")";
        } else {
            std::cout << "     ?";
        }
        std::cout << ", " << std::setprecision(2) << spent * 1e6 / 1024 << " us a texel, "
                  << evaluation->method << "\n"
                  << std::flush;
    }
}

}  // namespace
}  // namespace tessera

int main(int count, char** arguments) {
    const std::string only = count > 1 ? arguments[1] : "";
    const int last = count > 2 ? std::atoi(arguments[2]) : 9;
    const int side = count > 3 ? std::atoi(arguments[3]) : 8;
    bool found = false;
    for (const auto& scene : tessera::tests::pattern_test_scenes()) {
        if (!only.empty() && scene.name != only) continue;
        found = true;
        tessera::measure(scene, last, side);
    }
    if (found) return 0;
    std::cerr << "exact_bench: there is no scene of pattern blocks called " << only << "; such as autumn\n";
    return 1;
}
