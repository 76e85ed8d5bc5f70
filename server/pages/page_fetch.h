#pragma once

#include <utility>

#include "server/pages/page_service.h"
#include "server/pages/ticketed.h"

namespace tessera {

/// PageService::request() as an asynchronous operation: see async_ticketed().
template <class Executor, class CompletionToken>
auto async_fetch(PageService& pages, PageRequest request, const Executor& executor, CompletionToken&& token) {
    return async_ticketed<PagePtr, PageService::Ticket>(
        executor,
        [&pages, wanted = std::move(request)](PageService::Handler handler) {
            return pages.request(wanted, std::move(handler));
        },
        std::forward<CompletionToken>(token));
}

}  // namespace tessera
