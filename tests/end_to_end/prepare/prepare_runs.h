#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "server/scene/image_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/server/prepare/made_photo.h"

namespace tessera {

struct Outcome {
    int exit_code = 0;
    std::string output;  ///< stdout and stderr
};

/// A folder in which `tessera` is run as a person runs it.
class PrepareRuns : public testing::Test {
  protected:
    Outcome run(const std::string& arguments) {
        const std::string command = "cd '" + folder_.string() + "' && '" TESSERA "' " + arguments + " >'" +
                                    log_.string() + "' 2>&1 </dev/null";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(log_)};
    }

    void write_photo(const std::string& name, std::int32_t width, std::int32_t height,
                     std::uint64_t seed = 7) {
        ASSERT_TRUE(write_rgb_png(folder_ / name, test::made_photo(width, height, seed)));
    }

    static std::string text_of(const std::filesystem::path& file) {
        std::ifstream in{file, std::ios::binary};
        return {std::istreambuf_iterator<char>{in}, {}};
    }

    /// Hidden ones too: what was not finished would be one of these.
    std::size_t entries() const {
        return std::size_t(std::distance(std::filesystem::directory_iterator{folder_}, {}));
    }

    const tests::TemporaryFolder temporary_, elsewhere_;
    const std::filesystem::path folder_ = temporary_.path;
    const std::filesystem::path log_ = elsewhere_.path / "log";
};

}  // namespace tessera
