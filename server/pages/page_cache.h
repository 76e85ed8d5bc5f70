#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/pages/encoded_page.h"

namespace tessera {

/// Encoded pages within a budget of bytes, bookkeeping included. One scan over many pages does not push out
/// the pages that are asked for again and again: a new page proves itself in a small queue first. Yang,
/// Zhang, Qiu, Yue, Rashmi, "FIFO queues are all you need for cache eviction" (S3-FIFO), SOSP 2023, applied
/// to bytes instead of entries. All members may be called from any thread.
class PageCache {
  public:
    /// `budget_bytes` 0 keeps nothing.
    explicit PageCache(std::size_t budget_bytes);
    ~PageCache();
    PageCache(const PageCache&) = delete;
    PageCache& operator=(const PageCache&) = delete;

    /// Null if the page is not here.
    PagePtr find(PageId id);

    /// Keeps `page` if it fits, at the expense of others. A page that is here already stays as it is.
    void insert(PagePtr page);

    struct Usage {
        std::size_t bytes = 0;
        std::size_t pages = 0;
        std::uint64_t evictions = 0;  ///< Since the start.
    };
    Usage usage() const;

  private:
    class Shard;
    Shard& shard_of(PageId id) const noexcept;

    std::vector<std::unique_ptr<Shard>> shards_;  ///< Each with a lock and an equal part of the budget.
};

}  // namespace tessera
