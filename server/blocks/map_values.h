#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

namespace tessera {

/// Some integers, each kept as how far it lies above the least of them, in 1, 2 or 4 bytes: maps hold few
/// codes, and what looks at them here and there waits for memory more than for anything else.
class PackedValues {
  public:
    explicit PackedValues(std::span<const std::int32_t> values);

    std::size_t size() const noexcept { return bytes_.size() >> bytes_log2_; }
    std::int32_t operator[](std::size_t i) const noexcept {
        const std::uint8_t* at = bytes_.data() + (i << bytes_log2_);
        if (bytes_log2_ == 0) return value_of(*at);
        return bytes_log2_ == 1 ? value_of(read<std::uint16_t>(at)) : value_of(read<std::uint32_t>(at));
    }
    void copy(std::size_t first, std::size_t count, std::int32_t* out) const noexcept;
    std::vector<std::int32_t> all() const;
    void set(std::size_t i, std::int32_t value);
    bool operator==(const PackedValues& other) const;
    std::size_t memory_bytes() const noexcept { return bytes_.size(); }

  private:
    template <class Above>
    static Above read(const std::uint8_t* at) noexcept {
        Above above;
        std::memcpy(&above, at, sizeof above);
        return above;
    }
    std::int32_t value_of(std::uint32_t above) const noexcept {
        return static_cast<std::int32_t>(static_cast<std::uint32_t>(least_) + above);
    }
    void write(std::size_t i, std::uint32_t above) noexcept;

    std::int32_t least_ = 0;
    int bytes_log2_ = 0;  ///< Of one.
    std::vector<std::uint8_t> bytes_;
};

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
    /// All of them, one span after the other.
    template <class Visit>
    void for_spans(const Visit& visit) const {
        for (const auto& part : parts_) visit(std::span<const std::int32_t>{part->values.all()});
    }
    /// The different ones, rising. Looked up once for all copies, part by part.
    const std::vector<std::int32_t>& distinct() const;
    bool operator==(const MapValues& other) const;
    /// Whether both share every entry: equal, for sure, and told at once.
    bool shares_all_with(const MapValues& other) const noexcept { return parts_ == other.parts_; }
    std::size_t shared_with(const MapValues& other) const noexcept;  ///< How many entries.
    std::size_t memory_bytes() const noexcept;                       ///< As if nobody shared them.

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
        explicit Part(PackedValues those) : values{std::move(those)} {}
        PackedValues values;
        Distinct distinct;
    };

    std::size_t size_ = 0;
    std::vector<std::shared_ptr<Part>> parts_;
    std::shared_ptr<Distinct> distinct_ = std::make_shared<Distinct>();
};

}  // namespace tessera
