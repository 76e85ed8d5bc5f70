#include "client/residency/page_table.h"

#include <algorithm>

namespace tessera {
namespace {

std::uint32_t packed(const ShownPage& page) {
    return std::uint32_t{page.slot} | std::uint32_t{page.level} << 16;
}

}  // namespace

PageTable::PageTable(Extent extent, int window_side)
    : extent_{extent}, window_side_{window_side}, windows_(std::size_t{extent.n} + 1) {
    const auto side = static_cast<std::size_t>(window_side);
    for (int level = extent_.n; level >= 0; --level) {
        Window& window = windows_[static_cast<std::size_t>(level)];
        window.entries.resize(side * side);
        window.levels.resize(side * side);
        window.left = window.top = -window_side / 2;
        for (std::int64_t y = window.top; y < window.top + window_side; ++y)
            for (std::int64_t x = window.left; x < window.left + window_side; ++x)
                fill(static_cast<std::uint8_t>(level), x, y);
    }
}

PageTable::Place PageTable::place(Window& window, std::int64_t x, std::int64_t y) {
    const auto mask = static_cast<std::int64_t>(window_side_ - 1);
    const auto at = static_cast<std::size_t>((y & mask) * window_side_ + (x & mask));
    return {window.entries[at], window.levels[at]};
}

/// The entry of a page that has come into its window. Coarser windows are up to date already.
void PageTable::fill(std::uint8_t level, std::int64_t x, std::int64_t y) {
    const Place target = place(windows_[level], x, y);
    target.entry = {TableEntry::nothing, static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), 0};
    target.level = none;
    const std::int64_t side = extent_.side_pages(level);
    if (x < 0 || y < 0 || x >= side || y >= side) return;
    const PageKey key{level, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)};
    if (resident_.contains(key)) {
        const ShownPage& where = drawn(key);
        target.entry.shown = packed(where);
        target.entry.arrival_ms = where.arrival_ms;
        target.level = level;
    } else if (level < extent_.n) {
        // The parent is in its own window: that window reaches at least as far around the same centre
        const Place coarser = place(windows_[std::size_t{level} + 1], x >> 1, y >> 1);
        target.entry.shown = coarser.entry.shown;
        target.entry.arrival_ms = coarser.entry.arrival_ms;
        target.level = coarser.level;
    }
}

void PageTable::move_to(std::int64_t texel_x, std::int64_t texel_y) {
    centre_x_ = texel_x;
    centre_y_ = texel_y;
    for (int l = extent_.n; l >= 0; --l) {
        const auto level = static_cast<std::uint8_t>(l);
        Window& window = windows_[level];
        const std::int64_t left = (texel_x >> (8 + level)) - window_side_ / 2;
        const std::int64_t top = (texel_y >> (8 + level)) - window_side_ / 2;
        const std::int64_t old_left = window.left, old_top = window.top;
        if (left == old_left && top == old_top) continue;
        window.left = left;
        window.top = top;
        window.changed = true;
        const auto was_inside = [&](std::int64_t at, std::int64_t first) {
            return at >= first && at < first + window_side_;
        };
        for (std::int64_t y = top; y < top + window_side_; ++y) {
            const bool row_stays = was_inside(y, old_top);
            for (std::int64_t x = left; x < left + window_side_; ++x)
                if (!row_stays || !was_inside(x, old_left)) fill(level, x, y);
        }
    }
}

/// Calls update(place) for the page's own entry and all its descendants', as far as they are in a window.
template <class Update>
void PageTable::for_descendants(PageKey page, Update update) {
    for (int level = page.level; level >= 0; --level) {
        Window& window = windows_[static_cast<std::size_t>(level)];
        const int finer = page.level - level;
        const auto left = std::max(std::int64_t{page.x} << finer, window.left);
        const auto top = std::max(std::int64_t{page.y} << finer, window.top);
        const auto right = std::min((std::int64_t{page.x} + 1) << finer, window.left + window_side_);
        const auto bottom = std::min((std::int64_t{page.y} + 1) << finer, window.top + window_side_);
        if (left >= right || top >= bottom) return;  // finer windows lie inside this one
        for (std::int64_t y = top; y < bottom; ++y)
            for (std::int64_t x = left; x < right; ++x)
                if (update(place(window, x, y))) window.changed = true;
    }
}

void PageTable::show(PageKey page, ShownPage where) {
    where.level = page.level;
    resident_[page] = where;
    const ShownPage& now = drawn(page);
    for_descendants(page, [&](Place at) {
        if (at.level < page.level) return false;
        at.entry.shown = packed(now);
        at.entry.arrival_ms = now.arrival_ms;
        at.level = page.level;
        return true;
    });
}

void PageTable::hide(PageKey page) {
    if (resident_.erase(page) == 0) return;
    instead_.erase(page);
    const auto cover = cover_of(page);
    for_descendants(page, [&](Place at) {
        if (at.level != page.level) return false;
        at.entry.shown = cover ? packed(drawn(*cover)) : TableEntry::nothing;
        at.entry.arrival_ms = cover ? drawn(*cover).arrival_ms : 0;
        at.level = cover ? cover->level : none;
        return true;
    });
}

void PageTable::show_instead(PageKey page, ShownPage where) {
    if (!resident_.contains(page)) return;
    instead_[page] = where;
    redraw(page);
}

void PageTable::show_itself(PageKey page) {
    if (instead_.erase(page) != 0) redraw(page);
}

/// All entries that show this resident page, or what is shown instead of it.
void PageTable::redraw(PageKey resident) {
    const ShownPage& now = drawn(resident);
    for_descendants(resident, [&](Place at) {
        if (at.level != resident.level) return false;
        at.entry.shown = packed(now);
        at.entry.arrival_ms = now.arrival_ms;
        return true;
    });
}

const ShownPage& PageTable::drawn(PageKey resident) const {
    const auto instead = instead_.find(resident);
    return instead != instead_.end() ? instead->second : resident_.at(resident);
}

/// The page itself or its finest resident ancestor.
std::optional<PageKey> PageTable::cover_of(PageKey page) const {
    for (;; page = parent(page)) {
        if (resident_.contains(page)) return page;
        if (page.level >= extent_.n) return std::nullopt;
    }
}

std::optional<ShownPage> PageTable::shown_for(PageKey page) const {
    const auto cover = cover_of(page);
    return cover ? std::optional{drawn(*cover)} : std::nullopt;
}

std::optional<ShownPage> PageTable::resident_for(PageKey page) const {
    const auto cover = cover_of(page);
    return cover ? std::optional{resident_.at(*cover)} : std::nullopt;
}

bool PageTable::in_window(PageKey page) const {
    const Window& window = windows_[page.level];
    return page.x >= window.left && page.x < window.left + window_side_ && page.y >= window.top &&
           page.y < window.top + window_side_;
}

bool PageTable::is_at_edge(PageKey page) const {
    const PageKey centre = centre_page(page.level);
    // To its farther side, in pages
    const auto away = [](std::int64_t steps) { return steps < 0 ? -steps : steps + 1; };
    return std::max(away(std::int64_t{page.x} - centre.x), away(std::int64_t{page.y} - centre.y)) >=
           window_side_ / 2 - 1;
}

PageKey PageTable::centre_page(std::uint8_t level) const {
    return {level, static_cast<std::uint32_t>(centre_x_ >> (8 + level)),
            static_cast<std::uint32_t>(centre_y_ >> (8 + level))};
}

std::span<const TableEntry> PageTable::entries(std::uint8_t level) const { return windows_[level].entries; }

std::vector<std::uint8_t> PageTable::take_changed_levels() {
    std::vector<std::uint8_t> changed;
    for (int level = extent_.n; level >= 0; --level) {
        Window& window = windows_[static_cast<std::size_t>(level)];
        if (window.changed) changed.push_back(static_cast<std::uint8_t>(level));
        window.changed = false;
    }
    return changed;
}

}  // namespace tessera
