#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

namespace tessera::testing {

/// A program that runs beside the test; killed when this goes.
class Program {
  public:
    explicit Program(std::vector<std::string> command);
    ~Program();
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    /// The first line on stdout, without its end; empty if none comes within half a minute.
    std::string first_line();
    struct Ended {
        int exit_code = -1;  ///< −1: it did not end within the time, or by a signal
        std::string out;
        std::string error;
    };
    /// Waits for its end, at most a minute.
    Ended end();

  private:
    bool read_some(int& file, std::string& text, int timeout_ms);

    pid_t pid_ = -1;
    int out_file_ = -1, error_file_ = -1;
    std::string out_, error_;
};

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

/// Runs tessera-view to its end.
Program::Ended run_view(const std::vector<std::string>& arguments);

}  // namespace tessera::testing
