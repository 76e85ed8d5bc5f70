#include "proto/edit.pb.h"

#include "server/http/edit_access.h"
#include "server/http/media_type.h"
#include "server/http/routes.h"
#include "shared/wire/json.h"

namespace tessera {

namespace http = boost::beast::http;

namespace {

unsigned status_of(EditRefusal::Why why) {
    switch (why) {
        case EditRefusal::Why::wrong:
            return 400;
        case EditRefusal::Why::conflict:
        case EditRefusal::Why::other_content:
            return 409;
        case EditRefusal::Why::too_old:
            return 410;
        case EditRefusal::Why::overloaded:
        case EditRefusal::Why::unavailable:
        case EditRefusal::Why::unknown:
            break;
    }
    return 503;
}

}  // namespace

Routes::Outcome Routes::edit(const RequestHead& request, const Scene& scene, const Access& access) {
    if (!request.is(http::verb::post))
        return text_answer(405, "text/plain; charset=utf-8", "edits are sent with POST\n",
                           "Cache-Control: no-store\r\nAllow: POST, OPTIONS\r\n");
    auto allowed = may_edit(request, access);
    if (const auto* refusal = std::get_if<Refusal>(&allowed)) return refusal_answer(*refusal);
    if (!request.query.empty()) return refusal_answer({400, "this address takes no parameters", false});
    const auto coding = wire_coding_of(request[http::field::content_type]);
    if (!coding)
        return refusal_answer({415, "Content-Type: application/x-protobuf or application/json", false});
    const auto answer = accepted_coding(request[http::field::accept], *coding);
    if (!answer) return refusal_answer({406, "Accept: application/x-protobuf or application/json", false});
    if (request.body_bytes > max_edit_bytes)
        return refusal_answer({413, "an edit has at most 256 KiB; send several", true});
    return PendingEdit{scene.id, *coding, *answer, std::get<Access::Decision>(std::move(allowed))};
}

Result<proto::Edit> Routes::read_edit(const std::string& body, const PendingEdit& pending) {
    proto::Edit edit;
    if (pending.coding == WireCoding::json) {
        if (auto read = read_json(body, "the edit", edit); !read) return read.error();
    } else if (!edit.ParseFromString(body)) {
        return Error{ErrorCode::invalid_input, "the edit: is no message of proto/edit.proto"};
    }
    auto author = author_of(edit.author(), pending.allowed);
    if (!author) return author.error();
    edit.set_author(std::move(*author));
    return edit;
}

Answer Routes::edit_answer(const EditOutcome& outcome, WireCoding coding) {
    if (const auto* refusal = std::get_if<EditRefusal>(&outcome)) {
        const unsigned status = status_of(refusal->why);
        std::string why = refusal->why == EditRefusal::Why::unknown ? "unknown: " : "";
        return refusal_answer({status, why + refusal->detail, false});
    }
    const auto& answer = std::get<proto::EditAnswer>(outcome);
    return text_answer(200, content_type(coding),
                       coding == WireCoding::json ? write_brief_json(answer) : answer.SerializeAsString(),
                       "Cache-Control: no-store\r\n");
}

}  // namespace tessera
