// The same as feedback_test of hills and corridors: each pixel tells which pages it read, and the walk must
// have named all of them, and hardly any other.
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/client/render/feedback.h"

namespace tessera {
namespace {

using testing::Feedback;
using testing::Offscreen;

struct Case {
    Surface::Kind surface;
    FilterChoice filter;
};

class SurfaceFeedbacks : public ::testing::TestWithParam<Case> {};

TEST_P(SurfaceFeedbacks, NameNoPageThatTheWalkDoesNotKnowAndNearlyAllThatItKnows) {
    const auto& [kind, filter] = GetParam();
    const Extent extent{30};
    Offscreen offscreen{extent, testing::blank_page, 400, 350, {.slots = 600, .uploads_per_frame = 600}};
    Feedback feedback{extent, 32};
    std::mt19937_64 random{11};
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution{low, high}(random);
    };
    std::size_t needed_count = 0, read_count = 0;
    for (int i = 0; i < 6; ++i) {
        Camera camera;
        camera.ground = PlanePoint{std::int64_t{1} << 37, std::int64_t{1} << 36, 0.25, 0.5}.moved(
            std::floor(uniform(-1e9, 1e9)), std::floor(uniform(-1e9, 1e9)));
        camera.height_texels = std::exp2(uniform(6, 13));
        camera.yaw_degrees = uniform(0, 360);
        camera.pitch_degrees = uniform(-70, 12);
        Surface surface{.kind = kind, .relief = uniform(0.5, 2)};
        surface = around(surface, camera);
        offscreen.surface = surface;
        if (kind == Surface::Kind::corridor)
            camera.ground = camera.ground.moved(uniform(-0.8, 0.8) * surface.half_side, 0);
        offscreen.settle(camera, filter);
        const double bias = offscreen.update(camera, filter).lod_bias;
        const std::set<PageKey> read = feedback.of(offscreen, camera, filter);
        std::set<PageKey> needed;
        for (const NeededPage& page : needed_pages(offscreen.view(camera), extent, bias, sampling_of(filter)))
            if (offscreen.scene->residency().table().in_window(page.key)) needed.insert(page.key);
        for (const PageKey page : read)
            EXPECT_TRUE(needed.contains(page))
                << "camera " << i << " height " << camera.height_texels << " pitch " << camera.pitch_degrees
                << ": level " << int{page.level} << " page " << page.x << ',' << page.y
                << " was read and is not known";
        read_count += read.size();
        needed_count += needed.size();
    }
    const double precision = static_cast<double>(read_count) / static_cast<double>(needed_count);
    std::cout << name_of(kind) << ", " << name_of(filter.filter) << ": " << read_count << " pages read, "
              << needed_count << " needed: precision " << precision << '\n';
    EXPECT_GE(precision, 0.9);
}

std::vector<Case> cases() {
    std::vector<Case> all;
    for (const auto kind : {Surface::Kind::terrain, Surface::Kind::corridor})
        for (const Filter filter : {Filter::nearest, Filter::trilinear, Filter::anisotropic,
                                    Filter::supersample, Filter::line_integral})
            all.push_back({kind, {filter}});
    return all;
}

INSTANTIATE_TEST_SUITE_P(Surfaces, SurfaceFeedbacks, ::testing::ValuesIn(cases()), [](const auto& test) {
    std::string name =
        std::string{name_of(test.param.surface)} + "_" + std::string{name_of(test.param.filter.filter)};
    std::erase(name, '-');
    return name;
});

}  // namespace
}  // namespace tessera
