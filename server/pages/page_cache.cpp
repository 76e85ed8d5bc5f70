#include "server/pages/page_cache.h"

#include <algorithm>
#include <deque>
#include <mutex>
#include <unordered_map>
#include <unordered_set>

namespace tessera {
namespace {

constexpr std::size_t max_shards = 16;
constexpr std::size_t least_shard_bytes = std::size_t{4} << 20;  // a dozen raw pages with gutters
constexpr std::uint8_t most_hits = 3;                            // as in the paper: two bits of popularity

}  // namespace

class PageCache::Shard {
  public:
    explicit Shard(std::size_t budget) : budget_{budget} {}

    PagePtr find(PageId id) {
        const std::lock_guard lock{mutex_};
        const auto found = entries_.find(id);
        if (found == entries_.end()) return nullptr;
        found->second.hits = std::min<std::uint8_t>(most_hits, found->second.hits + 1);
        return found->second.page;
    }

    void insert(PagePtr page) {
        const std::size_t bytes = page->memory_bytes();
        if (bytes > budget_) return;
        std::vector<PagePtr> evicted;  // freed after the lock is released
        const std::lock_guard lock{mutex_};
        const PageId id = page->id;
        if (entries_.contains(id)) return;
        while (small_.bytes + main_.bytes + bytes > budget_) evict_one(evicted);

        // A page that was pushed out a short while ago has proved itself by coming back
        Queue& queue = ghosts_.erase(id) != 0 ? main_ : small_;
        queue.order.push_back(id);
        queue.bytes += bytes;
        entries_.emplace(id, Entry{std::move(page), bytes, 0});
    }

    void add_usage(Usage& total) const {
        const std::lock_guard lock{mutex_};
        total.bytes += small_.bytes + main_.bytes;
        total.pages += entries_.size();
        total.evictions += evictions_;
    }

  private:
    struct Entry {
        PagePtr page;
        std::size_t bytes = 0;
        std::uint8_t hits = 0;  ///< Since it entered its queue, saturating.
    };
    struct Queue {
        std::deque<PageId> order;  ///< Oldest first.
        std::size_t bytes = 0;
    };

    /// Removes one page; both queues are not empty together. Every turn of the loop takes a hit from an entry
    /// or moves one to the main queue, so it ends.
    void evict_one(std::vector<PagePtr>& evicted) {
        for (;;) {
            const bool from_small = main_.order.empty() || small_.bytes > budget_ / 10;
            Queue& queue = from_small && !small_.order.empty() ? small_ : main_;
            const PageId id = queue.order.front();
            const auto found = entries_.find(id);
            Entry& entry = found->second;
            queue.order.pop_front();
            queue.bytes -= entry.bytes;
            if (entry.hits > 0) {
                // Asked for since: a second chance at the end of the main queue
                entry.hits = &queue == &small_ ? std::uint8_t{0} : static_cast<std::uint8_t>(entry.hits - 1);
                main_.order.push_back(id);
                main_.bytes += entry.bytes;
                continue;
            }
            if (&queue == &small_) remember(id);
            evicted.push_back(std::move(entry.page));
            entries_.erase(found);
            ++evictions_;
            return;
        }
    }

    /// Remembers the id of a page that left the small queue, for about as long as the main queue turns over.
    void remember(PageId id) {
        if (ghosts_.insert(id).second) ghost_order_.push_back(id);
        while (ghost_order_.size() > std::max<std::size_t>(entries_.size(), 16)) {
            ghosts_.erase(ghost_order_.front());
            ghost_order_.pop_front();
        }
    }

    const std::size_t budget_;
    mutable std::mutex mutex_;
    std::unordered_map<PageId, Entry> entries_;
    Queue small_, main_;
    std::unordered_set<PageId> ghosts_;
    std::deque<PageId> ghost_order_;
    std::uint64_t evictions_ = 0;
};

PageCache::PageCache(std::size_t budget_bytes) {
    const std::size_t count = std::clamp<std::size_t>(budget_bytes / least_shard_bytes, 1, max_shards);
    for (std::size_t i = 0; i < count; ++i) shards_.push_back(std::make_unique<Shard>(budget_bytes / count));
}

PageCache::~PageCache() = default;

PageCache::Shard& PageCache::shard_of(PageId id) const noexcept { return *shards_[id.high % shards_.size()]; }

PagePtr PageCache::find(PageId id) { return shard_of(id).find(id); }

void PageCache::insert(PagePtr page) {
    Shard& shard = shard_of(page->id);
    shard.insert(std::move(page));
}

PageCache::Usage PageCache::usage() const {
    Usage total;
    for (const auto& shard : shards_) shard->add_usage(total);
    return total;
}

}  // namespace tessera
