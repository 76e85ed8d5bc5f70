#pragma once

#include <chrono>
#include <csignal>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace tessera::test {

/// tessera-edit with these arguments; its input is written and its output read through pipes.
class EditProgram {
  public:
    explicit EditProgram(std::vector<std::string> arguments) {
        int in[2], out[2], err[2];
        if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0)
            throw std::runtime_error{"no pipe"};
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, in[0], 0);
        posix_spawn_file_actions_adddup2(&actions, out[1], 1);
        posix_spawn_file_actions_adddup2(&actions, err[1], 2);
        arguments.insert(arguments.begin(), EDIT_PROGRAM);
        std::vector<char*> words;
        for (std::string& argument : arguments) words.push_back(argument.data());
        words.push_back(nullptr);
        const int failure = posix_spawn(&pid_, EDIT_PROGRAM, &actions, nullptr, words.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        ::close(in[0]);
        ::close(out[1]);
        ::close(err[1]);
        in_ = in[1];
        out_ = out[0];
        err_ = err[0];
        if (failure != 0) throw std::runtime_error{"cannot start " EDIT_PROGRAM};
    }
    ~EditProgram() {
        if (pid_ > 0) {
            ::kill(pid_, SIGKILL);
            ::waitpid(pid_, nullptr, 0);
        }
        close_input();
        ::close(out_);
        ::close(err_);
    }
    EditProgram(const EditProgram&) = delete;
    EditProgram& operator=(const EditProgram&) = delete;

    bool write_line(std::string text) const {
        text += '\n';
        return ::write(in_, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    }
    void close_input() {
        if (in_ >= 0) ::close(std::exchange(in_, -1));
    }
    void signal(int number) const { ::kill(pid_, number); }

    /// The next line of output; "" when there is none within a minute.
    std::string line() {
        while (text_.find('\n') == std::string::npos)
            if (!read_more(out_, text_)) return "";
        const std::size_t end = text_.find('\n');
        std::string line = text_.substr(0, end);
        text_.erase(0, end + 1);
        return line;
    }
    /// Lines up to one that has `mark`, the last; "" if none has.
    std::string line_with(const std::string& mark) {
        for (std::string next = line(); !next.empty(); next = line())
            if (next.find(mark) != std::string::npos) return next;
        return "";
    }
    std::string rest() {
        while (read_more(out_, text_)) {
        }
        return std::exchange(text_, {});
    }
    std::string errors() {
        std::string text;
        while (read_more(err_, text)) {
        }
        return text;
    }
    /// After its output has ended.
    int exit_code() {
        close_input();
        rest();
        int status = 0;
        ::waitpid(std::exchange(pid_, -1), &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    }

  private:
    static bool read_more(int file, std::string& text) {
        pollfd ready{file, POLLIN, 0};
        if (::poll(&ready, 1, 60'000) <= 0) return false;
        char block[4096];
        const ssize_t count = ::read(file, block, sizeof block);
        if (count > 0) text.append(block, static_cast<std::size_t>(count));
        return count > 0;
    }

    pid_t pid_ = -1;
    int in_ = -1, out_ = -1, err_ = -1;
    std::string text_;
};

}  // namespace tessera::test
