// The shader says which pages it read, pixel by pixel; the analytic walk must have named them all, and hardly
// any other.
#include <cmath>
#include <iostream>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "client/residency/needed_pages.h"
#include "tests/unit/client/render/offscreen.h"

namespace tessera {
namespace {

using testing::Offscreen;

/// The pages that the pixels of a frame read.
class Feedback {
  public:
    Feedback(Extent extent, int window_side) : extent_{extent}, side_{window_side} {
        GLuint name = 0;
        glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
        texture_ = GlTexture{name};
        glTextureStorage3D(name, 1, GL_R32UI, side_, side_, extent.n + 1);
    }

    std::set<PageKey> of(Offscreen& offscreen, const Camera& camera, FilterChoice filter) {
        const std::uint32_t none = 0;
        glClearTexImage(texture_.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &none);
        offscreen.draw(camera, {.filter = filter, .feedback = true}, texture_.name());
        glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
        std::vector<std::uint32_t> read(static_cast<std::size_t>(side_ * side_ * (extent_.n + 1)));
        glGetTextureImage(texture_.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                          static_cast<GLsizei>(read.size() * sizeof read[0]), read.data());
        std::set<PageKey> pages;
        for (int l = 0; l <= extent_.n; ++l) {
            const auto level = static_cast<std::uint8_t>(l);
            const PageKey centre = offscreen.scene->residency().table().centre_page(level);
            const auto coordinate = [&](std::uint32_t middle, int at) {
                const std::int64_t first = std::int64_t{middle} - side_ / 2;
                return static_cast<std::uint32_t>(first + ((at - first) & (side_ - 1)));
            };
            for (int y = 0; y < side_; ++y)
                for (int x = 0; x < side_; ++x)
                    if (read[static_cast<std::size_t>((l * side_ + y) * side_ + x)] != 0)
                        pages.insert({level, coordinate(centre.x, x), coordinate(centre.y, y)});
        }
        return pages;
    }

  private:
    Extent extent_;
    int side_;
    GlTexture texture_;
};

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
