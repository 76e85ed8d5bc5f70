#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "server/edits/edit_service.h"
#include "server/pages/page_service.h"
#include "server/sampling/sample_service.h"
#include "server/stream/stream_options.h"

namespace tessera {

/// What one connection may cost. Each limit keeps a slow, broken or hostile client from holding what others
/// need; each too small refuses honest ones.
struct SessionLimits {
    std::size_t head_bytes = 8192;    ///< Request line and header fields. More is 431.
    std::size_t target_bytes = 2048;  ///< The request target. More is 414.
    std::size_t fields = 100;         ///< Header fields. More is 431.
    std::size_t body_bytes = std::size_t{32}
                             << 20;                ///< Of a POST. More is 413; too few split large requests.
    std::chrono::milliseconds body_time{30'000};   ///< For a whole body, and write_time without a byte of it.
    std::chrono::milliseconds head_time{5'000};    ///< From a request's first byte to the end of its header.
    std::chrono::milliseconds idle_time{60'000};   ///< Between requests. Too short costs reconnections.
    std::chrono::milliseconds write_time{10'000};  ///< Without one byte taken by the reader.
    std::chrono::milliseconds answer_time{120'000};  ///< For one whole answer, however steadily it trickles.
    std::chrono::milliseconds linger_time{500};  ///< After the last answer, so that a reset does not eat it.
};

/// Everything `tessera serve` is told, checked once by commands.cpp.
struct ServerOptions {
    std::filesystem::path scenes;  ///< A folder of scenes, or one scene.
    std::filesystem::path web;     ///< The built web page. Empty: a plain page that says how to build it.
    std::string address = "127.0.0.1";  ///< Numeric, IPv4 or IPv6. Beyond loopback everybody may read.
    std::uint16_t port = 7070;          ///< 0 picks a free one.
    std::size_t io_threads = 1;  ///< Parse and send; one serves some ten thousand pages a second. At least 1.
    std::size_t max_connections = 4096;      ///< Beyond it 503. Each holds a descriptor and up to 16 KiB.
    std::chrono::milliseconds grace{4'000};  ///< For answers in flight when the server stops.
    SessionLimits session;
    std::size_t bodies_bytes = std::size_t{128} << 20;  ///< Of all bodies together. Beyond it 503.
    PageServiceLimits pages;
    SampleServiceLimits samples;
    EditOptions edits;
    StreamOptions streams;
    std::filesystem::path tokens;  ///< Who may edit from elsewhere (Access::load). Empty: nobody.
};

}  // namespace tessera
