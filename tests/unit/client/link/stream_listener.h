#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "client/link/stream_client.h"
#include "tests/unit/client/link/small_stream_server.h"

namespace tessera::test {

/// A StreamClient on the test's thread, and what it was told.
struct Listening : StreamListener {
    explicit Listening(ServerAddress address, StreamSettings settings = quick())
        : client{std::make_unique<StreamClient>(context.get_executor(), std::move(address), "checker",
                                                std::move(settings), *this)} {}

    /// Settings that let bad days pass within a test.
    static StreamSettings quick() {
        using std::chrono::milliseconds;
        StreamSettings settings;
        settings.first_back_off = milliseconds{10};
        settings.longest_back_off = milliseconds{40};
        settings.hello_timeout = milliseconds{400};
        settings.answer_timeout = milliseconds{300};
        settings.ping_every = milliseconds{50};
        settings.limits.open_timeout = milliseconds{1000};
        settings.limits.message_timeout = milliseconds{400};
        settings.limits.silence_timeout = milliseconds{400};
        settings.limits.write_timeout = milliseconds{400};
        return settings;
    }

    /// Runs until `there` holds; false if that takes more than ten seconds.
    bool run_until(const std::function<bool()>& there) {
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
        while (!there()) {
            if (std::chrono::steady_clock::now() > deadline) return false;
            context.run_one_for(std::chrono::milliseconds{20});
        }
        return true;
    }
    void run_for(std::chrono::milliseconds time) { context.run_for(time); }

    void on_open(const proto::ServerHello& hello) override {
        hellos.push_back(hello);
        if (when_open) when_open();
    }
    void on_lost(const Error& why, std::chrono::milliseconds wait) override {
        lost.push_back(why);
        waits.push_back(wait);
    }
    void on_page(StreamPage page) override { pages.push_back(std::move(page)); }
    void on_invalidation(const proto::Invalidation& told) override { invalidations.push_back(told); }
    void on_edit(const proto::EditDone& edit) override { edits.push_back(edit); }
    void on_present(const proto::Present& present) override { people.push_back(present); }
    void on_clock(const proto::ClockNow& clock) override { clocks.push_back(clock); }

    /// Asks for a page as soon as the stream is open, with enough credits.
    void ask_when_open(std::vector<StreamAsk> asks) {
        when_open = [this, asks] {
            client->allow(16);
            for (const StreamAsk& ask : asks) client->ask(ask);
        };
    }
    bool wait_for_pages(std::size_t count) {
        return run_until([&] { return pages.size() >= count; });
    }

    boost::asio::io_context context{1};
    std::function<void()> when_open;
    std::vector<proto::ServerHello> hellos;
    std::vector<Error> lost;
    std::vector<std::chrono::milliseconds> waits;
    std::vector<StreamPage> pages;
    std::vector<proto::Invalidation> invalidations;
    std::vector<proto::EditDone> edits;
    std::vector<proto::Present> people;
    std::vector<proto::ClockNow> clocks;
    std::unique_ptr<StreamClient> client;
};

}  // namespace tessera::test
