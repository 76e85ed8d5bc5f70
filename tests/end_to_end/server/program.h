#pragma once

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace tessera::test {

/// The program with these arguments; stdout and stderr are read through pipes.
class Program {
  public:
    using Clock = std::chrono::steady_clock;
    /// A program that nobody ran lately comes from the disk, which takes many seconds where that is slow.
    static constexpr std::chrono::seconds patience{60};

    /// `folder`: where it starts, unless empty. `file`: another program, which comes to be ours.
    explicit Program(std::vector<std::string> arguments, const std::string& folder = {},
                     const char* file = TESSERA_PROGRAM) {
        int out[2], err[2];
        EXPECT_EQ(pipe2(out, O_CLOEXEC), 0);
        EXPECT_EQ(pipe2(err, O_CLOEXEC), 0);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, out[1], 1);
        posix_spawn_file_actions_adddup2(&actions, err[1], 2);
        if (!folder.empty()) posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
        arguments.insert(arguments.begin(), file);
        std::vector<char*> words;
        for (std::string& argument : arguments) words.push_back(argument.data());
        words.push_back(nullptr);
        EXPECT_EQ(posix_spawn(&pid_, file, &actions, nullptr, words.data(), environ), 0);
        posix_spawn_file_actions_destroy(&actions);
        ::close(out[1]);
        ::close(err[1]);
        out_ = out[0];
        err_ = err[0];
    }
    /// What is left of `other` stands for no process.
    Program(Program&& other) noexcept
        : pid_{std::exchange(other.pid_, -1)},
          out_{std::exchange(other.out_, -1)},
          err_{std::exchange(other.err_, -1)},
          out_text_{std::move(other.out_text_)},
          err_text_{std::move(other.err_text_)} {}
    Program& operator=(Program&&) = delete;
    ~Program() {
        if (pid_ > 0) {
            ::kill(pid_, SIGKILL);
            ::waitpid(pid_, nullptr, 0);
        }
        ::close(out_);
        ::close(err_);
    }

    /// The line that says the server is ready; empty if it never does.
    std::string line() { return read_until(out_, out_text_, "\n"); }
    std::uint16_t port() {
        const std::string text = line();
        return static_cast<std::uint16_t>(std::atoi(text.c_str() + text.rfind(':') + 1));
    }
    bool says(const std::string& text) { return read_until(err_, err_text_, text).size() > 0; }
    /// What it said so far is not found any more.
    void forget() { err_text_.clear(); }
    const std::string& errors() const { return err_text_; }

    /// Whether the program comes to take this signal itself, which would end it before.
    bool waits_for(int number) const {
        const auto has = [](std::uint64_t mask, int signal) { return (mask >> (signal - 1) & 1) != 0; };
        for (const auto until = Clock::now() + patience; Clock::now() < until;) {
            std::ifstream status{"/proc/" + std::to_string(pid_) + "/status"};
            for (std::string text; std::getline(status, text);) {
                if (!text.starts_with("SigBlk:")) continue;
                const std::uint64_t blocked = std::stoull(text.substr(7), nullptr, 16);
                // posix_spawn() blocks every signal until the program begins
                if (has(blocked, number) && !has(blocked, SIGALRM)) return true;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
        return false;
    }
    /// Lets it have so many bytes more of address space than now.
    bool limit_memory(std::uint64_t more) const {
        std::uint64_t pages = 0;
        std::ifstream{"/proc/" + std::to_string(pid_) + "/statm"} >> pages;
        const rlim_t most = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + more;
        const rlimit limit{most, most};
        return pages != 0 && prlimit(pid_, RLIMIT_AS, &limit, nullptr) == 0;
    }
    pid_t process() const { return pid_; }
    void signal(int number) const { ::kill(pid_, number); }
    int exit_code() {
        read_until(err_, err_text_, "\x01");  // to its end
        read_until(out_, out_text_, "\x01");
        int status = 0;
        ::waitpid(std::exchange(pid_, -1), &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    }
    const std::string& output() const { return out_text_; }

  private:
    static std::string read_until(int file, std::string& text, const std::string& mark) {
        const auto until = Clock::now() + patience;
        for (;;) {
            if (const std::size_t at = text.find(mark); at != std::string::npos)
                return text.substr(0, at + mark.size());
            pollfd ready{file, POLLIN, 0};
            if (Clock::now() > until || ::poll(&ready, 1, 1000 * static_cast<int>(patience.count())) <= 0)
                return {};
            char block[4096];
            const ssize_t count = ::read(file, block, sizeof block);
            if (count <= 0) return {};
            text.append(block, static_cast<std::size_t>(count));
        }
    }

    pid_t pid_ = -1;
    int out_ = -1, err_ = -1;
    std::string out_text_, err_text_;
};

}  // namespace tessera::test
