#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/http/refusal.h"
#include "server/pages/encoded_page.h"
#include "shared/result/result.h"

namespace tessera {

/// What a session sends. Status line, Date and Connection are the session's.
struct Answer {
    unsigned status = 200;
    std::string fields;  ///< Header lines, each ending in CR LF.
    /// What follows `fields`, up to and with the empty line. Points into `owner` or to storage that is never
    /// freed.
    std::string_view prelude;
    std::span<const std::uint8_t> body;
    std::shared_ptr<const void> owner;  ///< Keeps prelude and body alive.
    bool close = false;
};

/// The fields of every answer: public and without credentials, so one cached copy serves every origin.
extern const std::string_view common_fields;

Answer text_answer(unsigned status, std::string_view content_type, std::string body,
                   std::string_view more_fields = {});

/// An error is a line of text, is never stored, and tells a passing one from a lasting one by Retry-After.
Answer refusal_answer(const Refusal& refusal);
Answer error_answer(const Error& error);

/// What goes before every copy of a page: the second half of its header.
std::string page_prelude(const EncodedPage& page);

/// A page's header where there is no body to send: HEAD of a page that nobody has evaluated yet, and 304.
/// `id`: if it is known without.
std::string page_fields_without_body(std::optional<PageId> id, const PageOptions& options, bool not_modified);

/// Whether If-None-Match names `etag` (RFC 9110, 13.1.2: weak comparison).
bool matches(std::string_view if_none_match, std::string_view etag);

/// Whether Accept-Encoding allows `coding` by name (RFC 9110, 12.5.3).
bool accepts(std::string_view accept_encoding, std::string_view coding);

/// The urgency in a Priority field (RFC 9218): 3 unless it says otherwise.
Urgency urgency_of(std::string_view priority);

}  // namespace tessera
