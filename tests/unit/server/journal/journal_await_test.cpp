#include "server/journal/journal_await.h"

#include <thread>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "tests/unit/server/journal/engines.h"

namespace tessera::tests {
namespace {

namespace asio = boost::asio;

asio::awaitable<void> append_three(Journal& journal, std::vector<AppendOutcome>& outcomes) {
    const auto executor = co_await asio::this_coro::executor;
    const std::thread::id thread = std::this_thread::get_id();
    for (std::uint64_t n = 0; n < 3; ++n) {
        std::vector<Append> batch;
        batch.push_back(edit(n));
        const auto answer = co_await async_append(journal, std::move(batch), executor, asio::use_awaitable);
        EXPECT_EQ(std::this_thread::get_id(), thread) << "not on the journal's thread";
        outcomes.push_back(answer.at(0));
    }
}

TEST(AsyncAppend, ResumesACoroutineOnItsExecutorWhichHasWorkUntilThen) {
    asio::io_context context;
    const auto journal = memory_journal(scene_options());
    std::vector<AppendOutcome> outcomes;
    asio::co_spawn(context, append_three(*journal, outcomes), asio::detached);
    context.run();
    EXPECT_EQ(outcomes, (std::vector<AppendOutcome>{Accepted{1}, Accepted{2}, Accepted{3}}));
}

}  // namespace
}  // namespace tessera::tests
