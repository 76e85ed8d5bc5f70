#include "server/pages/page_service.h"

#include <future>

#include <gtest/gtest.h>

#include "server/texture/constant_texture.h"
#include "tests/unit/server/pages/stepped_texture.h"
#include "tests/unit/server/pages/test_textures.h"

namespace tessera {
namespace {

using test::eventually;
using test::GatedTexture;
using test::make_scene;

struct Asked {
    PageService::Ticket ticket;
    std::future<Result<PagePtr>> result;
};

Asked ask(PageService& pages, const PageRequest& request) {
    const auto promise = std::make_shared<std::promise<Result<PagePtr>>>();
    Asked asked;
    asked.result = promise->get_future();
    asked.ticket =
        pages.request(request, [promise](Result<PagePtr> page) { promise->set_value(std::move(page)); });
    return asked;
}

class PageServiceTest : public testing::Test {
  protected:
    PageRequest page(std::uint32_t x, std::uint8_t level = 0, Urgency urgency = {}) const {
        return {scene, {level, x, 0}, {}, urgency};
    }

    std::shared_ptr<GatedTexture> texture = std::make_shared<GatedTexture>();
    ScenePtr scene = make_scene("gated", texture);
    prometheus::Registry registry;
};

TEST_F(PageServiceTest, EvaluatesAPageOnceForAThousandWhoAsk) {
    PageService pages{{.threads = 2}, registry};
    std::vector<Asked> all;
    for (int i = 0; i < 1000; ++i) all.push_back(ask(pages, page(0)));
    texture->open();
    const PagePtr first = all.front().result.get().value();
    for (std::size_t i = 1; i < all.size(); ++i) EXPECT_EQ(all[i].result.get().value(), first);
    EXPECT_EQ(texture->begun, 1);
    EXPECT_EQ(pages.metrics().requests(PageResult::coalesced), 999);
    EXPECT_EQ(pages.metrics().requests(PageResult::evaluated), 1);
}

TEST_F(PageServiceTest, FindsAPageInTheCacheOnceItWasMade) {
    PageService pages{{}, registry};
    texture->open();
    EXPECT_EQ(pages.find(page_id(page(3)), page(3)), nullptr);
    const PagePtr made = ask(pages, page(3)).result.get().value();
    EXPECT_EQ(pages.find(page_id(page(3)), page(3)), made);
    EXPECT_EQ(ask(pages, page(3)).result.get().value(), made);
    EXPECT_EQ(texture->begun, 1);
    EXPECT_EQ(made->evaluation.work, 7u);
}

/// Changes every ten steps.
class MovingTexture final : public Texture {
  public:
    using Texture::evaluate;
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget&, LinearImage& out) const override {
        ++evaluations;
        out = LinearImage{region.width, region.height};
        const std::int64_t tens = region.step >= 0 ? region.step / 10 : -((9 - region.step) / 10);
        std::fill(out.values.begin(), out.values.end(), static_cast<float>(tens % 7 + 8) / 16);
        Evaluation evaluation{.method = "moving", .work = 1};
        evaluation.validity = {tens * 10, tens * 10 + 10};
        if (region.level > 3) evaluation.validity = {};
        return evaluation;
    }
    std::string_view kind() const noexcept override { return "moving"; }
    std::string description() const override { return "moving"; }
    std::size_t memory_bytes() const noexcept override { return 0; }
    mutable std::atomic<int> evaluations = 0;
};

TEST_F(PageServiceTest, ServesAPageFromTheCacheForEveryStepInWhichItIsTheSame) {
    const auto moving = std::make_shared<MovingTexture>();
    const auto animated = std::make_shared<Scene>(*make_scene("moving", moving));
    animated->animated = true;
    const auto at = [&](std::int64_t step, std::uint8_t level = 0) {
        PageRequest request{animated, {level, 0, 0}, {}, {}};
        request.options.step = step;
        return request;
    };
    PageService pages{{}, registry};
    EXPECT_EQ(pages.id_of(at(3)), std::nullopt);
    const PagePtr first = ask(pages, at(3)).result.get().value();
    EXPECT_EQ(first->evaluation.validity, (Validity{0, 10}));
    for (std::int64_t step = 0; step < 10; ++step) {
        EXPECT_EQ(pages.id_of(at(step)), first->id);
        EXPECT_EQ(ask(pages, at(step)).result.get().value(), first);
    }
    EXPECT_EQ(moving->evaluations, 1);
    const PagePtr later = ask(pages, at(10)).result.get().value();
    EXPECT_NE(later->id, first->id);
    EXPECT_EQ(ask(pages, at(-1)).result.get().value()->evaluation.validity, (Validity{-10, 0}));
    EXPECT_EQ(moving->evaluations, 3);

    // At rest: one page for all steps
    const PagePtr still = ask(pages, at(5, 4)).result.get().value();
    EXPECT_EQ(still->id, page_id(at(77, 4)));
    EXPECT_EQ(ask(pages, at(1'000'000'000'000'000, 4)).result.get().value(), still);
    EXPECT_EQ(moving->evaluations, 4);
}

TEST_F(PageServiceTest, NamesAPageAlikeWhicheverOfItsStepsCameFirst) {
    const auto moving = std::make_shared<MovingTexture>();
    const auto animated = std::make_shared<Scene>(*make_scene("moving", moving));
    animated->animated = true;
    std::optional<PageId> id;
    for (const std::int64_t step : {40, 49, 45}) {
        prometheus::Registry of_this;
        PageService pages{{}, of_this};
        PageRequest request{animated, {0, 0, 0}, {}, {}};
        request.options.step = step;
        const PagePtr page = ask(pages, request).result.get().value();
        if (id) {
            EXPECT_EQ(page->id, *id);
        }
        id = page->id;
    }
}

TEST_F(PageServiceTest, DropsAQueuedPageWhenTheLastAskerLeaves) {
    PageService pages{{.threads = 1}, registry};
    Asked running = ask(pages, page(0));
    ASSERT_TRUE(eventually([&] { return texture->begun == 1; }));
    { const Asked one = ask(pages, page(1)), two = ask(pages, page(1)); }
    texture->open();
    EXPECT_TRUE(running.result.get().has_value());
    EXPECT_TRUE(ask(pages, page(2)).result.get().has_value());  // the only thread has been past page 1
    EXPECT_EQ(texture->begun, 2);
}

TEST_F(PageServiceTest, KeepsAPageThatOneAskerStillWaitsFor) {
    PageService pages{{.threads = 1}, registry};
    Asked stays = ask(pages, page(0));
    { const Asked leaves = ask(pages, page(0)); }
    texture->open();
    EXPECT_TRUE(stays.result.get().has_value());
    EXPECT_EQ(texture->stopped, 0);
}

TEST_F(PageServiceTest, StopsARunningEvaluationWhenTheLastAskerLeaves) {
    PageService pages{{.threads = 1}, registry};
    {
        const Asked leaves = ask(pages, page(0));
        ASSERT_TRUE(eventually([&] { return texture->begun == 1; }));
    }
    EXPECT_TRUE(eventually([&] { return texture->stopped == 1; }));
    Asked again = ask(pages, page(0));  // does not join the evaluation that was stopped
    texture->open();
    EXPECT_TRUE(again.result.get().has_value());
}

TEST_F(PageServiceTest, MakesUrgentPagesFirstAndCoarseBeforeFine) {
    PageService pages{{.threads = 1}, registry};
    std::vector<Asked> all;
    all.push_back(ask(pages, page(9)));
    ASSERT_TRUE(eventually([&] { return texture->begun == 1; }));
    all.push_back(ask(pages, page(1, 0, {5})));
    all.push_back(ask(pages, page(2, 0, {3})));
    all.push_back(ask(pages, page(3, 4, {3})));
    all.push_back(ask(pages, page(4, 0, {0})));
    all.push_back(ask(pages, page(5, 0, {7})));
    all.push_back(ask(pages, page(5, 0, {1})));  // joins, and pulls the page forward
    texture->open();
    for (Asked& asked : all) ASSERT_TRUE(asked.result.get().has_value());
    std::vector<std::int64_t> order;
    for (const TexelRegion& region : texture->order()) order.push_back(region.x / page_side_texels);
    EXPECT_EQ(order, (std::vector<std::int64_t>{9, 4, 5, 3, 2, 1}));
}

TEST_F(PageServiceTest, RefusesWhatDoesNotFitIntoTheQueueButMakesRoomForTheUrgent) {
    PageService pages{{.threads = 1, .queued_pages = 2}, registry};
    Asked running = ask(pages, page(0));
    ASSERT_TRUE(eventually([&] { return texture->begun == 1; }));
    Asked first = ask(pages, page(1)), second = ask(pages, page(2));
    Asked refused = ask(pages, page(3));
    EXPECT_EQ(refused.result.get().error().code, ErrorCode::overloaded);
    Asked urgent = ask(pages, page(4, 0, {0}));
    EXPECT_EQ(second.result.get().error().code, ErrorCode::overloaded);
    texture->open();
    EXPECT_TRUE(urgent.result.get().has_value());
    EXPECT_TRUE(first.result.get().has_value());
    EXPECT_EQ(pages.metrics().requests(PageResult::overloaded), 2);
}

TEST_F(PageServiceTest, GivesUpAnEvaluationAtItsDeadline) {
    PageService pages{{.threads = 1, .deadline = std::chrono::milliseconds{20}}, registry};
    EXPECT_EQ(ask(pages, page(0)).result.get().error().code, ErrorCode::timed_out);
    EXPECT_EQ(pages.metrics().requests(PageResult::timed_out), 1);
}

TEST_F(PageServiceTest, AnswersEverybodyWhenItStops) {
    PageService pages{{.threads = 1}, registry};
    Asked running = ask(pages, page(0)), queued = ask(pages, page(1));
    pages.stop();
    EXPECT_EQ(running.result.get().error().code, ErrorCode::cancelled);
    EXPECT_EQ(queued.result.get().error().code, ErrorCode::cancelled);
    EXPECT_FALSE(ask(pages, page(2)).result.get().has_value());
}

TEST_F(PageServiceTest, GivesTheSameBytesFromOneThreadAndFromEight) {
    texture->open();
    prometheus::Registry other;
    PageService one{{.threads = 1}, registry}, eight{{.threads = 8}, other};
    for (const PageFormat format : page_formats) {
        std::vector<Asked> few, many;
        for (std::uint32_t x = 0; x < 16; ++x) {
            PageRequest request = page(x, 2);
            request.options = {format, ContentCoding::identity, 3, Accuracy::high};
            few.push_back(ask(one, request));
            many.push_back(ask(eight, request));
        }
        for (std::size_t i = 0; i < few.size(); ++i)
            EXPECT_EQ(*few[i].result.get().value()->bytes, *many[i].result.get().value()->bytes)
                << extension(format);
    }
}

TEST_F(PageServiceTest, TakesTheCheapestAccuracyWhoseBoundKeepsTheLimit) {
    PageService pages{{}, registry};
    const ScenePtr stepped = make_scene("stepped", std::make_shared<test::SteppedTexture>());
    const auto within = [&](std::optional<ErrorLimit> limit) {
        PageRequest request{stepped, {}, {}, {}};
        request.options.max_error = limit;
        return ask(pages, request).result.get().value();
    };
    const auto limit = [](std::uint32_t millionths) { return ErrorLimit{millionths}; };
    EXPECT_EQ(within(limit(4'000'000))->evaluation.method, "fast");
    EXPECT_EQ(within(limit(3'999'999))->evaluation.method, "high");
    EXPECT_EQ(within(limit(1'000'000))->accuracy, Accuracy::high);
    EXPECT_EQ(within(limit(250'000))->evaluation.method, "exact");
    EXPECT_TRUE(within(limit(250'000))->within_limit);
    EXPECT_FALSE(within(limit(249'999))->within_limit);
    EXPECT_EQ(within(limit(249'999))->evaluation.bound_codes, 0.25);
    EXPECT_EQ(within({})->evaluation.method, "high");
    EXPECT_TRUE(within({})->within_limit);
    EXPECT_EQ(within(limit(1'000'000))->evaluation.work, 20u);  // what was tried has cost something too
    EXPECT_NEAR(within(limit(1'000'000))->evaluation.confidence, 0.98, 1e-12);
    EXPECT_EQ(within(limit(250'000))->evaluation.confidence, 1);
}

TEST_F(PageServiceTest, SharesTheBytesOfPagesOfOneColour) {
    const ScenePtr sky = make_scene("sky", make_constant_texture({90, 140, 220, 255}), "sky");
    PageService pages{{}, registry};
    const PagePtr one = ask(pages, {sky, {0, 1, 1}, {}, {}}).result.get().value();
    const PagePtr two = ask(pages, {sky, {3, 2, 0}, {}, {}}).result.get().value();
    EXPECT_EQ(one->bytes, two->bytes);
    EXPECT_NE(one->id, two->id);
}

TEST_F(PageServiceTest, SurvivesAskersThatComeAndGoOnManyThreads) {
    texture->open();
    PageService pages{{.threads = 3, .queued_pages = 8, .cache_bytes = 1 << 20}, registry};
    std::vector<std::thread> askers;
    std::atomic<int> answered = 0;
    for (std::uint32_t thread = 0; thread < 4; ++thread) {
        askers.emplace_back([&, thread] {
            for (std::uint32_t i = 0; i < 100; ++i) {
                Asked asked = ask(pages, page((i * 7 + thread) % 23, 0, {static_cast<std::uint8_t>(i % 8)}));
                if (i % 3 == 0) continue;  // leaves at once
                const auto page = asked.result.get();
                if (page || page.error().code == ErrorCode::overloaded) ++answered;
            }
        });
    }
    for (std::thread& asker : askers) asker.join();
    EXPECT_EQ(answered, 4 * 66);
    EXPECT_LE(pages.cache_usage().bytes, std::size_t{1} << 20);
}

}  // namespace
}  // namespace tessera
