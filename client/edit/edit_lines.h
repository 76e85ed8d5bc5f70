#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/any_io_executor.hpp>

namespace tessera {

/// Reads lines of standard input on a thread of its own, and hands them to `executor` one by one. At most
/// `most_under_way` are handed over and not done; so a fast writer waits for us.
class InputLines {
  public:
    /// `line` is called with each line that is not empty and its number from 1 on; `end` once after the last,
    /// with what went wrong, or "". Neither is called after stop().
    InputLines(boost::asio::any_io_executor executor, std::size_t most_under_way,
               std::function<void(std::string, std::size_t)> line, std::function<void(std::string)> end);
    ~InputLines();
    InputLines(const InputLines&) = delete;
    InputLines& operator=(const InputLines&) = delete;

    /// One more of the lines is dealt with.
    void done();

  private:
    struct Shared;
    std::shared_ptr<Shared> shared_;  // the thread, which may wait for input for ever, holds it too
};

}  // namespace tessera
