#include "server/filter/page_cache.h"

#include <algorithm>
#include <chrono>

#include "shared/math/hash.h"

namespace tessera {

std::size_t TexelPageCache::KeyHash::operator()(const Key& key) const noexcept {
    return hash(static_cast<std::uint64_t>(key.slice), key.level, key.x, key.y);
}

TexelPageCache::TexelPageCache(std::size_t cache_bytes)
    : most_pages_{std::max<std::size_t>(1, cache_bytes / texel_page_bytes)} {}

TexelPageCache::Made TexelPageCache::get(const Key& key, const Budget& budget,
                                         const std::function<Made()>& make) {
    std::unique_lock lock{mutex_};
    for (;;) {
        const auto found = by_key_.find(key);
        if (found == by_key_.end()) break;
        if (found->second->page) {
            pages_.splice(pages_.begin(), pages_, found->second);
            return found->second->page;
        }
        // A stop token wakes nobody here: look at the budget now and then
        made_.wait_for(lock, std::chrono::milliseconds{5});
        if (const auto within = check_budget(budget); !within) return within.error();
    }

    pages_.push_front({key, nullptr});
    const auto mine = pages_.begin();
    by_key_.emplace(key, mine);
    lock.unlock();
    Made made = Error{ErrorCode::cancelled, "the page was not made"};
    try {
        made = make();
    } catch (...) {
        lock.lock();
        by_key_.erase(key);
        pages_.erase(mine);
        made_.notify_all();
        throw;
    }
    lock.lock();
    if (made) {
        mine->page = *made;
        // What is still being made is neither counted as old nor dropped
        for (auto oldest = pages_.end(); by_key_.size() > most_pages_ && oldest != pages_.begin();) {
            --oldest;
            if (!oldest->page || oldest == mine) continue;
            by_key_.erase(oldest->key);
            oldest = pages_.erase(oldest);
        }
    } else {
        by_key_.erase(key);
        pages_.erase(mine);
    }
    made_.notify_all();
    return made;
}

std::size_t TexelPageCache::memory_bytes() const noexcept {
    const std::lock_guard lock{mutex_};
    return by_key_.size() * texel_page_bytes;
}

}  // namespace tessera
