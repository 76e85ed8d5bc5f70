#pragma once

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "tests/unit/server/journal/engines.h"

namespace tessera::tests {

/// A journal of each engine, each test in a folder of its own.
class JournalConformance : public testing::TestWithParam<Engine> {
  protected:
    std::unique_ptr<Journal> open(JournalOptions options = scene_options()) {
        return GetParam().open(temporary_.path / "journal", std::move(options));
    }
    static std::vector<Edit> history(Journal& journal, Revision from, Revision through) {
        std::vector<Edit> edits;
        const auto trouble = for_each_edit(journal, from, through, [&](const Edit& edit) {
            edits.push_back(edit);
            return true;
        });
        EXPECT_FALSE(trouble) << "no history from " << from;
        return edits;
    }
    static RefusalReason refusal(const AppendOutcome& outcome) {
        const auto* const refused = std::get_if<Refused>(&outcome);
        EXPECT_NE(refused, nullptr) << "not refused";
        if (refused == nullptr) return RefusalReason::unavailable;
        EXPECT_FALSE(refused->detail.empty());
        return refused->why;
    }

    TemporaryFolder temporary_;
};

}  // namespace tessera::tests
