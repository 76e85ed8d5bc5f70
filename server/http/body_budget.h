#pragma once

#include <atomic>
#include <cstddef>

namespace tessera {

/// How many bytes of request bodies all sessions together may hold: what one connection may send is bounded,
/// and so are many of them.
class BodyBudget {
  public:
    explicit BodyBudget(std::size_t bytes) : left_{bytes} {}

    /// What one body has taken so far; given back when it is destroyed.
    class Share {
      public:
        explicit Share(BodyBudget& budget) : budget_{budget} {}
        ~Share() { budget_.left_ += taken_; }
        Share(const Share&) = delete;
        Share& operator=(const Share&) = delete;

        /// False, and nothing taken, if there is not so much left.
        bool take(std::size_t bytes) noexcept {
            std::size_t left = budget_.left_;
            do {
                if (left < bytes) return false;
            } while (!budget_.left_.compare_exchange_weak(left, left - bytes));
            taken_ += bytes;
            return true;
        }

      private:
        BodyBudget& budget_;
        std::size_t taken_ = 0;
    };

  private:
    std::atomic<std::size_t> left_;
};

}  // namespace tessera
