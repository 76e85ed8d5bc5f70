#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>

namespace tessera {

/// Time since the client started; the caller's clock, so that tests can turn it.
using ClientTime = std::chrono::milliseconds;

/// How many answers should be under way: as many as fit into the way there and back and one frame more, by
/// the link's measured speed. Fewer leave it idle; more wait in a queue that nobody can sort any more, and
/// arrive after the view has left them.
class CreditWindow {
  public:
    /// Never fewer than `least` nor more than `most`, both at least 1.
    CreditWindow(std::size_t least, std::size_t most);

    /// `is_limited`: more was wanted than the window allowed, so the link is the bottleneck.
    void sent(std::uint32_t id, ClientTime now, bool is_limited);
    /// The answer came, with so many bytes on the wire.
    void arrived(std::uint32_t id, std::size_t bytes, ClientTime now);
    /// No answer will come, or one without a page.
    void lost(std::uint32_t id) { under_way_.erase(id); }
    /// Once a frame.
    void frame(ClientTime now);

    std::size_t answers() const;
    ClientTime round_trip() const {
        return round_trip_;
    }                                 ///< With hardly anything under way; 0 before the first.
    double bytes_per_second() const;  ///< As fast as most of the last answers came; 0 before the first.
    ClientTime frame_time() const { return ClientTime{static_cast<std::int64_t>(frame_ms_ + 0.5)}; }

  private:
    struct Sent {
        ClientTime at{};
        ClientTime last_arrival{};       ///< Before it was sent
        std::uint64_t bytes_before = 0;  ///< That had arrived then
        bool is_limited = false;
        bool is_alone = false;  ///< Hardly anything else was under way
    };
    std::size_t least_, most_;
    std::unordered_map<std::uint32_t, Sent> under_way_;
    ClientTime round_trip_{}, round_trip_measured_{};
    bool is_draining_ = false;  ///< To measure the round trip anew
    std::deque<double> rates_;  ///< Bytes a millisecond
    std::uint64_t bytes_ = 0;
    double page_bytes_ = 0;
    ClientTime last_arrival_{}, last_frame_{-1};
    double frame_ms_ = 17;
};

}  // namespace tessera
