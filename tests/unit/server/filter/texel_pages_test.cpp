#include "server/filter/texel_pages.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "shared/math/srgb.h"
#include "tests/unit/server/filter/made_texels.h"

namespace tessera {
namespace {

std::int64_t held(std::int64_t at, std::int64_t texels, Beyond beyond) {
    if (beyond == Beyond::clamp) return std::clamp<std::int64_t>(at, 0, texels - 1);
    return (at % texels + texels) % texels;
}

TEST(PagesOfImage, AreTheAverageOfAllTexelsUnderEachTexelWhateverTheSize) {
    const std::pair<std::int32_t, std::int32_t> sizes[] = {{1, 1}, {5, 3}, {64, 32}, {300, 17}, {250, 512}};
    for (const auto& [width, height] : sizes) {
        const LinearImage image = noise_image(width, height, 21);
        for (const Beyond beyond : {Beyond::repeat, Beyond::clamp}) {
            const auto pages = pages_of_image(image, beyond);
            for (int level = 0; level <= 7; ++level)
                for (const auto& [px, py] : {std::pair{0, 0}, {-1, 2}, {1, -1}}) {
                    const auto page = pages->page(static_cast<std::uint8_t>(level), px, py, 0, {}).value();
                    for (const auto& [i, j] : {std::pair{0, 0}, {255, 255}, {3, 100}, {77, 1}}) {
                        std::uint64_t sum = 0;
                        for (std::int64_t y = 0; y < 1 << level; ++y)
                            for (std::int64_t x = 0; x < 1 << level; ++x)
                                sum += to_steps(image.row(static_cast<std::int32_t>(held(
                                    ((py * 256 + j) * (1 << level)) + y, height,
                                    beyond)))[4 * held(((px * 256 + i) * (1 << level)) + x, width, beyond) +
                                              1]);
                        const std::uint64_t half = level == 0 ? 0 : std::uint64_t{1} << (2 * level - 1);
                        ASSERT_EQ(page->steps[static_cast<std::size_t>(4 * (j * 256 + i) + 1)],
                                  (sum + half) >> 2 * level)
                            << width << 'x' << height << " level " << level << " page " << px << ',' << py;
                    }
                    EXPECT_LT(page->bound_codes, 0.004);
                }
        }
    }
}

TEST(PagesOfImage, EndInTheMeanOrTheEdgesFarUp) {
    const LinearImage image = noise_image(37, 21, 22);
    double mean = 0;
    for (std::size_t i = 0; i < image.values.size(); i += 4)
        mean += static_cast<double>(image.values[i]) * 65535;
    mean /= 37 * 21;
    const auto repeated = pages_of_image(image, Beyond::repeat)->page(30, -1, 0, 0, {}).value();
    for (std::size_t i = 0; i < repeated->steps.size(); i += 4) ASSERT_NEAR(repeated->steps[i], mean, 0.51);
    const auto clamped = pages_of_image(image, Beyond::clamp)->page(30, -1, 0, 0, {}).value();
    EXPECT_EQ(clamped->steps[4 * (256 * 255)], to_steps(image.row(20)[0]));
}

/// Counts how often it is asked; grey by the page.
class CountingTexture final : public Texture {
  public:
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        if (const auto within = check_budget(budget); !within) return within.error();
        ++asked;
        std::this_thread::sleep_for(std::chrono::milliseconds{2});
        out = LinearImage{region.width, region.height};
        for (float& v : out.values) v = static_cast<float>((region.x / 256 + region.level) % 7) / 8;
        Evaluation evaluation;
        evaluation.bound_codes = 0.25;
        return evaluation;
    }
    std::string_view kind() const noexcept override { return "counting"; }
    std::string description() const override { return "counting"; }
    std::size_t memory_bytes() const noexcept override { return 0; }
    mutable std::atomic<int> asked{0};
};

TEST(PagesOfTexture, EvaluateAPageOnceHoweverManyAskAndKeepTheLast) {
    const auto texture = std::make_shared<CountingTexture>();
    const auto pages = pages_of_texture(texture, Accuracy::exact, std::size_t{4} << 19);
    std::vector<std::thread> threads;
    for (int t = 0; t < 8; ++t)
        threads.emplace_back([&] {
            for (int x = 0; x < 4; ++x) {
                const auto page = pages->page(2, x, -5, 0, {});
                EXPECT_EQ(page.value()->steps[0], to_steps(static_cast<float>((x + 2) % 7) / 8));
                EXPECT_NEAR(page.value()->bound_codes, 0.25, 0.003);
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(texture->asked, 4);
    for (int x = 0; x < 40; ++x) EXPECT_TRUE(pages->page(2, x, 0, 0, {}));
    EXPECT_LE(pages->memory_bytes(), std::size_t{4} << 19);
    EXPECT_EQ(texture->asked, 44);
    EXPECT_TRUE(pages->page(2, 39, 0, 0, {}));
    EXPECT_EQ(texture->asked, 44);
    EXPECT_TRUE(pages->page(2, 0, 0, 0, {}));
    EXPECT_EQ(texture->asked, 45);
    EXPECT_TRUE(pages->page(2, 39, 0, 1, {}));  // Another slice is another page
    EXPECT_EQ(texture->asked, 46);
}

TEST(PagesOfTexture, GiveUpByTheBudgetAndAnswerTheNextOne) {
    const auto pages = pages_of_texture(std::make_shared<CountingTexture>(), Accuracy::high, 1 << 20);
    Budget spent;
    spent.deadline = std::chrono::steady_clock::now() - std::chrono::seconds{1};
    const auto late = pages->page(0, 0, 0, 0, spent);
    ASSERT_FALSE(late);
    EXPECT_EQ(late.error().code, ErrorCode::timed_out);
    EXPECT_TRUE(pages->page(0, 0, 0, 0, {}));
}

}  // namespace
}  // namespace tessera
