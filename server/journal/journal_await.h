#pragma once

#include <memory>
#include <utility>

#include <boost/asio/async_result.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>

#include "server/journal/journal.h"

namespace tessera {

/// Journal::append() as an asynchronous operation: completes with the outcomes, on `executor`, which has work
/// until then. It cannot be cancelled: an edit that is on its way to the disk gets there.
template <class Executor, class CompletionToken>
auto async_append(Journal& journal, std::vector<Append> batch, const Executor& executor,
                  CompletionToken&& token) {
    namespace asio = boost::asio;
    return asio::async_initiate<CompletionToken, void(std::vector<AppendOutcome>)>(
        [&journal, executor](auto handler, std::vector<Append> edits) {
            struct Waiting {
                decltype(handler) complete;
                asio::executor_work_guard<Executor> work;
            };
            // Shared, since a std::function wants to be copied
            const auto waiting = std::make_shared<Waiting>(
                Waiting{std::move(handler), asio::executor_work_guard<Executor>{executor}});
            journal.append(std::move(edits), [waiting](std::vector<AppendOutcome> outcomes) {
                const auto on = waiting->work.get_executor();
                asio::post(on, [waiting, outcomes = std::move(outcomes)]() mutable {
                    std::move(waiting->complete)(std::move(outcomes));
                });
            });
        },
        token, std::move(batch));
}

}  // namespace tessera
