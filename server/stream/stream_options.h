#pragma once

#include <chrono>
#include <cstddef>

namespace tessera {

/// What one stream may cost. Each limit keeps a slow, broken or hostile client from holding what others need.
struct StreamOptions {
    std::size_t streams = 2048;                          ///< At a time; one more is answered with 503.
    std::size_t message_bytes = std::size_t{256} << 10;  ///< Of a client's message. More ends the stream.
    std::size_t windows = 64;                            ///< Of one client.
    std::size_t window_pages = 65536;                    ///< Of all windows of one client.
    std::size_t asks = 1024;                             ///< Pages of one client that wait for an answer.
    std::size_t credits = 1024;                          ///< Of one client; more are not kept.
    std::size_t edits = 256;                             ///< Of one client that wait for an answer.
    std::size_t pages_under_way = 32;                    ///< Of one client, at the page service or done.
    std::size_t held_bytes = std::size_t{1} << 20;       ///< Of one client's pages that wait for the socket.
    std::size_t answer_bytes = std::size_t{128} << 10;   ///< Of small answers; beyond, nothing more is read.
    std::size_t control_frames = 256;                    ///< In a second. More ends the stream.
    std::chrono::milliseconds hello_time{5'000};         ///< From the upgrade to ClientHello.
    std::chrono::milliseconds ping_time{20'000};         ///< Without a word from the client.
    std::chrono::milliseconds pong_time{20'000};         ///< For the answer to a ping.
    std::chrono::milliseconds write_time{10'000};        ///< Without one byte taken by the reader.
    std::chrono::milliseconds close_time{1'000};         ///< For the closing handshake.
    std::chrono::milliseconds invalidation_pause{4};     ///< Between two of them: those in between are one.
    std::chrono::milliseconds revision_pause{250};       ///< Between two that tell the revision alone.
    std::chrono::milliseconds presence_pause{33};
    std::chrono::milliseconds clock_pause{10'000};
};

}  // namespace tessera
