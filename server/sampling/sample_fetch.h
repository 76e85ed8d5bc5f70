#pragma once

#include <utility>

#include "server/pages/ticketed.h"
#include "server/sampling/sample_service.h"

namespace tessera {

/// SampleService::request() as an asynchronous operation: see async_ticketed().
template <class Executor, class CompletionToken>
auto async_sample(SampleService& service, SampleCall call, const Executor& executor,
                  CompletionToken&& token) {
    return async_ticketed<SampleReply, SampleService::Ticket>(
        executor,
        [&service, asked = std::move(call)](SampleService::Handler handler) mutable {
            return service.request(std::move(asked), std::move(handler));
        },
        std::forward<CompletionToken>(token));
}

}  // namespace tessera
