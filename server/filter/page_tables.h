#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "server/filter/page_cache.h"
#include "server/filter/texel_pages.h"

namespace tessera {

/// What the filters of one footprint read: where from, and what it says of itself.
struct Reading {
    std::int64_t slice = 0;
    const Budget* budget = nullptr;
    std::optional<Error> error = std::nullopt;  ///< The first; from there on, pages are black.
    double bound_codes = 0;                     ///< The greatest of the pages that were read.
    double confidence = 1;                      ///< The least.
    std::uint64_t texels = 0;
};

/// Tables that are made of a page, those used last kept: one for each page, however many places of the
/// lattice show it. `Table` is made from a TexelPage, and has `bytes`, what one takes in memory beside its
/// page. For one thread.
template <class Table>
class PageTables {
  public:
    PageTables(std::shared_ptr<const TexelPages> pages, std::size_t memory_bytes)
        : pages_{std::move(pages)},
          most_entries_{std::max<std::size_t>(4, memory_bytes / (Table::bytes + texel_page_bytes))} {}

    /// Of the page with texels [256·x, …) of `level`; valid until the next call.
    const Table& at(int level, std::int64_t x, std::int64_t y, Reading& reading) {
        // Places that lie together, and levels that follow each other, never push each other out
        Slot& slot = slots_[static_cast<std::size_t>((x & 7) | (y & 7) << 3 | (level & 3) << 6)];
        if (!slot.entry || slot.x != x || slot.y != y || slot.level != level || slot.slice != reading.slice) {
            slot.entry = nullptr;
            Entry* entry = load(level, x, y, reading);
            if (!entry) return black();
            slot = {x, y, reading.slice, level, entry};
        }
        Entry& entry = *slot.entry;
        entry.used = ++uses_;
        reading.bound_codes = std::max(reading.bound_codes, entry.page->bound_codes);
        reading.confidence = std::min(reading.confidence, entry.page->confidence);
        return *entry.table;
    }

  private:
    struct Entry {
        std::shared_ptr<const TexelPage> page;
        std::optional<Table> table;
        std::uint64_t used = 0;
    };
    struct Slot {
        std::int64_t x = 0, y = 0, slice = 0;
        int level = 0;
        Entry* entry = nullptr;
    };

    Entry* load(int level, std::int64_t x, std::int64_t y, Reading& reading) {
        if (reading.error) return nullptr;
        auto page = pages_->page(static_cast<std::uint8_t>(level), x, y, reading.slice, *reading.budget);
        if (!page) {
            reading.error = page.error();
            return nullptr;
        }
        Entry* oldest = nullptr;
        for (const auto& entry : entries_) {
            if (entry->page == *page) return entry.get();
            if (!oldest || entry->used < oldest->used) oldest = entry.get();
        }
        if (entries_.size() < most_entries_) {
            entries_.push_back(std::make_unique<Entry>());
            oldest = entries_.back().get();
        }
        for (Slot& slot : slots_)
            if (slot.entry == oldest) slot.entry = nullptr;
        oldest->table.reset();
        oldest->page = *page;
        oldest->table.emplace(**page);
        return oldest;
    }

    const Table& black() {
        if (!black_) {
            black_page_.steps.assign(std::size_t{4} * page_side_texels * page_side_texels, 0);
            black_.emplace(black_page_);
        }
        return *black_;
    }

    std::shared_ptr<const TexelPages> pages_;
    std::size_t most_entries_;
    std::array<Slot, 256> slots_{};
    std::vector<std::unique_ptr<Entry>> entries_;
    std::uint64_t uses_ = 0;
    TexelPage black_page_;
    std::optional<Table> black_;
};

/// A page's texels as they are.
struct TexelRows {
    static constexpr std::size_t bytes = 0;  // Beyond the page itself
    explicit TexelRows(const TexelPage& page) : steps{page.steps.data()} {}

    const std::uint16_t* texel(std::int64_t x, std::int64_t y) const noexcept {
        return steps + ((y << 8 | x) << 2);
    }

    const std::uint16_t* steps;
};

}  // namespace tessera
