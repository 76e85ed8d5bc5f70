// The shader says which pages it read, pixel by pixel; the analytic walk must have named them all, and hardly
// any other.
#include "tests/unit/client/render/feedback.h"

#include <cmath>
#include <iostream>
#include <random>

#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::Feedback;
using testing::Offscreen;

Camera random_camera(std::mt19937_64& random, Extent extent) {
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution{low, high}(random);
    };
    const auto side = static_cast<double>(extent.side_texels());
    Camera camera;
    camera.ground = PlanePoint{}
                        .moved(std::floor(uniform(0, side - 1)), std::floor(uniform(0, side - 1)))
                        .moved(uniform(0, 1), uniform(0, 1));
    camera.height_texels = std::exp2(uniform(5, 14));
    camera.yaw_degrees = uniform(0, 360);
    camera.pitch_degrees = uniform(-90, 5);
    camera.field_of_view_degrees = uniform(35, 70);
    return camera;
}

class Feedbacks : public ::testing::TestWithParam<FilterChoice> {};

TEST_P(Feedbacks, NameNoPageThatTheWalkDoesNotKnowAndNearlyAllThatItKnows) {
    const FilterChoice filter = GetParam();
    std::size_t needed_count = 0, read_count = 0, missed = 0;
    for (const int n : {30, 6}) {
        if (n == 6 && filter.filter == Filter::line_integral) continue;  // slow on a software rasteriser
        const Extent extent{static_cast<std::uint8_t>(n)};
        Offscreen offscreen{extent, testing::blank_page, 400, 350, {.slots = 400, .uploads_per_frame = 400}};
        Feedback feedback{extent, 32};
        std::mt19937_64 random{static_cast<std::uint64_t>(n)};
        for (int i = 0; i < 3; ++i) {
            const Camera camera = random_camera(random, extent);
            offscreen.settle(camera, filter);
            const double bias = offscreen.update(camera, filter).lod_bias;
            const std::set<PageKey> read = feedback.of(offscreen, camera, filter);
            std::set<PageKey> needed;
            for (const NeededPage& page :
                 needed_pages(offscreen.view(camera), extent, bias, sampling_of(filter)))
                if (offscreen.scene->residency().table().in_window(page.key)) needed.insert(page.key);
            for (const PageKey page : read) {
                if (needed.contains(page)) continue;
                ++missed;
                ADD_FAILURE() << "extent " << n << " camera " << i << " pitch " << camera.pitch_degrees
                              << ": level " << int{page.level} << " page " << page.x << ',' << page.y
                              << " was read and is not known";
            }
            read_count += read.size();
            needed_count += needed.size();
        }
    }
    const double precision = static_cast<double>(read_count) / static_cast<double>(needed_count);
    std::cout << name_of(filter.filter) << ": " << read_count << " pages read, " << needed_count
              << " needed: precision " << precision << '\n';
    EXPECT_EQ(missed, 0u);
    EXPECT_GE(precision, 0.9);
}

INSTANTIATE_TEST_SUITE_P(Filters, Feedbacks,
                         ::testing::Values(FilterChoice{Filter::nearest}, FilterChoice{Filter::bilinear},
                                           FilterChoice{Filter::trilinear}, FilterChoice{Filter::anisotropic},
                                           FilterChoice{Filter::supersample, 4},
                                           FilterChoice{Filter::line_integral, 4, 6}),
                         [](const auto& test) {
                             std::string name{name_of(test.param.filter)};
                             std::erase(name, '-');
                             return name;
                         });

}  // namespace
}  // namespace tessera
