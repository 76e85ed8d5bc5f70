#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/system/result.hpp>

#include "server/http/refusal.h"
#include "server/pages/page_request.h"
#include "shared/page/channel_set.h"

namespace tessera {

template <class T>
using Parsed = boost::system::result<T, Refusal>;
[[noreturn]] void throw_exception_from_error(const Refusal& refusal, const boost::source_location& where);

/// The segments of a path, percent-decoded once. Refuses what could leave a folder or confuse a reader: "."
/// and "..", encoded slashes, backslashes, control characters and bytes beyond ASCII.
Parsed<std::vector<std::string>> path_segments(std::string_view path);

/// /scenes/{id}/{z}/{x}/{y}.{format} and /scenes/{id}/r{revision}-{fingerprint}/{z}/{x}/{y}.{format}
struct PageAddress {
    struct Pin {
        std::uint64_t revision = 0;
        std::string fingerprint;
    };
    std::string scene;
    std::optional<Pin> pin;  ///< Only in the immutable form.
    /// Decimal and possibly beyond the extent, which is "no such page" and not a malformed address; a
    /// negative or huge number is `out_of_range`.
    std::uint64_t z = 0, x = 0, y = 0;
    PageFormat format = PageFormat::png;
};

/// `segments` as path_segments() gave them; at least one.
bool is_page_address(const std::vector<std::string>& segments) noexcept;
Parsed<PageAddress> page_address(const std::vector<std::string>& segments);

/// `gutter`, `accuracy`, `max_error`, `channels`, `slice`, `step` and `parameter`, each at most once and
/// nothing else.
struct PageQuery {
    std::uint8_t gutter = 0;
    Accuracy accuracy = Accuracy::high;  ///< `high` where there is an error limit: that goes before it.
    std::optional<ErrorLimit> max_error;
    ChannelSet channels = ChannelSet::albedo;  ///< That the scene has it is for others to check.
    std::int64_t slice = 0;                    ///< Within ±max_slice.
    std::int64_t step = 0;                     ///< Within ±max_step.
    std::int32_t parameter = 0;                ///< 0 to 65536: in 65536ths.

    /// The one way to write it, with its '?', or nothing: names in the order gutter, accuracy,
    /// max_error, channels, slice, step, parameter; defaults left out.
    std::string canonical() const;
};
Parsed<PageQuery> page_query(std::string_view query);

}  // namespace tessera
