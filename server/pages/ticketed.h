#pragma once

#include <memory>
#include <optional>
#include <utility>

#include <boost/asio/associated_cancellation_slot.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/post.hpp>

#include "shared/result/result.h"

namespace tessera {

namespace detail {

/// One operation under way. Everything but the service's call happens on the executor's one thread.
template <class Value, class Ticket, class Handler>
struct Ticketed {
    explicit Ticketed(Handler h) : handler{std::move(h)} {}

    void complete(Result<Value> result) {
        if (!handler) return;
        ticket = {};
        Handler done = std::move(*handler);
        handler.reset();
        std::move(done)(std::move(result));
    }

    std::optional<Handler> handler;
    Ticket ticket;
};

}  // namespace detail

/// A service that answers through a callback and gives out tickets, as an asynchronous operation: completes
/// with Result<Value> on `executor`, which runs on one thread and is the one that starts and cancels the
/// operation. Cancelling it gives up the ticket and completes it with `cancelled`. `start(callback)` asks the
/// service and returns the ticket.
template <class Value, class Ticket, class Executor, class Start, class CompletionToken>
auto async_ticketed(const Executor& executor, Start start, CompletionToken&& token) {
    namespace asio = boost::asio;
    return asio::async_initiate<CompletionToken, void(Result<Value>)>(
        [executor](auto handler, Start ask) {
            using Operation = detail::Ticketed<Value, Ticket, decltype(handler)>;
            const auto operation = std::make_shared<Operation>(std::move(handler));
            auto slot = asio::get_associated_cancellation_slot(*operation->handler);
            if (slot.is_connected()) {
                slot.assign([weak = std::weak_ptr<Operation>{operation}, executor](asio::cancellation_type) {
                    const auto cancelled = weak.lock();
                    if (!cancelled) return;
                    cancelled->ticket = {};
                    asio::post(executor, [cancelled] {
                        cancelled->complete(Error{ErrorCode::cancelled, "nobody waits for this any more"});
                    });
                });
            }
            operation->ticket = ask([operation, executor](Result<Value> result) {
                asio::post(executor, [operation, result = std::move(result)]() mutable {
                    operation->complete(std::move(result));
                });
            });
        },
        token, std::move(start));
}

}  // namespace tessera
