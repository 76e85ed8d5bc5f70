// Pages of an animated scene are painted with their names and with the interval that they are of; every pixel
// is read back and decoded. None may show an interval that has not begun, none an interval that has ended
// when the next one's texels had come before, and no page two intervals at once.
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "shared/math/hash.h"
#include "tests/simulation/simulated_stream.h"
#include "tests/unit/client/render/offscreen.h"

namespace tessera {
namespace {

using testing::SimulatedStream;

constexpr Step interval = 20;
constexpr double steps_per_second = 60;
constexpr int width = 800, height = 600;

/// Never 0.
std::uint8_t name_of(PageKey page) {
    return static_cast<std::uint8_t>(1 + hash(page.level, stream("name"), page.x, page.y) % 255);
}

/// A stream that paints what it brings by its validity, and remembers what it has brought.
class AnimatedPages : public PageSource {
  public:
    AnimatedPages()
        : stream{{.bytes_per_second = 20e6, .one_way_ms = 15, .most_delay_ms = 20},
                 [](PageKey, std::uint32_t, std::uint64_t) { return std::string{}; }} {
        stream.interval = interval;
    }
    bool request(const PageRequest& request) override { return stream.request(request); }
    void cancel(PageRequestId id) override { stream.cancel(id); }
    std::vector<ArrivedPage> take_arrived(std::size_t most) override {
        std::vector<ArrivedPage> arrived = stream.take_arrived(most);
        for (ArrivedPage& page : arrived) {
            if (!page.texels || page.unchanged) continue;
            const auto number = static_cast<std::uint8_t>(page.version.validity.from / interval);
            std::string texels(slot_bytes, '\0');
            for (std::size_t at = 0; at < texels.size(); at += 4) {
                texels[at] = static_cast<char>(name_of(page.page));
                texels[at + 1] = static_cast<char>(number);
                texels[at + 3] = '\xff';
            }
            page.texels = std::move(texels);
            brought.insert({page.page, page.version.validity.from / interval});
        }
        return arrived;
    }
    void allow(std::size_t answers) override { stream.allow(answers); }
    void watch(std::span<const PageWindow> windows, std::uint64_t seen) override {
        stream.watch(windows, seen);
    }
    SceneNews take_news() override { return stream.take_news(); }

    SimulatedStream stream;
    std::set<std::pair<PageKey, Step>> brought;
};

struct Tally {
    std::size_t pixels = 0, current = 0, ended = 0, wrong = 0, swapped = 0;
};

class Film {
  public:
    Film() : target_{width, height} {
        auto made = PlaneScene::make(Extent{20}, source_, {.slots = 256});
        if (!made) throw std::runtime_error{made.error().detail};
        scene_ = std::move(made.value());
    }

    void frame(Tally& tally, bool is_looked_at) {
        now_ += ClientTime{16};
        step_ = static_cast<Step>(static_cast<double>(now_.count()) * steps_per_second / 1000);
        camera_.ground = camera_.ground.moved(1.5, -2.5);
        source_.stream.advance(now_);
        const auto brought_before = source_.brought;
        const PlaneView view{camera_, width, height};
        const ResidencyFrame outcome =
            scene_->update(view, {now_, step_, steps_per_second}, {Filter::stored});
        tally.swapped += outcome.uploads.size();
        if (!is_looked_at) return;
        const auto drawn = scene_->draw(target_, view, {.filter = {Filter::stored}});
        ASSERT_TRUE(drawn) << drawn.error().detail;
        const Rgba8Image image = target_.read();
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) look(view, x, y, image.row(y) + 4 * x, brought_before, tally);
    }

  private:
    /// The page that is shown at a place, by the table.
    std::optional<PageKey> shown_at(const PlaneView& view, double x, double y, double level_error) const {
        const auto ground = view.ground_at(x, y);
        if (!ground) return std::nullopt;
        const PlanePoint at = view.camera().ground.moved(ground->x, ground->y);
        const auto level = static_cast<std::uint8_t>(
            std::clamp(std::floor(view.level_at(x, y) + level_error + 0.5), 0.0, 20.0));
        PageKey page{level, static_cast<std::uint32_t>(at.x >> (8 + level)),
                     static_cast<std::uint32_t>(at.y >> (8 + level))};
        const auto shown = scene_->residency().table().shown_for(page);
        if (!shown) return std::nullopt;
        while (page.level < shown->level) page = parent(page);
        return page;
    }

    void look(const PlaneView& view, int x, int y, const std::uint8_t* pixel,
              const std::set<std::pair<PageKey, Step>>& brought_before, Tally& tally) {
        if (pixel[3] == 0) return;  // nothing yet, or no plane
        ++tally.pixels;
        const Step now = step_ / interval;
        // Single-precision positions may fall on a border's other side
        for (const double dx : {0.0, -0.002, 0.002})
            for (const double dl : {0.0, -0.001, 0.001}) {
                const auto page = shown_at(view, x + 0.5 + dx, y + 0.5 + dx, dl);
                if (!page || pixel[0] != name_of(*page)) continue;
                const Step shown = pixel[1];
                if (shown == now) {
                    ++tally.current;
                    return;
                }
                if (shown < now && !brought_before.contains({*page, now})) {
                    ++tally.ended;
                    return;
                }
            }
        ++tally.wrong;
    }

    AnimatedPages source_;
    FrameTarget target_;
    std::unique_ptr<PlaneScene> scene_;
    Camera camera_{.ground = {50'000'000, 60'000'000, 0.5, 0.5}, .height_texels = 1100, .pitch_degrees = -40};
    ClientTime now_{};
    Step step_ = 0;
};

TEST(AnimatedOracle, FindsNoPixelOfAnIntervalThatHasEndedWhenTheNextHadComeAndNoneOfTheFuture) {
    const auto context = testing::headless_context();
    Film film;
    Tally tally;
    for (int i = 0; i < 60; ++i) film.frame(tally, false);  // the first pages come
    tally = {};
    // 60 ms of each third of a second around the turn of the interval, and now and then between
    for (int i = 0; i < 130; ++i) film.frame(tally, i % 21 < 4 || i % 20 == 0);
    std::cout << tally.pixels << " pixels, " << tally.current << " of the present interval, " << tally.ended
              << " of one before, whose next had not come; " << tally.swapped << " pages swapped\n";
    EXPECT_EQ(tally.wrong, 0u);
    EXPECT_GT(tally.pixels, 5'000'000u);
    EXPECT_GT(static_cast<double>(tally.current), 0.97 * static_cast<double>(tally.pixels));
    EXPECT_GT(tally.swapped, 100u);
}

}  // namespace
}  // namespace tessera
