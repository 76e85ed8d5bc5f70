#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace tessera {

/// The entries of a map. Copies share them until one of them is written to.
class MapValues {
  public:
    MapValues() = default;
    MapValues(std::vector<std::int32_t> values)  // NOLINT(google-explicit-constructor): a map is its entries
        : kept_{std::make_shared<Kept>(std::move(values))} {}
    MapValues(std::initializer_list<std::int32_t> values) : MapValues{std::vector<std::int32_t>{values}} {}

    std::size_t size() const noexcept { return kept_ ? kept_->values.size() : 0; }
    bool empty() const noexcept { return size() == 0; }
    const std::int32_t* data() const noexcept { return kept_ ? kept_->values.data() : nullptr; }
    const std::int32_t* begin() const noexcept { return data(); }
    const std::int32_t* end() const noexcept { return data() + size(); }
    std::int32_t operator[](std::size_t i) const noexcept { return kept_->values[i]; }
    /// The different ones, rising: looked up once for all copies.
    const std::vector<std::int32_t>& distinct() const;

    /// To write to; not while another thread copies this.
    std::vector<std::int32_t>& own() {
        kept_ = !kept_                  ? std::make_shared<Kept>(std::vector<std::int32_t>{})
                : kept_.use_count() > 1 ? std::make_shared<Kept>(kept_->values)
                                        : std::make_shared<Kept>(std::move(kept_->values));
        return kept_->values;
    }

  private:
    struct Kept {
        explicit Kept(std::vector<std::int32_t> entries) : values{std::move(entries)} {}
        std::vector<std::int32_t> values;
        std::once_flag looked_up;
        std::vector<std::int32_t> distinct;
    };
    std::shared_ptr<Kept> kept_;
};

/// An explicit map: integers on a rectangle of cells, and what is outside it.
struct StoredMap {
    enum class Edge : std::uint8_t { wrap, clamp, blank };

    std::int32_t width = 0;   ///< In entries, 1 to 32768.
    std::int32_t height = 0;  ///< In entries, 1 to 32768; width·height at most 2^26.
    MapValues values;         ///< Rows from the top. −1: blank.
    Edge edge = Edge::wrap;
    int cells_log2 = 0;  ///< An entry covers 2^cells_log2 cells along a side; 0 to 16.
    std::int64_t x = 0;  ///< The cell of the first entry's top-left corner: a multiple of 2^cells_log2.
    std::int64_t y = 0;
    /// Where edits may change entries: from what to what. Whatever is worked out for the whole map, from then
    /// on, is worked out for all of these, so that an edit changes nothing beyond the cells near it. Most
    /// below least: entries are what they are.
    std::int32_t least = 0, most = -1;

    bool bounded() const noexcept { return least <= most; }

    /// The entry (i, j), counted from the map's first one on; any integers.
    std::int32_t entry(std::int64_t i, std::int64_t j) const noexcept {
        if (edge == Edge::wrap) {
            // Mostly it lies inside, and a division takes long
            if (i < 0 || i >= width) i = (i % width + width) % width;
            if (j < 0 || j >= height) j = (j % height + height) % height;
        } else if (edge == Edge::clamp) {
            i = std::clamp<std::int64_t>(i, 0, width - 1);
            j = std::clamp<std::int64_t>(j, 0, height - 1);
        } else if (i < 0 || j < 0 || i >= width || j >= height) {
            return -1;
        }
        return values[static_cast<std::size_t>(j * width + i)];
    }
};

/// The integers that the map shows somewhere, or may once it is edited, and −1 where it may be blank outside:
/// rising.
std::vector<std::int32_t> possible_values(const StoredMap& map);

}  // namespace tessera
