#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "server/scene/pattern_files.h"
#include "server/scene/scene_document.h"

namespace tessera {

/// The files of a scene's blocks, read once: what a field says is the key. All members may be called from any
/// thread.
class KeptFiles {
  public:
    explicit KeptFiles(std::filesystem::path folder) : files_{std::move(folder)} {}

    Result<std::shared_ptr<const PatternImages>> patterns(const std::string& field,
                                                          const proto::PatternSet& set);
    Result<StoredMap> map(const std::string& field, const std::string& image);
    Result<std::shared_ptr<const Texture>> exchange(const std::string& field, const proto::Block& block);

  private:
    std::mutex mutex_;  ///< Guards what follows.
    PatternFiles files_;
    std::map<std::string, std::shared_ptr<const PatternImages>> patterns_;
    std::map<std::string, StoredMap> maps_;
    std::map<std::string, std::shared_ptr<const Texture>> exchanges_;
};

/// Kept files, with maps as edits left them.
class EditedFiles final : public BlockFiles {
  public:
    EditedFiles(KeptFiles& files, const PaintedMaps& painted) : files_{files}, painted_{painted} {}

    Result<PatternImages> read_patterns(const std::string& field, const proto::PatternSet& set) override;
    Result<std::shared_ptr<const PatternImages>> share_patterns(const std::string& field,
                                                                const proto::PatternSet& set) override {
        return files_.patterns(field, set);
    }
    Result<StoredMap> read_map(const std::string& field, const std::string& image) override {
        return files_.map(field, image);
    }
    Result<std::shared_ptr<const Texture>> read_exchange(const std::string& field,
                                                         const proto::Block& block) override {
        return files_.exchange(field, block);
    }
    const StoredMap* painted(const std::string& block) const override {
        const auto found = painted_.find(block);
        return found == painted_.end() ? nullptr : &found->second;
    }

  private:
    KeptFiles& files_;
    const PaintedMaps& painted_;
};

}  // namespace tessera
