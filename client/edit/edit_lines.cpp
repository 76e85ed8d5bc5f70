#include "client/edit/edit_lines.h"

#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <thread>
#include <utility>

#include <boost/asio/post.hpp>

namespace tessera {

namespace asio = boost::asio;

namespace {

constexpr std::size_t longest_line = std::size_t{1} << 20;

enum class Got { line, end, too_long };

/// The next line of standard input without its end.
Got next_line(std::string& line) {
    line.clear();
    for (int c = std::getchar(); c != EOF; c = std::getchar()) {
        if (c == '\n') return Got::line;
        if (line.size() == longest_line) return Got::too_long;
        line += static_cast<char>(c);
    }
    return line.empty() ? Got::end : Got::line;
}

}  // namespace

struct InputLines::Shared {
    asio::any_io_executor executor;
    std::size_t most_under_way;
    std::function<void(std::string, std::size_t)> line;
    std::function<void(std::string)> end;

    std::mutex mutex;
    std::condition_variable changed;
    std::size_t under_way = 0;
    bool stopped = false;

    /// False when nobody wants lines any more.
    bool take_place() {
        std::unique_lock lock{mutex};
        changed.wait(lock, [&] { return stopped || under_way < most_under_way; });
        ++under_way;
        return !stopped;
    }
    bool is_stopped() {
        const std::lock_guard lock{mutex};
        return stopped;
    }
};

InputLines::InputLines(asio::any_io_executor executor, std::size_t most_under_way,
                       std::function<void(std::string, std::size_t)> line,
                       std::function<void(std::string)> end)
    : shared_{std::make_shared<Shared>()} {
    shared_->executor = std::move(executor);
    shared_->most_under_way = most_under_way;
    shared_->line = std::move(line);
    shared_->end = std::move(end);
    std::thread{[shared = shared_] {
        std::string text;
        std::size_t number = 0;
        Got got = Got::line;
        while ((got = next_line(text)) == Got::line) {
            ++number;
            if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
            if (!shared->take_place()) return;
            const std::lock_guard lock{shared->mutex};
            if (shared->stopped) return;
            asio::post(shared->executor, [shared, text, number] {
                if (!shared->is_stopped()) shared->line(text, number);
            });
        }
        const std::string problem =
            got == Got::end ? "" : "line " + std::to_string(number + 1) + ": more than 1 MiB";
        const std::lock_guard lock{shared->mutex};
        if (shared->stopped) return;
        asio::post(shared->executor, [shared, problem] {
            if (!shared->is_stopped()) shared->end(problem);
        });
    }}.detach();  // it may wait in the system for input that never comes
}

InputLines::~InputLines() {
    const std::lock_guard lock{shared_->mutex};
    shared_->stopped = true;
    shared_->changed.notify_all();
}

void InputLines::done() {
    const std::lock_guard lock{shared_->mutex};
    --shared_->under_way;
    shared_->changed.notify_all();
}

}  // namespace tessera
