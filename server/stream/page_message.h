#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "server/stream/page_flow.h"
#include "shared/result/result.h"

namespace tessera {

namespace proto {
class StreamPageOptions;
}

/// Format, gutter and so on, as /scenes/{id}/{z}/{x}/{y} takes them. Error: malformed_request.
Result<PageOptions> page_options_of(const proto::StreamPageOptions& message);

/// PageData.tag: 16 bytes, or 8 in brief answers.
std::string tag_bytes(PageTag tag);
std::optional<PageTag> read_tag(std::string_view bytes);

/// A ServerMessage with a PageData: what goes before the texels, which are the message's last bytes and are
/// sent from where they are.
struct PageMessage {
    std::string head;
    std::span<const std::uint8_t> texels;
};
PageMessage page_message(const StreamPage& page);

}  // namespace tessera
