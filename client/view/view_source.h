#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "client/residency/page_source.h"

namespace tessera {

class BackgroundStreamClient;

/// Where a viewer's pages come from, and what it can say of that.
class ViewSource : public PageSource {
  public:
    /// Waits for an arrival or other news, at most so long.
    virtual void wait(std::chrono::milliseconds timeout) = 0;
    virtual std::uint64_t bytes_received() const = 0;

    /// How the connection is, for people; told once a frame.
    struct State {
        std::string trouble;    ///< Why nothing comes, and when it is tried again; empty: all is well.
        std::string last_loss;  ///< Why the connection was lost the last time: it may be back.
        bool is_live = false;   ///< Edits show as they are made.
        std::uint64_t revision = 0;
        std::size_t others = 0;  ///< Who else is here.
        double round_trip_ms = 0;
    };
    virtual State state() const { return {}; }

    /// The scene's stream, by which it is edited; null: none.
    virtual BackgroundStreamClient* stream() { return nullptr; }

    /// The scene's clock now: its step, and how fast it goes (0: it rests).
    struct SceneTime {
        Step step = 0;
        double steps_per_second = 0;
    };
    virtual SceneTime scene_time() const { return {}; }
};

}  // namespace tessera
