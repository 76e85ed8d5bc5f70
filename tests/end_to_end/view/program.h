#pragma once

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
    /// The rest of the next line on stdout that has this in it, and forgets all up to there; empty if none
    /// comes within half a minute.
    std::string line_after(const std::string& text);
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

/// Runs tessera-view to its end.
Program::Ended run_view(const std::vector<std::string>& arguments);

}  // namespace tessera::testing
