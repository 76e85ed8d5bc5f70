// Every texel of every page is painted with the page's name, its version and its own place. Frames are drawn
// unfiltered and read back, and every pixel is decoded: it must show the right texel of the page it wants, or
// of that page's finest resident ancestor, of the version that residency holds, which is never older than one
// that it held before. Meanwhile the camera flies and leaps, the link loses, repeats and reorders, others
// edit, the connection breaks, pages are evicted and the cache is resized.
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "shared/math/hash.h"
#include "tests/simulation/simulated_stream.h"
#include "tests/unit/client/render/offscreen.h"

namespace tessera {
namespace {

using testing::LinkSettings;
using testing::SimulatedStream;

/// Names a version of a page.
std::uint64_t name_of(PageKey page, std::uint32_t history, std::uint64_t revision) {
    return hash(page.level, stream("page name", history * 1000003 + revision), page.x, page.y);
}

/// Red, green: 16 bits of the page's, its version's and the texel's name, never 0. Blue, alpha: the texel.
std::uint32_t code_of(std::uint64_t name, std::uint32_t x, std::uint32_t y) {
    std::uint64_t mixed = (name ^ (x << 8 | y)) * 0x9e3779b97f4a7c15u;
    mixed = (mixed ^ (mixed >> 29)) * 0xbf58476d1ce4e5b9u;
    return static_cast<std::uint32_t>(mixed >> 33) % 0xffffu + 1 + (x << 16) + (y << 24);
}

/// The gutter says nothing true: it must not show.
std::string named_page(PageKey page, std::uint32_t history, std::uint64_t revision) {
    const std::uint64_t name = name_of(page, history, revision);
    std::string bytes(slot_bytes, '\xee');
    for (std::uint32_t y = 0; y < page_side_texels; ++y) {
        for (std::uint32_t x = 0; x < page_side_texels; ++x) {
            const std::uint32_t code = code_of(name, x, y);
            const auto at =
                static_cast<std::size_t>((y + gutter_texels) * slot_side_texels + x + gutter_texels) * 4;
            for (std::size_t byte = 0; byte < 4; ++byte)
                bytes[at + byte] = static_cast<char>(code >> (8 * byte));
        }
    }
    return bytes;
}

/// Decodes frames, and knows from the residency's table what each pixel should show.
class Oracle {
  public:
    Oracle(const PlaneView& view, const Residency& residency, double bias)
        : view_{view}, residency_{residency}, bias_{bias} {}

    std::size_t wrong_pixels(const Rgba8Image& image) {
        std::size_t wrong = 0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                if (!accepts(x, y, image.row(y) + 4 * x)) ++(is_at_edge(x, y) ? at_edges_ : wrong);
        return wrong;
    }
    /// Pixels that show nothing known, at the edge of a surface's piece that is seen nearly edge on: there it
    /// goes on to its own horizon within a fraction of a pixel.
    std::size_t at_edges() const { return at_edges_; }

    /// The tolerances are those of single-precision positions: a thousandth of a level, 1/64 texel of the
    /// shown page's level, and a thousandth of a pixel. Corners of a surface's pieces lie on GL's grid of
    /// 1/256 pixel: a pixel may show any piece that is so near.
    bool accepts(int x, int y, const std::uint8_t* pixel) {
        const double middle_x = x + 0.5, middle_y = y + 0.5;
        if (accepts_piece(view_.piece_at(middle_x, middle_y), middle_x, middle_y, pixel)) return true;
        for (const double dy : {0.0, -grid, grid})
            for (const double dx : {0.0, -grid, grid})
                if (accepts_piece(view_.piece_at(middle_x + dx, middle_y + dy), middle_x, middle_y, pixel))
                    return true;
        return false;
    }

  private:
    static constexpr double grid = 1.0 / 256;

    bool is_at_edge(int x, int y) const {
        std::set<const FlatPiece*> pieces;
        for (const double dy : {-2 * grid, 0.0, 2 * grid})
            for (const double dx : {-2 * grid, 0.0, 2 * grid})
                pieces.insert(view_.piece_at(x + 0.5 + dx, y + 0.5 + dy));
        return pieces.size() > 1;
    }
    bool accepts_piece(const FlatPiece* piece, double x, double y, const std::uint8_t* pixel) {
        for (const double dy : {0.0, -0.001, 0.001})
            for (const double dx : {0.0, -0.001, 0.001})
                for (const double dl : {0.0, -0.001, 0.001})
                    if (accepts_exactly(piece, x + dx, y + dy, dl, pixel)) return true;
        return false;
    }
    bool accepts_exactly(const FlatPiece* piece, double x, double y, double level_error,
                         const std::uint8_t* pixel) {
        const std::uint32_t code = pixel[0] | std::uint32_t{pixel[1]} << 8 | std::uint32_t{pixel[2]} << 16 |
                                   std::uint32_t{pixel[3]} << 24;
        if (!piece) return code == 0;
        const auto along = [&](const std::array<double, 3>& row) {
            return row[0] * (x - view_.width() / 2.0) + row[1] * (y - view_.height() / 2.0) + row[2];
        };
        const double w = along(piece->w);
        const GroundPoint ground{along(piece->s) / w, along(piece->t) / w};
        if (w <= 0 || std::abs(ground.x) > 1e17 || std::abs(ground.y) > 1e17) return code == 0;
        const Extent extent = residency_.extent();
        const PlanePoint at = view_.camera().ground.moved(ground.x, ground.y);
        const std::int64_t side = extent.side_texels();
        if (at.x < 0 || at.y < 0 || at.x >= side || at.y >= side) return code == 0;

        const auto pixel_side = [&](std::size_t axis) {
            return std::hypot(piece->s[axis] - ground.x * piece->w[axis],
                              piece->t[axis] - ground.y * piece->w[axis]) /
                   w;
        };
        const double exact = std::log2(std::max(pixel_side(0), pixel_side(1))) + bias_ + level_error;
        const auto level = static_cast<std::uint8_t>(
            std::clamp(std::floor(exact + 0.5), 0.0, static_cast<double>(extent.n)));
        const Shown& shown = shown_for(key(level, at));
        if (!shown.is_there) return code == 0;
        const std::uint32_t column = pixel[2], row = pixel[3];
        if (code != code_of(shown.page == key(shown.page.level, at) ? shown.name : 0, column, row))
            return false;
        // The texel, or its neighbour if the border is that near
        const double scale = std::ldexp(1.0, -shown.page.level);
        const std::int64_t mask = (std::int64_t{256} << shown.page.level) - 1;
        const auto is_texel = [&](std::int64_t whole, double fraction, std::uint32_t texel) {
            const double position = (static_cast<double>(whole & mask) + fraction) * scale;
            return position > texel - 1.0 / 64 && position < texel + 1 + 1.0 / 64;
        };
        return is_texel(at.x, at.fraction_x, column) && is_texel(at.y, at.fraction_y, row);
    }
    static PageKey key(std::uint8_t level, const PlanePoint& at) {
        return {level, static_cast<std::uint32_t>(at.x >> (8 + level)),
                static_cast<std::uint32_t>(at.y >> (8 + level))};
    }

    struct Shown {
        bool is_there = false;
        PageKey page{};
        std::uint64_t name = 0;
    };
    /// Neighbouring pixels mostly want the same page.
    const Shown& shown_for(PageKey wanted) {
        Entry& entry =
            lately_[(wanted.x ^ wanted.y << 3 ^ std::uint32_t{wanted.level} << 6) % lately_.size()];
        if (entry.is_known && entry.wanted == wanted) return entry.shown;
        entry = {true, wanted, {}};
        const Extent extent = residency_.extent();
        PageKey page = wanted;
        while (!residency_.table().in_window(page) && page.level < extent.n) page = parent(page);
        if (const auto found = residency_.table().shown_for(page)) {
            while (page.level < found->level) page = parent(page);
            const PageVersion* held = residency_.versions().held(page);
            entry.shown = {true, page, held ? name_of(page, held->history, held->revision) : 0};
        }
        return entry.shown;
    }

    struct Entry {
        bool is_known = false;
        PageKey wanted{};
        Shown shown{};
    };
    const PlaneView& view_;
    const Residency& residency_;
    double bias_;
    std::array<Entry, 1024> lately_{};
    std::size_t at_edges_ = 0;
};

struct Tally {
    std::size_t pixels = 0, wrong = 0, at_edges = 0, frames = 0, sharp_frames = 0, stale_frames = 0;
    std::size_t evictions = 0, edits = 0, swaps = 0, failures = 0, unasked = 0;
};

class Flight {
  public:
    Flight(int n, std::size_t slots, const LinkSettings& link, unsigned seed,
           Surface::Kind surface = Surface::Kind::plane, int width = 1200, int height = 1000)
        : extent_{static_cast<std::uint8_t>(n)},
          random_{seed},
          seed_{seed},
          stream_{link, named_page, seed},
          surface_{.kind = surface},
          target_{width, height} {
        auto made = PlaneScene::make(extent_, stream_, {.slots = slots});
        if (!made) throw std::runtime_error{made.error().detail};
        scene_ = std::move(made.value());
    }

    /// Several updates for each frame that is drawn: more happens between the pictures.
    void fly(int frames, Tally& tally) {
        for (int frame = 0; frame < frames; ++frame) {
            constexpr int updates = 8;
            for (int i = 0; i < updates; ++i) update(tally, i == 0 && frame % 3 == 0);
            draw(tally, frame);
            if (tally.wrong > 0) return;
        }
        const RequestCounts& counts = scene_->residency().requests().counts();
        tally.evictions += scene_->residency().cache().evictions();
        tally.failures += counts.failed;
        tally.unasked += counts.unasked;
    }

  private:
    double uniform(double low, double high) { return std::uniform_real_distribution{low, high}(random_); }
    bool one_in(unsigned count) { return random_() % count == 0; }

    void move(bool leaps) {
        const std::int64_t side = extent_.side_texels();
        if (leaps) {  // to anywhere, also to the corners
            const double last = static_cast<double>(side) - 1;
            const double x = one_in(4) ? 0 : one_in(4) ? last : uniform(0, last);
            camera_.ground =
                PlanePoint{}.moved(std::floor(x), std::floor(uniform(0, last))).moved(uniform(0, 1), 0.3);
            camera_.height_texels = std::exp2(uniform(6, 14));
            camera_.pitch_degrees = uniform(-90, 3);
        }
        const double stride = camera_.height_texels / 20;
        const PlanePoint moved = camera_.ground.moved(uniform(-stride, stride), uniform(-stride, stride));
        if (moved.x >= 0 && moved.y >= 0 && moved.x < side && moved.y < side) camera_.ground = moved;
        camera_.yaw_degrees += uniform(-5, 5);
        camera_.height_texels *= std::exp2(uniform(-0.05, 0.05));
    }

    void update(Tally& tally, bool leaps) {
        move(leaps);
        now_ += ClientTime{16};
        if (one_in(2)) {
            std::vector<PageKey> dirty;
            for (const auto& [page, slot] : scene_->residency().cache().pages())
                if (one_in(5)) dirty.push_back(page);
            stream_.edit(dirty);
            ++tally.edits;
        }
        if (one_in(60)) stream_.disconnect(uniform(20, 300), !one_in(3));
        if (one_in(120)) stream_.replace_scene();
        if (one_in(40)) {
            const auto resized = scene_->resize(44 + random_() % 50);
            ASSERT_TRUE(resized) << resized.error().detail;
        }
        stream_.advance(now_);
        outcome_ = scene_->update(view(), now_, {Filter::stored});
        // No page that was shown goes back
        for (const SlotUpload& upload : outcome_.uploads) {
            const PageVersion* held = scene_->residency().versions().held(upload.page);
            ASSERT_TRUE(held);
            auto& committed = committed_[upload.page];
            const std::pair version{held->history, held->revision};
            ASSERT_GE(version, committed) << "seed " << seed_;
            tally.swaps += version > committed ? 1 : 0;
            committed = version;
        }
    }

    void draw(Tally& tally, int frame) {
        const PlaneView seen = view();
        const auto drawn = scene_->draw(target_, seen, {.filter = {Filter::stored}});
        ASSERT_TRUE(drawn) << drawn.error().detail;
        const Rgba8Image image = target_.read();
        ASSERT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
        Oracle oracle{seen, scene_->residency(), outcome_.lod_bias};
        const std::size_t wrong = oracle.wrong_pixels(image);
        tally.at_edges += oracle.at_edges();
        EXPECT_EQ(wrong, 0u) << "seed " << seed_ << " frame " << frame << " pitch " << camera_.pitch_degrees;
        tally.wrong += wrong;
        tally.pixels +=
            static_cast<std::size_t>(target_.width()) * static_cast<std::size_t>(target_.height());
        ++tally.frames;
        tally.sharp_frames += outcome_.is_sharp() ? 1 : 0;
        tally.stale_frames += outcome_.stale > 0 ? 1 : 0;
    }
    PlaneView view() const { return {camera_, target_.width(), target_.height(), around(surface_, camera_)}; }

    Extent extent_;
    std::mt19937_64 random_;
    unsigned seed_;
    SimulatedStream stream_;
    Surface surface_;
    FrameTarget target_;
    std::unique_ptr<PlaneScene> scene_;
    Camera camera_;
    ClientTime now_{};
    ResidencyFrame outcome_;
    std::map<PageKey, std::pair<std::uint32_t, std::uint64_t>> committed_;
};

TEST(IdentityOracle, FindsNoWrongPixelInAHundredMillionWhileAllThatCanGoWrongDoes) {
    const auto context = testing::headless_context();
    const LinkSettings bad{
        .bytes_per_second = 20e6, .one_way_ms = 10, .loss = 0.01, .duplicates = 0.12, .most_delay_ms = 40};
    const LinkSettings good{.one_way_ms = 5, .most_delay_ms = 30};
    Tally tally;
    Flight{30, 160, bad, 1}.fly(28, tally);
    Flight{20, 110, good, 2}.fly(28, tally);
    Flight{12, 90, bad, 3}.fly(18, tally);
    Flight{1, 64, good, 4}.fly(12, tally);
    std::cout << tally.pixels << " pixels, " << tally.wrong << " wrong; " << tally.frames << " frames, "
              << tally.sharp_frames << " sharp, " << tally.stale_frames << " with an older version in view; "
              << tally.edits << " edits, " << tally.swaps << " pages swapped, " << tally.evictions
              << " evicted, " << tally.failures << " lost, " << tally.unasked << " twice\n";
    EXPECT_EQ(tally.wrong, 0u);
    EXPECT_EQ(tally.at_edges, 0u);
    EXPECT_GE(tally.pixels, 100'000'000u);
    EXPECT_GT(tally.sharp_frames, 10u);
    EXPECT_GT(tally.stale_frames, 10u);
    EXPECT_GT(tally.evictions, 100u);
    EXPECT_GT(tally.failures, 20u);
    EXPECT_GT(tally.unasked, 10u);
    RecordProperty("pixels", static_cast<int>(tally.pixels));
}

/// So a hand takes hold of what it sees, too: HandPicture points at what `ground_at` says.
TEST(IdentityOracle, FindsNoWrongPixelOnHillsAndInCorridors) {
    const auto context = testing::headless_context();
    const LinkSettings bad{
        .bytes_per_second = 20e6, .one_way_ms = 10, .loss = 0.01, .duplicates = 0.12, .most_delay_ms = 40};
    for (const auto kind : {Surface::Kind::terrain, Surface::Kind::corridor}) {
        Tally tally;
        Flight{30, 160, bad, 5, kind, 240, 200}.fly(24, tally);
        Flight{12, 90, bad, 6, kind, 240, 200}.fly(24, tally);
        std::cout << name_of(kind) << ": " << tally.pixels << " pixels, " << tally.wrong << " wrong; "
                  << tally.at_edges << " unclear at edges; " << tally.sharp_frames << " of " << tally.frames
                  << " frames sharp\n";
        EXPECT_EQ(tally.wrong, 0u);
        EXPECT_LE(tally.at_edges, tally.pixels / 200'000);
        EXPECT_GE(tally.pixels, 2'000'000u);
    }
}

/// One frame of what `paint` makes, as the oracle sees it.
std::size_t wrong_pixels(const SimulatedStream::Paint& paint) {
    const auto context = testing::headless_context();
    SimulatedStream stream{{}, paint};
    FrameTarget target{200, 175};
    auto scene = PlaneScene::make(Extent{12}, stream, {.slots = 64});
    const Camera camera{.ground = {300'000, 300'000, 0, 0}, .height_texels = 200, .pitch_degrees = -90};
    const PlaneView view{camera, 200, 175};
    ResidencyFrame frame;
    for (int i = 1; i < 60; ++i) {
        stream.advance(ClientTime{16 * i});
        frame = (*scene)->update(view, ClientTime{16 * i}, {Filter::stored});
        if (i == 20) stream.edit({{2, 292, 292}, {1, 585, 585}, {0, 1171, 1171}});
    }
    EXPECT_TRUE(frame.is_current());
    if (const auto drawn = (*scene)->draw(target, view, {.filter = {Filter::stored}}); !drawn)
        throw std::runtime_error{drawn.error().detail};
    return Oracle{view, (*scene)->residency(), frame.lod_bias}.wrong_pixels(target.read());
}

TEST(IdentityOracle, WouldNoticeAPageAtAWrongPlaceOrOfAnOldVersionOrATexelNextToTheRightOne) {
    EXPECT_EQ(wrong_pixels(named_page), 0u);
    EXPECT_GT(wrong_pixels([](PageKey page, std::uint32_t history, std::uint64_t revision) {
                  return named_page({page.level, page.x ^ 1, page.y}, history, revision);
              }),
              30'000u);
    EXPECT_GT(wrong_pixels([](PageKey page, std::uint32_t history, std::uint64_t) {
                  return named_page(page, history, 0);
              }),
              5'000u);
    EXPECT_GT(wrong_pixels([](PageKey page, std::uint32_t history, std::uint64_t revision) {
                  std::string texels = named_page(page, history, revision);
                  std::rotate(texels.begin(), texels.begin() + 4, texels.end());
                  return texels;
              }),
              30'000u);
}

}  // namespace
}  // namespace tessera
