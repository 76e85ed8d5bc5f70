#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "server/filter/texel_pages.h"

namespace tessera {

/// The pages that were asked for last. Any thread may ask; a page that several want is made once.
class TexelPageCache {
  public:
    struct Key {
        std::int64_t x = 0, y = 0, slice = 0;
        std::uint8_t level = 0;
        bool operator==(const Key&) const = default;
    };
    using Made = Result<std::shared_ptr<const TexelPage>>;

    /// Keeps at most `cache_bytes`, and always one page.
    explicit TexelPageCache(std::size_t cache_bytes);

    /// The page, or what `make` makes of it outside any lock. Whoever waits for another's page gives up by
    /// its own budget, and makes the page itself if the other failed.
    Made get(const Key& key, const Budget& budget, const std::function<Made()>& make);

    std::size_t memory_bytes() const noexcept;

  private:
    struct KeyHash {
        std::size_t operator()(const Key& key) const noexcept;
    };
    struct Kept {
        Key key;
        std::shared_ptr<const TexelPage> page;  ///< Null while it is being made.
    };

    std::size_t most_pages_;
    mutable std::mutex mutex_;
    std::condition_variable made_;
    std::list<Kept> pages_;  ///< The last asked for first.
    std::unordered_map<Key, std::list<Kept>::iterator, KeyHash> by_key_;
};

inline constexpr std::size_t texel_page_bytes =
    std::size_t{page_side_texels} * page_side_texels * 4 * sizeof(std::uint16_t);

}  // namespace tessera
