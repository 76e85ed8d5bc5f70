#pragma once

#include <memory>
#include <string>

#include "server/blocks/plan.h"
#include "tests/support/made_patterns.h"

namespace tessera {

/// Any pattern set is `count` patterns of random texels (made_patterns); there are no other files.
class RandomPatternFiles final : public BlockFiles {
  public:
    explicit RandomPatternFiles(std::int32_t count) : count_{count} {}

    Result<PatternImages> read_patterns(const std::string&, const proto::PatternSet& set) override {
        return made_patterns(static_cast<std::int32_t>(set.side_texels()), count_);
    }
    Result<StoredMap> read_map(const std::string& field, const std::string&) override {
        return Error{ErrorCode::invalid_input, field + ": no such file"};
    }
    Result<std::shared_ptr<const Texture>> read_exchange(const std::string&, const proto::Block&) override {
        return std::shared_ptr<const Texture>{};
    }

  private:
    std::int32_t count_;
};

}  // namespace tessera
