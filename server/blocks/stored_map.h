#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace tessera {

/// The entries of a map, row after row. Copies share them, and after a write all but those near it: a stroke
/// of a brush costs what it paints, however large the map.
class MapValues {
  public:
    MapValues() = default;
    MapValues(const std::vector<std::int32_t>& values);  // NOLINT(google-explicit-constructor): a map is that
    MapValues(std::initializer_list<std::int32_t> values) : MapValues{std::vector<std::int32_t>{values}} {}

    std::size_t size() const noexcept { return size_; }
    bool empty() const noexcept { return size_ == 0; }
    std::int32_t operator[](std::size_t i) const noexcept {
        return parts_[i >> part_log2]->values[i & (part_size - 1)];
    }
    void copy(std::size_t first, std::size_t count, std::int32_t* out) const noexcept;
    /// As many as lie side by side, one span after the other.
    template <class Visit>
    void for_spans(const Visit& visit) const {
        for (const auto& part : parts_) visit(std::span<const std::int32_t>{part->values});
    }
    /// The different ones, rising. Looked up once for all copies, part by part.
    const std::vector<std::int32_t>& distinct() const;
    bool operator==(const MapValues& other) const noexcept;
    /// Whether both share every entry: equal, for sure, and told at once.
    bool shares_all_with(const MapValues& other) const noexcept { return parts_ == other.parts_; }

    /// Not while another thread copies this.
    void set(std::size_t i, std::int32_t value);

  private:
    static constexpr int part_log2 = 14;
    static constexpr std::size_t part_size = std::size_t{1} << part_log2;
    /// What is looked up once, unless the values are written to.
    struct Distinct {
        std::once_flag once;
        std::atomic<bool> known = false;
        std::vector<std::int32_t> values;
    };
    struct Part {
        explicit Part(std::span<const std::int32_t> those) : values(those.begin(), those.end()) {}
        std::vector<std::int32_t> values;
        Distinct distinct;
    };

    std::size_t size_ = 0;
    std::vector<std::shared_ptr<Part>> parts_;
    std::shared_ptr<Distinct> distinct_ = std::make_shared<Distinct>();
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

    /// Into 0 to `side` − 1. Mostly it lies there, and a division takes long.
    static constexpr std::int64_t wrapped(std::int64_t i, std::int32_t side) noexcept {
        if (i >= 0 && i < side) return i;
        i %= side;
        return i < 0 ? i + side : i;
    }

    /// The entry (i, j), counted from the map's first one on; any integers.
    std::int32_t entry(std::int64_t i, std::int64_t j) const noexcept {
        if (edge == Edge::wrap) {
            i = wrapped(i, width);
            j = wrapped(j, height);
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
