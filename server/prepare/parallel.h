#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace tessera {

/// Calls `work(i)` once for each i in [0, count), on up to `threads` threads: fewer where the system gives no
/// more. What comes out may not depend on who does what when: each call writes only what belongs to its i.
/// What a call throws ends the rest and is thrown here.
template <class Work>
void for_each_index(std::size_t count, std::size_t threads, Work&& work) {
    std::atomic<std::size_t> next{0};
    std::atomic_flag has_failed;
    std::exception_ptr failure;  // written by whoever sets the flag, read when all threads have ended
    const auto run = [&]() noexcept {
        try {
            for (std::size_t i = next++; i < count; i = next++) work(i);
        } catch (...) {
            next = count;
            if (!has_failed.test_and_set()) failure = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> helpers;
        try {
            for (std::size_t t = 1; t < std::min(threads, count); ++t) helpers.emplace_back(run);
        } catch (const std::system_error&) {
            // those that run do the rest
        }
        run();
    }
    if (failure) std::rethrow_exception(failure);
}

}  // namespace tessera
