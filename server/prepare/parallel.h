#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace tessera {

/// Calls `work(i)` once for each i in [0, count), on `threads` threads. What comes out may not depend on who
/// does what when: each call writes only what belongs to its i.
template <class Work>
void for_each_index(std::size_t count, std::size_t threads, Work&& work) {
    std::atomic<std::size_t> next{0};
    const auto run = [&] {
        for (std::size_t i = next++; i < count; i = next++) work(i);
    };
    std::vector<std::jthread> helpers;
    for (std::size_t t = 1; t < std::min(threads, count); ++t) helpers.emplace_back(run);
    run();
}

}  // namespace tessera
