// Page revisions against what one gets by looking at every box that was ever marked.
#include <cstdlib>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "shared/revisions/page_revisions.h"

namespace tessera {
namespace {

std::uint64_t fresh_seed() {
    const char* const given = std::getenv("TESSERA_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
}

TexelBox box_of(PageKey page, std::int32_t gutter) {
    const TexelRegion region = region_of(page, gutter);
    const std::int64_t scale = std::int64_t{1} << page.level;
    return {region.x * scale, region.y * scale, (region.x + region.width) * scale,
            (region.y + region.height) * scale};
}

struct Mark {
    TexelBox box;
    Revision revision = 0;
};

/// Every box, the newest last.
struct Model {
    std::vector<Mark> marks;
    Revision newest_in(const TexelBox& box) const {
        for (auto mark = marks.rbegin(); mark != marks.rend(); ++mark) {
            if (mark->box.meets(box)) return mark->revision;
        }
        return 0;
    }
};

class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_{seed} {}
    std::int64_t below(std::int64_t count) {
        return std::uniform_int_distribution<std::int64_t>{0, count - 1}(engine_);
    }
    /// Any power of two of a size is as likely as any other.
    std::int64_t of_any_size(int bits) {
        const std::int64_t most = std::int64_t{1} << below(bits + 1);
        return below(most);
    }
    /// Mostly near a few centres, so that boxes meet.
    TexelBox box(std::int64_t extent) {
        const std::int64_t centre_x = extent / 7 * below(8), centre_y = extent / 5 * below(6);
        const int bits = 64 - __builtin_clzll(static_cast<unsigned long long>(extent));
        const std::int64_t x = centre_x + of_any_size(bits - 2) - of_any_size(bits - 2);
        const std::int64_t y = centre_y + of_any_size(bits - 2) - of_any_size(bits - 2);
        const int side = static_cast<int>(below(bits));
        return {x, y, x + 1 + of_any_size(side), y + 1 + of_any_size(side)};
    }
    PageKey page(Extent extent, const TexelBox& near) {
        const auto level = static_cast<std::uint8_t>(below(extent.n + 1));
        const std::int64_t side = std::int64_t{page_side_texels} << level;
        const auto cell = [&](std::int64_t texel) {
            const std::int64_t page = texel / side + below(3) - 1;
            return static_cast<std::uint32_t>(
                std::clamp<std::int64_t>(page, 0, extent.side_pages(level) - 1));
        };
        return {level, cell(near.x0), cell(near.y1)};
    }

  private:
    std::mt19937_64 engine_;
};

class PageRevisionsLaws : public testing::TestWithParam<int> {};

TEST_P(PageRevisionsLaws, AreNeverOlderThanTheLastEditThatTouchedThePage) {
    const std::uint64_t seed = fresh_seed();
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed));
    Random random{seed};
    const Extent extent{static_cast<std::uint8_t>(GetParam())};
    PageRevisions revisions;
    Model model;
    int asked = 0, exact = 0;
    for (Revision revision = 1; revision <= 100'000; ++revision) {
        const TexelBox box = random.box(extent.side_texels());
        revisions.mark(box, revision);
        model.marks.push_back({box, revision});
        if (revision % 50 != 0) continue;
        // Old marks are asked about as often as new ones
        const TexelBox& near =
            model.marks[static_cast<std::size_t>(random.below(static_cast<std::int64_t>(revision)))].box;
        for (const std::int32_t gutter : {0, 1, 16}) {
            const PageKey page = random.page(extent, near);
            const Revision truth = model.newest_in(box_of(page, gutter)), found = revisions.of(page, gutter);
            ASSERT_GE(found, truth) << "level " << int{page.level} << " x " << page.x << " y " << page.y;
            ASSERT_LE(found, revision);
            ++asked;
            exact += found == truth;
        }
    }
    EXPECT_GE(exact, asked * 95 / 100) << "of " << asked;
    RecordProperty("exact", exact);
    RecordProperty("asked", asked);
    std::printf("[          ] extent 256*2^%d: %d of %d exact, %zu bytes\n", GetParam(), exact, asked,
                revisions.used_bytes());
}

TEST_P(PageRevisionsLaws, HoldInLittleMemoryToo) {
    const std::uint64_t seed = fresh_seed();
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed));
    Random random{seed};
    const Extent extent{static_cast<std::uint8_t>(GetParam())};
    constexpr std::size_t memory = 64 << 10;
    PageRevisions revisions{memory};
    Model model;
    std::size_t most = 0;
    for (Revision revision = 1; revision <= 20'000; ++revision) {
        const TexelBox box = random.box(extent.side_texels());
        revisions.mark(box, revision);
        model.marks.push_back({box, revision});
        most = std::max(most, revisions.used_bytes());
        if (revision % 20 != 0) continue;
        const TexelBox& near =
            model.marks[static_cast<std::size_t>(random.below(static_cast<std::int64_t>(revision)))].box;
        const PageKey page = random.page(extent, near);
        ASSERT_GE(revisions.of(page, 16), model.newest_in(box_of(page, 16)));
    }
    EXPECT_LE(most, memory / 8 * 9 + 4096);
}

TEST_P(PageRevisionsLaws, AreTheSameFromACopyAndAfterSavingAndLoading) {
    const std::uint64_t seed = fresh_seed();
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed));
    Random random{seed};
    const Extent extent{static_cast<std::uint8_t>(GetParam())};
    constexpr std::size_t memory = 128 << 10;
    PageRevisions lived{memory}, restarted{memory};
    PageRevisions before;
    std::string before_bytes;
    for (Revision revision = 1; revision <= 5'000; ++revision) {
        const TexelBox box = random.box(extent.side_texels());
        lived.mark(box, revision);
        restarted.mark(box, revision);
        if (revision % 500 == 250) {
            before = lived;
            before_bytes = before.save();
        }
        if (revision % 500 != 0) continue;
        auto loaded = PageRevisions::load(restarted.save(), memory);
        ASSERT_TRUE(loaded);
        restarted = std::move(*loaded);
        ASSERT_EQ(restarted.save(), lived.save());
        ASSERT_EQ(before.save(), before_bytes) << "a copy does not change";
    }
}

INSTANTIATE_TEST_SUITE_P(Extents, PageRevisionsLaws, testing::Values(0, 3, 12, 20, 30));

TEST(PageRevisionsLaws, SmallMovesAnnounceHardlyMorePagesThanTheyChange) {
    const std::uint64_t seed = fresh_seed();
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed));
    Random random{seed};
    const Extent extent{20};
    // A hundred thousand sprites lie where they lie; some are dragged about
    for (const std::int64_t spread : {std::int64_t{20'000}, extent.side_texels()}) {
        PageRevisions revisions;
        Revision revision = 0;
        std::vector<TexelBox> sprites;
        for (int i = 0; i < 20'000; ++i) {
            const std::int64_t x = random.below(spread), y = random.below(spread),
                               side = 16 + random.below(112);
            sprites.push_back({x, y, x + side, y + side});
            revisions.mark(sprites.back(), ++revision);
        }
        std::int64_t announced = 0, changed = 0;
        for (int drag = 0; drag < 40; ++drag) {
            TexelBox& sprite = sprites[static_cast<std::size_t>(random.below(std::ssize(sprites)))];
            const std::int64_t dx = random.below(9) - 4, dy = random.below(9) - 4;
            for (int move = 0; move < 60; ++move) {
                const TexelBox old = sprite;
                sprite = {old.x0 + dx, old.y0 + dy, old.x1 + dx, old.y1 + dy};
                const PageRevisions before = revisions;
                revisions.mark(hull(old, sprite), ++revision);
                // Every page of every level near by, and what changed of it
                for (std::uint8_t level = 0; level <= 6; ++level) {
                    const std::int64_t side = std::int64_t{page_side_texels} << level;
                    for (std::int64_t y = old.y0 / side - 2; y <= old.y1 / side + 2; ++y) {
                        for (std::int64_t x = old.x0 / side - 2; x <= old.x1 / side + 2; ++x) {
                            const PageKey page{level, static_cast<std::uint32_t>(x),
                                               static_cast<std::uint32_t>(y)};
                            if (x < 0 || y < 0 || !extent.contains(page)) continue;
                            const TexelBox all = box_of(page, 16);
                            changed += all.meets(old) || all.meets(sprite);
                            announced += revisions.of(page, 16) != before.of(page, 16);
                        }
                    }
                }
            }
        }
        std::printf("[          ] spread %lld: announced %lld, changed %lld: %.4f\n",
                    static_cast<long long>(spread), static_cast<long long>(announced),
                    static_cast<long long>(changed), double(announced) / double(changed));
        EXPECT_LE(double(announced), 1.1 * double(changed));
        EXPECT_GE(announced, changed);
    }
}

}  // namespace
}  // namespace tessera
