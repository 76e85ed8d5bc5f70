#include "client/residency/page_holds.h"

#include <gtest/gtest.h>

#include "client/residency/residency.h"
#include "tests/unit/client/residency/fake_page_source.h"

namespace tessera {
namespace {

constexpr PageKey left_page{0, 10, 10}, right_page{0, 11, 10};

/// What both pages show.
PageHold hold_of(std::uint32_t id, std::uint64_t revision, bool waits = true) {
    return {.id = id,
            .boxes = {{11 * 256 - 10, 2600, 11 * 256 + 10, 2700}},
            .waits = waits,
            .revision = revision};
}

ArrivedPage arrived(PageKey page, std::uint64_t scene_revision) {
    return {.page = page,
            .texels = std::string(slot_bytes, 'x'),
            .version = {.revision = scene_revision, .scene_revision = scene_revision}};
}

std::vector<std::uint32_t> ids(const std::vector<PageHold>& holds) {
    std::vector<std::uint32_t> ids;
    for (const PageHold& hold : holds) ids.push_back(hold.id);
    return ids;
}

const std::vector<NeededPage> needed{{left_page, 10}, {right_page, 10}};
const auto nothing_settled = [](PageKey, std::uint64_t) { return false; };

TEST(PageHolds, NewerPagesWaitUntilAllThatTheEditTouchesHaveCome) {
    PageHolds holds{128};
    holds.set({hold_of(1, 5)});
    EXPECT_FALSE(holds.keeps({0, 40, 40}, {.revision = 5, .scene_revision = 5})) << "elsewhere";
    EXPECT_FALSE(holds.keeps(left_page, {.revision = 3, .scene_revision = 4})) << "without the edit";
    ASSERT_TRUE(holds.keeps(left_page, {.revision = 5, .scene_revision = 5}));
    holds.keep(arrived(left_page, 5));
    EXPECT_TRUE(holds.end_complete(needed, nothing_settled).empty());
    EXPECT_TRUE(holds.take_free().empty());
    holds.keep(arrived(right_page, 5));
    EXPECT_EQ(ids(holds.end_complete(needed, nothing_settled)), std::vector<std::uint32_t>{1});
    EXPECT_EQ(holds.take_free().size(), 2u) << "in one frame";
    EXPECT_TRUE(holds.empty());
}

TEST(PageHolds, APageThatTheEditDidNotChangeIsNotWaitedFor) {
    PageHolds holds{128};
    holds.set({hold_of(1, 5)});
    holds.keep(arrived(left_page, 5));
    const auto settled = [](PageKey page, std::uint64_t) { return page == right_page; };
    EXPECT_EQ(holds.end_complete(needed, settled).size(), 1u);
}

TEST(PageHolds, WhileTheRevisionIsNotKnownNothingComesAndNothingEnds) {
    PageHolds holds{128};
    holds.set({hold_of(1, 0)});
    EXPECT_TRUE(holds.keeps(left_page, {.revision = 1, .scene_revision = 1}));
    holds.keep(arrived(left_page, 9));
    holds.keep(arrived(right_page, 9));
    EXPECT_TRUE(holds.end_complete(needed, nothing_settled).empty());
}

TEST(PageHolds, BeforeAnEditIsSentPagesComeAsEver) {
    PageHolds holds{128};
    holds.set({hold_of(1, 0, false)});
    EXPECT_FALSE(holds.keeps(left_page, {.revision = 1, .scene_revision = 1}));
}

TEST(PageHolds, APageThatShowsALaterEditTooWaitsForThatOne) {
    PageHolds holds{128};
    holds.set({hold_of(1, 5), hold_of(2, 6)});
    holds.keep(arrived(left_page, 6));
    holds.keep(arrived(right_page, 5));
    EXPECT_TRUE(holds.end_complete(needed, nothing_settled).empty())
        << "the left one would show edit 6 early";
    holds.keep(arrived(right_page, 6));
    EXPECT_EQ(ids(holds.end_complete(needed, nothing_settled)), (std::vector<std::uint32_t>{1, 2}));
    EXPECT_EQ(holds.take_free().size(), 2u);
}

TEST(PageHolds, OfOnePageTheNewestWaitsAndOneThatIsNoLongerHeldIsFree) {
    PageHolds holds{128};
    holds.set({hold_of(1, 5)});
    holds.keep(arrived(left_page, 7));
    holds.keep(arrived(left_page, 5));
    EXPECT_EQ(holds.kept(left_page)->version.revision, 7u);
    holds.set({});  // the caller does not wait any longer
    EXPECT_EQ(holds.take_free().size(), 1u);
}

/// Pages whose texels say how many sprites were left out of them.
class LiftingSource final : public testing::FakePageSource {
  public:
    LiftingSource() : FakePageSource{testing::blank_page} {}
    bool request(const PageRequest& request) override {
        if (request.without.empty()) return FakePageSource::request(request);
        lifted.push_back(request);
        return true;
    }
    std::vector<ArrivedPage> take_arrived(std::size_t most) override {
        auto arrived = FakePageSource::take_arrived(most);
        if (delivers)
            for (const PageRequest& request : std::exchange(lifted, {}))
                arrived.push_back(
                    {.id = request.id,
                     .page = request.page,
                     .texels = std::string(slot_bytes, static_cast<char>(request.without.size()))});
        return arrived;
    }
    std::vector<PageRequest> lifted;
    bool delivers = true;
};

TEST(StandIns, AreShownOutOfSlotsOfTheirOwnForAsLongAsAHoldLifts) {
    LiftingSource source;
    Residency residency{Extent{8}, source, {}};
    const PlaneView view{{.ground = {5000, 5000}, .height_texels = 300, .pitch_degrees = -90}, 320, 240};
    ClientTime now{0};
    const auto settle = [&] {
        ResidencyFrame frame;
        for (int i = 0; i < 50; ++i) frame = residency.update(view, now += ClientTime{16});
        return frame;
    };
    ASSERT_TRUE(settle().is_sharp());
    const auto slot = [&] { return residency.table().shown_for({0, 19, 19})->slot; };
    const Slot itself = slot();
    source.delivers = false;
    const PageHold hold{
        .id = 1, .lifted = {7, 9}, .lifted_boxes = {{5000, 5000, 5010, 5010}, {5005, 5005, 5015, 5015}}};
    residency.hold({hold});
    settle();
    EXPECT_EQ(slot(), itself) << "nothing has come yet";
    EXPECT_FALSE(source.lifted.empty());
    EXPECT_EQ(source.lifted.front().without, (std::vector<std::uint64_t>{7, 9}));
    source.delivers = true;
    const ResidencyFrame shown = settle();
    EXPECT_GE(slot(), residency.cache().capacity());
    EXPECT_LT(slot(), residency.slots());
    EXPECT_TRUE(shown.is_sharp());
    residency.hold({});
    residency.update(view, now += ClientTime{16});
    EXPECT_EQ(slot(), itself) << "in the very next frame";
}

}  // namespace
}  // namespace tessera
