#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "server/filter/footprint_filter.h"
#include "server/texture/texture.h"
#include "shared/math/footprint.h"
#include "shared/page/channel_set.h"
#include "shared/result/result.h"

namespace tessera {

/// How messages are written on the way.
enum class WireCoding : std::uint8_t { protobuf, json };

/// "application/x-protobuf", "application/json"
std::string_view content_type(WireCoding coding) noexcept;

/// When a moving scene is sampled.
struct SampleTime {
    std::int64_t step = 0;       ///< Within ±max_step
    std::int32_t parameter = 0;  ///< 65536ths, 0 to 65536
    bool operator==(const SampleTime&) const = default;
};

/// proto::SampleRequest as far as it has been checked: every footprint is in range and convex.
struct SampleRequest {
    std::vector<Footprint> footprints;
    std::optional<FootprintFilter> filter;
    Accuracy accuracy = Accuracy::high;
    std::optional<double> max_error;  ///< In codes, 0 to 255; not with a filter.
    ChannelSet channels = ChannelSet::albedo;
    std::int64_t slice = 0;  ///< Within ±max_slice.
    SampleTime time{};
};

inline constexpr std::size_t max_sample_footprints = 65'536;

/// Reads the body of a request. Footprint by footprint, so that a body never grows in memory by more than a
/// small factor, and ends at the first that is wrong. Error: malformed_request, which names the footprint's
/// index and field.
Result<SampleRequest> read_sample_request(std::string_view body, WireCoding coding);

}  // namespace tessera
