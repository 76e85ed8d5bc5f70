// Versions come in any order, twice, of scenes that are over and for steps that are past or to come; what is
// held never grows older.
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "client/residency/page_versions.h"

namespace tessera {
namespace {

using Verdict = PageVersions::Verdict;

TEST(PageVersions, NeverGoBackWhateverTheOrderOfArrival) {
    std::mt19937 random{17};
    const auto below = [&](unsigned count) { return static_cast<unsigned>(random() % count); };
    PageVersions versions;
    std::map<PageKey, PageVersion> shown;
    std::uint32_t history = 0;
    Step now = 0;
    int replaced = 0, dropped = 0, early = 0;
    for (int step = 0; step < 300'000; ++step) {
        const PageKey page{0, below(6), 0};
        if (below(500) == 0) now += below(20);
        if (below(20'000) == 0) ++history;
        if (below(40) == 0) {
            versions.learn({.history = history,
                            .told_revision = below(50),
                            .stale = {{page, below(50)}},
                            .unsure_before = below(100) == 0 ? below(50) : 0},
                           [](PageKey) { return false; });
            continue;
        }
        if (below(2'000) == 0) {
            versions.forget(page);
            shown.erase(page);
            continue;
        }
        PageVersion version{.history = history - (history > 0 && below(4) == 0 ? 1 : 0),
                            .revision = below(1 + static_cast<unsigned>(step % 20'000) / 400)};
        version.scene_revision = version.revision + below(3);
        if (below(3) > 0) {
            version.validity.from = now - 10 + below(20);
            version.validity.until = version.validity.from + 1 + below(10);
        }
        const Verdict verdict = versions.offer(page, version, now);
        dropped += verdict == Verdict::drop ? 1 : 0;
        early += verdict == Verdict::early ? 1 : 0;
        const auto before = shown.find(page);
        if (verdict == Verdict::show) {
            if (before != shown.end()) {
                ++replaced;
                const PageVersion& old = before->second;
                ASSERT_GE(version.history, old.history);
                if (version.history == old.history) {
                    ASSERT_GE(version.revision, old.revision);
                    if (version.revision == old.revision) {
                        ASSERT_FALSE(old.validity.holds(now)) << "nothing was wrong with the old one";
                        ASSERT_LE(version.validity.from, now);
                    }
                }
            }
            shown[page] = version;
        } else if (before == shown.end()) {
            ASSERT_EQ(verdict, Verdict::drop) << "something is better than nothing";
            versions.forget_expected(page);
        }
        const PageVersion* held = versions.held(page);
        ASSERT_EQ(held != nullptr, shown.contains(page));
        if (held) {
            ASSERT_EQ(held->revision, shown[page].revision);
            ASSERT_EQ(held->history, shown[page].history);
            ASSERT_EQ(held->validity, shown[page].validity);
            if (!held->validity.holds(now)) {
                ASSERT_TRUE(versions.is_stale(page, now));
            }
        }
    }
    EXPECT_GT(replaced, 300);
    EXPECT_GT(dropped, 1000);
    EXPECT_GT(early, 1000);
}

}  // namespace
}  // namespace tessera
