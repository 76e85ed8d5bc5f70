#pragma once

#include <string>

#include "client/load/load_run.h"

namespace tessera {

/// Shows on stderr how a run stands: a block that is drawn over itself on a terminal, else a line now and
/// then.
class ProgressView {
  public:
    explicit ProgressView(bool is_terminal) : is_terminal_{is_terminal} {}
    /// How often show() wants to be called.
    std::chrono::milliseconds period() const { return std::chrono::milliseconds{is_terminal_ ? 500 : 5000}; }
    void show(const LoadProgress& progress);
    /// Takes the block off the terminal.
    void clear();

  private:
    bool is_terminal_;
    int lines_ = 0;  ///< Of the block on the terminal now.
};

/// One line, without its end.
std::string progress_line(const LoadProgress& progress);
/// Three lines with a bar, each with its end.
std::string progress_block(const LoadProgress& progress);

}  // namespace tessera
