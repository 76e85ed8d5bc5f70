#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "client/link/stream_page.h"

namespace tessera {

/// Asks for pages from the moment they are made to the moment they are answered. Knows no sockets.
class StreamAsks {
  public:
    using Time = std::chrono::steady_clock::time_point;

    /// False: an ask of that id waits for its answer.
    bool add(const StreamAsk& ask, Time now);

    /// What becomes of an ask that nobody wants any more.
    enum class Cancelled { unknown, never_sent, has_to_be_sent };
    Cancelled cancel(std::uint32_t id);

    /// Up to `most` asks that were not sent yet, the first first; from now on they count as sent.
    std::vector<StreamAsk> take_unsent(std::size_t most);
    bool has_unsent() const noexcept { return unsent_ > 0; }

    /// The ask that an answer names, which is over with that. Nothing: no such ask waits on this connection.
    struct Answered {
        StreamAsk ask;
        bool wanted = true;  ///< False: it was told to be too late already.
    };
    std::optional<Answered> answered(std::uint32_t id);

    /// Asks made before `since` that are not answered. The asker is told now; their answers may still come.
    std::vector<StreamAsk> give_up(Time since, Time now);

    /// All that the asker still waits for; then none is left.
    std::vector<StreamAsk> take_all();

    std::size_t size() const noexcept { return asks_.size(); }
    /// Of those given up, the ones of before `since`.
    std::size_t given_up_before(Time since) const;

  private:
    struct Entry {
        StreamAsk ask;
        Time made;
        bool sent = false;
        bool wanted = true;
        Time given_up{};
    };
    std::unordered_map<std::uint32_t, Entry> asks_;
    std::deque<std::uint32_t> queue_;  ///< Of those not sent, and of ended ones.
    std::size_t unsent_ = 0;
    std::size_t given_up_ = 0;
};

}  // namespace tessera
