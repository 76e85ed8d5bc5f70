#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "tests/end_to_end/view/program.h"

namespace tessera::testing {

/// `tessera serve` with three scenes in a folder of its own, which goes with it: `board` (checker), `grey`
/// (constant) and `noise` (content exchange of noise, 2^38 texels a side).
class SceneServer {
  public:
    SceneServer();
    ~SceneServer();

    const std::string& url() const { return url_; }
    const std::filesystem::path& folder() const { return folder_; }  ///< For the test's files too

  private:
    std::filesystem::path folder_;
    std::unique_ptr<Program> program_;
    std::string url_;
};

}  // namespace tessera::testing
