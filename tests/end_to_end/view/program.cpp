#include "tests/end_to_end/view/program.h"

#include <chrono>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace tessera::testing {

using Clock = std::chrono::steady_clock;

Program::Program(std::vector<std::string> command) {
    int out[2], error[2];
    if (pipe2(out, O_CLOEXEC) != 0 || pipe2(error, O_CLOEXEC) != 0) throw std::runtime_error{"no pipes"};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, out[1], 1);
    posix_spawn_file_actions_adddup2(&actions, error[1], 2);
    std::vector<char*> words;
    for (std::string& word : command) words.push_back(word.data());
    words.push_back(nullptr);
    const int failed = posix_spawn(&pid_, words[0], &actions, nullptr, words.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(out[1]);
    ::close(error[1]);
    out_file_ = out[0];
    error_file_ = error[0];
    if (failed != 0) {
        pid_ = -1;
        throw std::runtime_error{"cannot start " + command[0]};
    }
}

Program::~Program() {
    if (pid_ > 0) {
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
    if (out_file_ >= 0) ::close(out_file_);
    if (error_file_ >= 0) ::close(error_file_);
}

bool Program::read_some(int& file, std::string& text, int timeout_ms) {
    pollfd ready{file, POLLIN, 0};
    if (file < 0 || ::poll(&ready, 1, timeout_ms) <= 0) return false;
    char block[4096];
    const ssize_t count = ::read(file, block, sizeof block);
    if (count <= 0) {
        ::close(std::exchange(file, -1));
        return false;
    }
    text.append(block, static_cast<std::size_t>(count));
    return true;
}

std::string Program::first_line() {
    const auto until = Clock::now() + std::chrono::seconds{30};
    while (out_.find('\n') == std::string::npos && out_file_ >= 0 && Clock::now() < until) {
        read_some(out_file_, out_, 100);
        read_some(error_file_, error_, 0);
    }
    const std::size_t end = out_.find('\n');
    return end == std::string::npos ? std::string{} : out_.substr(0, end);
}

std::string Program::line_after(const std::string& text) {
    const auto until = Clock::now() + std::chrono::seconds{30};
    for (;;) {
        const std::size_t at = out_.find(text);
        const std::size_t end = at == std::string::npos ? at : out_.find('\n', at);
        if (end != std::string::npos) {
            const std::string rest = out_.substr(at + text.size(), end - at - text.size());
            out_.erase(0, end + 1);
            return rest;
        }
        if (out_file_ < 0 || Clock::now() > until) return {};
        read_some(out_file_, out_, 50);
        read_some(error_file_, error_, 0);
    }
}

Program::Ended Program::end() {
    const auto until = Clock::now() + std::chrono::seconds{60};
    while ((out_file_ >= 0 || error_file_ >= 0) && Clock::now() < until) {
        read_some(out_file_, out_, 20);
        read_some(error_file_, error_, 20);
    }
    Ended ended{-1, out_, error_};
    if (Clock::now() >= until) return ended;
    int status = 0;
    ::waitpid(std::exchange(pid_, -1), &status, 0);
    if (WIFEXITED(status)) ended.exit_code = WEXITSTATUS(status);
    return ended;
}

Program::Ended run_view(const std::vector<std::string>& arguments) {
    std::vector<std::string> command{VIEW_PROGRAM};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return Program{command}.end();
}

}  // namespace tessera::testing
