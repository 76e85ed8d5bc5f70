#pragma once

#include <memory>
#include <optional>
#include <utility>

#include <boost/asio/associated_cancellation_slot.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/post.hpp>

#include "server/pages/page_service.h"

namespace tessera {

namespace detail {

/// One fetch under way. Everything but the service's call happens on the executor's one thread.
template <class Handler>
struct PageFetch {
    explicit PageFetch(Handler h) : handler{std::move(h)} {}

    void complete(Result<PagePtr> result) {
        if (!handler) return;
        ticket = {};
        Handler done = std::move(*handler);
        handler.reset();
        std::move(done)(std::move(result));
    }

    std::optional<Handler> handler;
    PageService::Ticket ticket;
};

}  // namespace detail

/// PageService::request() as an asynchronous operation: completes with Result<PagePtr> on `executor`, which
/// runs on one thread and is the one that starts and cancels the operation. Cancelling it gives up the place
/// in the line and completes it with `cancelled`.
template <class Executor, class CompletionToken>
auto async_fetch(PageService& pages, PageRequest request, const Executor& executor, CompletionToken&& token) {
    namespace asio = boost::asio;
    return asio::async_initiate<CompletionToken, void(Result<PagePtr>)>(
        [&pages, executor](auto handler, PageRequest wanted) {
            using Fetch = detail::PageFetch<decltype(handler)>;
            const auto fetch = std::make_shared<Fetch>(std::move(handler));
            auto slot = asio::get_associated_cancellation_slot(*fetch->handler);
            if (slot.is_connected()) {
                slot.assign([weak = std::weak_ptr<Fetch>{fetch}, executor](asio::cancellation_type) {
                    const auto cancelled = weak.lock();
                    if (!cancelled) return;
                    cancelled->ticket = {};
                    asio::post(executor, [cancelled] {
                        cancelled->complete(
                            Error{ErrorCode::cancelled, "nobody waits for this page any more"});
                    });
                });
            }
            fetch->ticket = pages.request(wanted, [fetch, executor](Result<PagePtr> result) {
                asio::post(executor, [fetch, result = std::move(result)]() mutable {
                    fetch->complete(std::move(result));
                });
            });
        },
        token, std::move(request));
}

}  // namespace tessera
