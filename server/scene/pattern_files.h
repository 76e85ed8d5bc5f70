#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "server/blocks/plan.h"

namespace tessera {

/// The files that the blocks of one scene name, out of its folder. Errors: invalid_input, io_failure; the
/// message starts with the field's path. All that is read for one scene has a limit together.
class PatternFiles final : public BlockFiles {
  public:
    /// Of decoded texels and map entries. Too little refuses rich scenes, too much lets one starve the
    /// others.
    static constexpr std::size_t max_bytes = std::size_t{1} << 30;
    static constexpr std::uint32_t max_side = 1024, max_slices = 1024, max_patterns = 65536;

    explicit PatternFiles(std::filesystem::path folder, std::size_t limit = max_bytes)
        : folder_{std::move(folder)}, bytes_left_{limit} {}

    Result<PatternImages> read_patterns(const std::string& field, const proto::PatternSet& set) override;
    Result<StoredMap> read_map(const std::string& field, const std::string& image) override;
    Result<std::shared_ptr<const Texture>> read_exchange(const std::string& field,
                                                         const proto::Block& block) override;

  private:
    Result<PatternImages> read_sheet(const std::string& field, const proto::PatternSet& set);
    Result<PatternImages> read_files(const std::string& field, const proto::PatternSet& set);
    std::int64_t texels_left(std::size_t bytes_each) const noexcept;

    const std::filesystem::path folder_;
    std::size_t bytes_left_;
    std::size_t exchange_bytes_ = 0;
};

}  // namespace tessera
