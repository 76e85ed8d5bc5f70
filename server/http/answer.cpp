#include "server/http/answer.h"

#include <algorithm>
#include <charconv>
#include <cstdio>

#include "server/http/field_values.h"

namespace tessera {
namespace {

constexpr std::string_view prelude_of_text =
    "Access-Control-Allow-Origin: *\r\n"
    "Access-Control-Expose-Headers: *, ETag, Server-Timing, Retry-After\r\n"
    "Timing-Allow-Origin: *\r\n"
    "Cross-Origin-Resource-Policy: cross-origin\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "\r\n";

unsigned status_of(ErrorCode code) {
    switch (code) {
        case ErrorCode::malformed_request:
            return 400;
        case ErrorCode::no_such_scene:
        case ErrorCode::no_such_page:
            return 404;
        case ErrorCode::page_changed:
            return 410;
        case ErrorCode::overloaded:
        case ErrorCode::timed_out:
        case ErrorCode::cancelled:
            return 503;
        case ErrorCode::invalid_input:
        case ErrorCode::io_failure:
            break;
    }
    return 500;
}

std::string decimal(double value, int digits = 6) {
    char text[32];
    return {text, static_cast<std::size_t>(std::snprintf(text, sizeof text, "%.*g", digits, value))};
}

/// Raw pages alone are negotiated; the others are the same for everybody.
std::string_view negotiation_fields(const PageOptions& options) {
    if (options.format != PageFormat::rgba) return {};
    return options.coding == ContentCoding::zstd ? "Content-Encoding: zstd\r\nVary: Accept-Encoding\r\n"
                                                 : "Vary: Accept-Encoding\r\n";
}

}  // namespace

const std::string_view common_fields = prelude_of_text.substr(0, prelude_of_text.size() - 2);

Answer text_answer(unsigned status, std::string_view content_type, std::string body,
                   std::string_view more_fields) {
    Answer answer;
    answer.status = status;
    const auto owner = std::make_shared<const std::string>(std::move(body));
    if (status != 204 && status != 304) {
        answer.fields += "Content-Type: ";
        answer.fields += content_type;
        answer.fields += "\r\nContent-Length: " + std::to_string(owner->size()) + "\r\n";
    }
    answer.fields += more_fields;
    answer.prelude = prelude_of_text;
    answer.body = {reinterpret_cast<const std::uint8_t*>(owner->data()), owner->size()};
    answer.owner = owner;
    return answer;
}

Answer refusal_answer(const Refusal& refusal) {
    std::string fields = "Cache-Control: no-store\r\n";
    if (refusal.status == 401) fields += "WWW-Authenticate: Bearer realm=\"tessera\"\r\n";
    if (refusal.status == 405) fields += "Allow: GET, HEAD, OPTIONS\r\n";
    if (refusal.status == 426) fields += "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n";
    // Browsers heed no Retry-After: a page that somebody opened while scenes are loaded comes by itself
    if (refusal.status == 503) fields += "Retry-After: 1\r\nRefresh: 1\r\n";
    Answer answer = text_answer(refusal.status, "text/plain; charset=utf-8", refusal.why + "\n", fields);
    answer.close = refusal.close;
    return answer;
}

Answer error_answer(const Error& error) {
    const unsigned status = status_of(error.code);
    // What went wrong inside is for the log alone
    return refusal_answer({status, status == 500 ? "the server could not make this" : error.detail, false});
}

std::string page_prelude(const EncodedPage& page) {
    std::string text;
    text.reserve(768);
    const auto field = [&text](std::string_view name, std::string_view value) {
        text += name;
        text += ": ";
        text += value;
        text += "\r\n";
    };
    field("Content-Type", content_type(page.options.format));
    field("Content-Length", std::to_string(page.bytes->size()));
    if (page.within_limit) field("ETag", etag_of(page.id));
    text += negotiation_fields(page.options);
    field("Tessera-Method", page.evaluation.method);
    field("Tessera-Bound", decimal(page.evaluation.bound_codes));
    // 1 says that the bound is certain, and 1 − 10⁻⁹ is not
    field("Tessera-Confidence", decimal(page.evaluation.confidence, 12));
    field("Tessera-Work", std::to_string(page.evaluation.work));
    field("Tessera-Accuracy", name_of(page.accuracy));
    if (page.options.max_error) field("Tessera-Max-Error", text_of(*page.options.max_error));
    field("Tessera-Channels", name_of(page.options.channels));
    field("Tessera-Revision", std::to_string(page.revision));
    field("Tessera-Level", std::to_string(page.key.level));
    const Validity& valid = page.evaluation.validity;
    field("Tessera-Valid-From", valid.from == always ? "always" : std::to_string(valid.from));
    field("Tessera-Valid-Until", valid.until == never ? "never" : std::to_string(valid.until));
    text += prelude_of_text;
    text.shrink_to_fit();
    return text;
}

std::string page_fields_without_body(std::optional<PageId> id, const PageOptions& options,
                                     bool not_modified) {
    // Only its evaluation tells whether a page keeps a limit, and has an entity tag at all
    std::string text;
    if (id && (!options.max_error || not_modified)) text = "ETag: " + etag_of(*id) + "\r\n";
    text += negotiation_fields(options);
    if (!not_modified) {
        text += "Content-Type: ";
        text += content_type(options.format);
        text += "\r\n";
    }
    return text;
}

bool matches(std::string_view if_none_match, std::string_view etag) {
    if (trimmed(if_none_match) == "*") return true;
    while (!if_none_match.empty()) {
        std::string_view element = next_element(if_none_match);
        if (element.starts_with("W/")) element.remove_prefix(2);
        if (element == etag) return true;
    }
    return false;
}

bool accepts(std::string_view accept_encoding, std::string_view coding) {
    while (!accept_encoding.empty()) {
        const std::string_view element = next_element(accept_encoding);
        const std::size_t semicolon = std::min(element.find(';'), element.size());
        if (!equals_ignoring_case(trimmed(element.substr(0, semicolon)), coding)) continue;
        const std::string_view weight = trimmed(element.substr(std::min(semicolon + 1, element.size())));
        // q=0, q=0.0, … refuse; anything else allows
        return !((weight.starts_with("q=0") || weight.starts_with("Q=0")) &&
                 weight.find_first_not_of("0.", 2) == std::string_view::npos);
    }
    return false;
}

Urgency urgency_of(std::string_view priority) {
    while (!priority.empty()) {
        const std::string_view element = next_element(priority);
        if (element.size() == 3 && element.starts_with("u=") && element[2] >= '0' && element[2] <= '7')
            return {static_cast<std::uint8_t>(element[2] - '0')};
    }
    return {};
}

}  // namespace tessera
