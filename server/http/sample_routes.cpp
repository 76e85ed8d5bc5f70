#include "server/http/media_type.h"
#include "server/http/routes.h"

namespace tessera {

namespace http = boost::beast::http;

Routes::Outcome Routes::sample(const RequestHead& request, const ScenePtr& scene) {
    if (!request.is(http::verb::post))
        return text_answer(405, "text/plain; charset=utf-8", "samples are asked for with POST\n",
                           "Cache-Control: no-store\r\nAllow: POST, OPTIONS\r\n");
    if (!request.query.empty())
        return refusal_answer(
            {400, "this address takes no parameters; they are fields of the request", false});
    const auto coding = wire_coding_of(request[http::field::content_type]);
    if (!coding)
        return refusal_answer({415, "Content-Type: application/x-protobuf or application/json", false});
    if (request.message.count(http::field::content_encoding) != 0 &&
        request[http::field::content_encoding] != "identity")
        return refusal_answer({415, "Content-Encoding: send the body as it is", false});
    const auto answer = accepted_coding(request[http::field::accept], *coding);
    if (!answer) return refusal_answer({406, "Accept: application/x-protobuf or application/json", false});
    return PendingSample{{scene, {}, *coding, *answer}};
}

Answer Routes::sample_answer(SampleReply& reply) {
    const auto milliseconds = [](std::chrono::nanoseconds time) {
        return std::to_string(std::chrono::duration<double, std::milli>(time).count());
    };
    return text_answer(200, content_type(reply.coding), std::move(reply.body),
                       "Cache-Control: no-store\r\nServer-Timing: queue;dur=" + milliseconds(reply.queued) +
                           ", sample;dur=" + milliseconds(reply.sampled) + "\r\n");
}

}  // namespace tessera
