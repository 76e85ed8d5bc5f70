// Every page is painted with its own name. Frames are drawn unfiltered and read back, and every pixel is
// decoded: it must show the right texel of the page it wants or of that page's finest resident ancestor,
// never a page at a wrong place, whatever the order of arrival, evictions and leaps of the camera.
#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/client/render/offscreen.h"
#include "tests/unit/client/render/painted_pages.h"

namespace tessera {
namespace {

using testing::Offscreen;

/// 24 bits of a page's name. Two pages share them once in 16 million.
std::uint32_t name_of(PageKey page) {
    return static_cast<std::uint32_t>(hash(page.level, stream("page name"), page.x, page.y)) & 0xffffff;
}

/// Red, green, blue: the page; alpha: the 16×16 block of texels. The gutter says nothing true: it must not
/// show.
std::string named_page(PageKey page) {
    const std::uint32_t name = name_of(page);
    std::string bytes(slot_bytes, '\xee');
    for (int y = 0; y < page_side_texels; ++y) {
        for (int x = 0; x < page_side_texels; ++x) {
            const auto at =
                static_cast<std::size_t>((y + gutter_texels) * slot_side_texels + x + gutter_texels) * 4;
            bytes[at] = static_cast<char>(name);
            bytes[at + 1] = static_cast<char>(name >> 8);
            bytes[at + 2] = static_cast<char>(name >> 16);
            bytes[at + 3] = static_cast<char>(x / 16 + 16 * (y / 16));
        }
    }
    return bytes;
}

/// Decodes frames, and knows from the residency's table what each pixel should show.
class Oracle {
  public:
    Oracle(const PlaneView& view, const Residency& residency, double bias)
        : view_{view}, residency_{residency}, bias_{bias} {}

    /// The tolerances are those of single-precision positions: a thousandth of a level, 1/64 texel of the
    /// shown page's level, and a thousandth of a pixel.
    bool accepts(int x, int y, const std::uint8_t* pixel) const {
        for (const double dy : {0.0, -0.001, 0.001})
            for (const double dx : {0.0, -0.001, 0.001})
                for (const double dl : {0.0, -0.001, 0.001})
                    if (accepts_exactly(x + 0.5 + dx, y + 0.5 + dy, dl, pixel)) return true;
        return false;
    }

  private:
    bool accepts_exactly(double x, double y, double level_error, const std::uint8_t* pixel) const {
        const auto ground = view_.ground_at(x, y);
        const std::uint32_t name = pixel[0] | std::uint32_t{pixel[1]} << 8 | std::uint32_t{pixel[2]} << 16;
        const bool shows_nothing = name == 0 && pixel[3] == 0;
        if (!ground || std::abs(ground->x) > 1e17 || std::abs(ground->y) > 1e17) return shows_nothing;
        const Extent extent = residency_.extent();
        const PlanePoint at = view_.camera().ground.moved(ground->x, ground->y);
        const std::int64_t side = extent.side_texels();
        if (at.x < 0 || at.y < 0 || at.x >= side || at.y >= side) return shows_nothing;

        const double exact = view_.level_at(x, y) + bias_ + level_error;
        const auto level = static_cast<std::uint8_t>(
            std::clamp(std::floor(exact + 0.5), 0.0, static_cast<double>(extent.n)));
        PageKey page = key(level, at);
        while (!residency_.table().in_window(page) && page.level < extent.n) page = parent(page);
        const auto shown = residency_.table().shown_for(page);
        if (!shown) return shows_nothing;
        const PageKey there = key(shown->level, at);
        if (name != name_of(there)) return false;
        // The texel, on either side of a block's border if it is that near
        const double texel = std::exp2(shown->level);
        const auto within = [&](std::int64_t whole, double fraction) {
            return (static_cast<double>(whole & ((std::int64_t{256} << shown->level) - 1)) + fraction) /
                   texel;
        };
        const double column = within(at.x, at.fraction_x), row = within(at.y, at.fraction_y);
        const auto is_block = [](double position, int block) {
            return position > 16 * block - 1.0 / 64 && position < 16 * (block + 1) + 1.0 / 64;
        };
        return is_block(column, pixel[3] % 16) && is_block(row, pixel[3] / 16);
    }
    static PageKey key(std::uint8_t level, const PlanePoint& at) {
        return {level, static_cast<std::uint32_t>(at.x >> (8 + level)),
                static_cast<std::uint32_t>(at.y >> (8 + level))};
    }

    const PlaneView& view_;
    const Residency& residency_;
    double bias_;
};

struct Tally {
    std::size_t pixels = 0;
    std::size_t wrong = 0;
    std::size_t sharp_frames = 0;
};

void fly(Offscreen& offscreen, unsigned seed, int frames, Tally& tally) {
    std::mt19937_64 random{seed};
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution{low, high}(random);
    };
    const Extent extent = offscreen.scene->residency().extent();
    const auto side = static_cast<double>(extent.side_texels());
    Camera camera;
    for (int frame = 0; frame < frames; ++frame) {
        if (frame % 25 == 0) {  // a leap to anywhere, also to the corners
            const double x = frame == 25 ? 0 : frame == 50 ? side - 1 : uniform(0, side - 1);
            camera.ground =
                PlanePoint{}.moved(std::floor(x), std::floor(uniform(0, side - 1))).moved(uniform(0, 1), 0.3);
            camera.height_texels = std::exp2(uniform(6, 14));
            camera.pitch_degrees = uniform(-90, 3);
        }
        const double stride = camera.height_texels / 4;
        const PlanePoint moved = camera.ground.moved(uniform(-stride, stride), uniform(-stride, stride));
        if (moved.x >= 0 && moved.y >= 0 && moved.x < extent.side_texels() && moved.y < extent.side_texels())
            camera.ground = moved;
        camera.yaw_degrees += uniform(-20, 20);
        camera.height_texels *= std::exp2(uniform(-0.2, 0.2));

        offscreen.source.deliver_at_once = static_cast<std::size_t>(random() % 12);
        const ResidencyFrame outcome = offscreen.update(camera);
        tally.sharp_frames += outcome.is_sharp() ? 1 : 0;
        const PlaneView view = offscreen.view(camera);
        const Rgba8Image image = offscreen.draw(camera, {.filter = {Filter::stored}});
        const Oracle oracle{view, offscreen.scene->residency(), outcome.lod_bias};
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const std::uint8_t* pixel = image.row(y) + 4 * x;
                ++tally.pixels;
                if (oracle.accepts(x, y, pixel)) continue;
                if (++tally.wrong < 10)
                    ADD_FAILURE() << "seed " << seed << " frame " << frame << " pixel " << x << ',' << y
                                  << " level " << view.level_at(x + 0.5, y + 0.5) << ": wrong page or texel";
            }
        }
        if (tally.wrong > 0) return;
    }
}

TEST(IdentityOracle, FindsNoPixelOfAWrongPageWhilePagesComeInAnyOrderAndLeave) {
    Tally tally;
    {
        Offscreen roomy{Extent{20}, named_page, 400, 350, {.slots = 128}};
        fly(roomy, 1, 50, tally);
    }
    {
        Offscreen tight{Extent{12}, named_page, 400, 350, {.slots = 64}};
        fly(tight, 2, 75, tally);
        EXPECT_GT(tight.scene->residency().cache().evictions(), 50u);
    }
    {
        Offscreen widest{Extent{30}, named_page, 400, 350, {.slots = 128}};
        fly(widest, 3, 50, tally);
    }
    {
        Offscreen smallest{Extent{1}, named_page, 400, 350, {.slots = 64}};
        fly(smallest, 4, 25, tally);
    }
    EXPECT_EQ(tally.wrong, 0u);
    EXPECT_GT(tally.pixels, 27'000'000u);
    EXPECT_GT(tally.sharp_frames, 5u);
    RecordProperty("pixels", static_cast<int>(tally.pixels));
}

TEST(IdentityOracle, WouldNoticeAPageAtAWrongPlace) {
    const auto misplaced = [](PageKey page) {
        return named_page(page.level == 2 ? PageKey{2, page.x ^ 1, page.y} : page);
    };
    Offscreen offscreen{Extent{12}, misplaced, 200, 175, {.slots = 64}};
    const Camera camera{.ground = {300'000, 300'000, 0, 0}, .height_texels = 700, .pitch_degrees = -90};
    offscreen.settle(camera);
    const PlaneView view = offscreen.view(camera);
    const Rgba8Image image = offscreen.draw(camera, {.filter = {Filter::stored}});
    const Oracle oracle{view, offscreen.scene->residency(), 0};
    EXPECT_FALSE(oracle.accepts(100, 100, image.row(100) + 400));
}

}  // namespace
}  // namespace tessera
