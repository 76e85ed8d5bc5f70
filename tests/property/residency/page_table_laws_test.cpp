#include <algorithm>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "client/residency/page_table.h"

namespace tessera {
namespace {

/// The same contract, said with a map and no window: slow and plain.
class Model {
  public:
    explicit Model(Extent extent) : extent_{extent} {}
    void show(PageKey page, ShownPage where) { resident_[page] = where; }
    void hide(PageKey page) {
        resident_.erase(page);
        instead_.erase(page);
    }
    void show_instead(PageKey page, ShownPage where) { instead_[page] = where; }
    void show_itself(PageKey page) { instead_.erase(page); }
    const std::map<PageKey, ShownPage>& instead() const { return instead_; }
    std::map<PageKey, ShownPage>& resident() { return resident_; }

    TableEntry entry(std::uint8_t level, std::int64_t x, std::int64_t y) const {
        TableEntry entry{TableEntry::nothing, static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), 0};
        const std::int64_t side = extent_.side_pages(level);
        if (x < 0 || y < 0 || x >= side || y >= side) return entry;
        for (PageKey page{level, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)};
             page.level <= extent_.n; page = parent(page)) {
            const auto found = resident_.find(page);
            if (found == resident_.end()) continue;
            const auto instead = instead_.find(page);
            const ShownPage& where = instead == instead_.end() ? found->second : instead->second;
            entry.shown = std::uint32_t{where.slot} | std::uint32_t{where.level} << 16;
            entry.arrival_ms = where.arrival_ms;
            break;
        }
        return entry;
    }

  private:
    Extent extent_;
    std::map<PageKey, ShownPage> resident_;
    std::map<PageKey, ShownPage> instead_;
};

/// A table and its model on the same random walk: steps, jumps, teleports to the far corners, pages that come
/// (mostly near the centre, at every level) and go.
class RandomWalk {
  public:
    RandomWalk(Extent extent, int side, unsigned seed)
        : extent_{extent}, side_{side}, table_{extent, side}, model_{extent}, random_{seed} {}

    void step() {
        const std::uint64_t dice = below(100);
        if (dice < 40) {
            move_by(below(1024), below(1024), 512);
        } else if (dice < 50) {
            const int shift = static_cast<int>(below(extent_.n + 8u));
            move_by(below(2) << shift, below(2) << shift, (std::int64_t{1} << shift) / 2);
        } else if (dice < 53) {
            const std::int64_t last = extent_.side_texels() - 1;
            move_to(below(2) ? last : 0, below(2) ? last : 0);
        } else if (dice < 57) {
            move_to(static_cast<std::int64_t>(below(static_cast<std::uint64_t>(extent_.side_texels()))),
                    static_cast<std::int64_t>(below(static_cast<std::uint64_t>(extent_.side_texels()))));
        } else if (dice < 82 || model_.resident().empty()) {
            const PageKey page = page_near_centre();
            const ShownPage where{static_cast<Slot>(below(512)), page.level,
                                  static_cast<std::uint32_t>(++clock_)};
            table_.show(page, where);
            model_.show(page, where);
        } else if (dice < 87) {
            // Something else is shown instead of a resident page, which may be coarser; or no longer
            auto some = model_.resident().lower_bound(page_near_centre());
            if (some == model_.resident().end()) some = model_.resident().begin();
            const PageKey page = some->first;
            if (model_.instead().contains(page)) {
                table_.show_itself(page);
                model_.show_itself(page);
            } else {
                const auto level = static_cast<std::uint8_t>(page.level + below(extent_.n + 1u - page.level));
                const ShownPage where{static_cast<Slot>(512 + below(64)), level,
                                      static_cast<std::uint32_t>(++clock_)};
                table_.show_instead(page, where);
                model_.show_instead(page, where);
            }
        } else {
            auto victim = model_.resident().lower_bound(page_near_centre());
            if (victim == model_.resident().end()) victim = model_.resident().begin();
            const PageKey page = victim->first;
            table_.hide(page);
            model_.hide(page);
        }
        if (model_.resident().size() > 400) {
            const PageKey page = model_.resident().begin()->first;
            table_.hide(page);
            model_.hide(page);
        }
    }

    /// Compares some entries, or all of them.
    ::testing::AssertionResult agrees(bool everywhere) {
        const int samples = everywhere ? 0 : 8;
        for (int i = 0; i < samples; ++i) {
            const auto level = static_cast<std::uint8_t>(below(extent_.n + 1u));
            if (auto same = same_entry(level, static_cast<int>(below(static_cast<unsigned>(side_))),
                                       static_cast<int>(below(static_cast<unsigned>(side_))));
                !same)
                return same;
        }
        for (int level = 0; everywhere && level <= extent_.n; ++level)
            for (int y = 0; y < side_; ++y)
                for (int x = 0; x < side_; ++x)
                    if (auto same = same_entry(static_cast<std::uint8_t>(level), x, y); !same) return same;
        return ::testing::AssertionSuccess();
    }

    /// What the GPU holds when only changed levels are uploaded.
    void upload_changes() {
        for (const std::uint8_t level : table_.take_changed_levels()) {
            const auto entries = table_.entries(level);
            uploaded_[level].assign(entries.begin(), entries.end());
        }
    }
    bool equals_one_built_anew() {
        PageTable fresh{extent_, side_};
        fresh.move_to(x_, y_);
        for (const auto& [page, where] : model_.resident()) fresh.show(page, where);
        for (const auto& [page, where] : model_.instead()) fresh.show_instead(page, where);
        for (int l = 0; l <= extent_.n; ++l) {
            const auto level = static_cast<std::uint8_t>(l);
            if (!std::ranges::equal(fresh.entries(level), table_.entries(level))) return false;
        }
        return true;
    }
    bool uploads_equal_the_table() {
        upload_changes();
        for (int l = 0; l <= extent_.n; ++l) {
            const auto level = static_cast<std::uint8_t>(l);
            if (!std::ranges::equal(uploaded_[level], table_.entries(level))) return false;
        }
        return true;
    }

  private:
    std::uint64_t below(std::uint64_t count) { return random_() % count; }
    void move_by(std::uint64_t x, std::uint64_t y, std::int64_t middle) {
        move_to(x_ + static_cast<std::int64_t>(x) - middle, y_ + static_cast<std::int64_t>(y) - middle);
    }
    void move_to(std::int64_t x, std::int64_t y) {
        x_ = std::clamp<std::int64_t>(x, 0, extent_.side_texels() - 1);
        y_ = std::clamp<std::int64_t>(y, 0, extent_.side_texels() - 1);
        table_.move_to(x_, y_);
    }
    PageKey page_near_centre() {
        const auto level = static_cast<std::uint8_t>(below(extent_.n + 1u));
        const std::int64_t last = extent_.side_pages(level) - 1, spread = side_ + side_ / 2;
        const auto near = [&](std::int64_t centre) {
            const auto moved =
                centre + static_cast<std::int64_t>(below(static_cast<std::uint64_t>(spread))) - spread / 2;
            return static_cast<std::uint32_t>(std::clamp<std::int64_t>(moved, 0, last));
        };
        return {level, near(x_ >> (8 + level)), near(y_ >> (8 + level))};
    }
    ::testing::AssertionResult same_entry(std::uint8_t level, int column, int row) {
        const std::int64_t x = (x_ >> (8 + level)) - side_ / 2 + column,
                           y = (y_ >> (8 + level)) - side_ / 2 + row;
        const auto mask = side_ - 1;
        const TableEntry& got =
            table_.entries(level)[static_cast<std::size_t>((y & mask) * side_ + (x & mask))];
        if (got == model_.entry(level, x, y)) return ::testing::AssertionSuccess();
        return ::testing::AssertionFailure()
               << "level " << int{level} << " page " << x << ',' << y << ": shows " << std::hex << got.shown
               << ", not " << model_.entry(level, x, y).shown;
    }

    Extent extent_;
    int side_;
    PageTable table_;
    Model model_;
    std::mt19937_64 random_;
    std::map<std::uint8_t, std::vector<TableEntry>> uploaded_;
    std::int64_t x_ = 0, y_ = 0;
    std::uint64_t clock_ = 0;
};

struct Walk {
    int n = 0, side = 0, steps = 0;
    unsigned seed = 0;
};

class ToroidalTable : public ::testing::TestWithParam<Walk> {};

TEST_P(ToroidalTable, EqualsAHashMapModelOnARandomWalk) {
    const Walk walk = GetParam();
    RandomWalk table{Extent{static_cast<std::uint8_t>(walk.n)}, walk.side, walk.seed};
    for (int step = 0; step < walk.steps; ++step) {
        table.step();
        ASSERT_TRUE(table.agrees(step % 10000 == 0)) << "after step " << step;
        if (step % 16 == 0) table.upload_changes();
        if (step % 4000 == 0) {
            ASSERT_TRUE(table.uploads_equal_the_table()) << "after step " << step;
            ASSERT_TRUE(table.equals_one_built_anew()) << "after step " << step;
        }
    }
    EXPECT_TRUE(table.agrees(true));
    EXPECT_TRUE(table.uploads_equal_the_table());
    EXPECT_TRUE(table.equals_one_built_anew());
}

/// A million steps in all.
INSTANTIATE_TEST_SUITE_P(Extents, ToroidalTable,
                         ::testing::Values(Walk{30, 32, 25'000, 11}, Walk{30, 4, 325'000, 12},
                                           Walk{12, 8, 400'000, 13}, Walk{3, 16, 250'000, 14}));

}  // namespace
}  // namespace tessera
