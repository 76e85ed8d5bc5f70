#include "server/blocks/map_values.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace tessera {

namespace {

/// Of so many values in a row which occur is noted in a list.
constexpr std::int64_t most_listed = std::int64_t{1} << 20;

/// The different values of some lists, rising.
class Gathered {
  public:
    Gathered(std::int32_t least, std::int32_t most) : least_{least} {
        if (std::int64_t{most} - least < most_listed)
            present_.resize(static_cast<std::size_t>(std::int64_t{most} - least + 1));
    }
    void add(std::span<const std::int32_t> values) {
        if (present_.empty()) return static_cast<void>(all_.insert(all_.end(), values.begin(), values.end()));
        for (const std::int32_t value : values) present_[static_cast<std::size_t>(value - least_)] = 1;
    }
    std::vector<std::int32_t> values() && {
        if (present_.empty()) {
            std::sort(all_.begin(), all_.end());
            all_.erase(std::unique(all_.begin(), all_.end()), all_.end());
        }
        for (std::size_t i = 0; i < present_.size(); ++i)
            if (present_[i] != 0) all_.push_back(least_ + static_cast<std::int32_t>(i));
        return std::move(all_);
    }

  private:
    std::int32_t least_;
    std::vector<std::uint8_t> present_;
    std::vector<std::int32_t> all_;
};

}  // namespace

PackedValues::PackedValues(std::span<const std::int32_t> values) {
    if (values.empty()) return;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    least_ = *least;
    const auto range = static_cast<std::uint32_t>(*most) - static_cast<std::uint32_t>(least_);
    bytes_log2_ = range < 1u << 8 ? 0 : range < 1u << 16 ? 1 : 2;
    bytes_.resize(values.size() << bytes_log2_);
    for (std::size_t i = 0; i < values.size(); ++i)
        write(i, static_cast<std::uint32_t>(values[i]) - static_cast<std::uint32_t>(least_));
}

void PackedValues::write(std::size_t i, std::uint32_t above) noexcept {
    std::uint8_t* to = bytes_.data() + (i << bytes_log2_);
    const auto as = [&](auto narrow) { std::memcpy(to, &narrow, sizeof narrow); };
    if (bytes_log2_ == 0)
        *to = static_cast<std::uint8_t>(above);
    else if (bytes_log2_ == 1)
        as(static_cast<std::uint16_t>(above));
    else
        as(above);
}

void PackedValues::copy(std::size_t first, std::size_t count, std::int32_t* out) const noexcept {
    const std::uint8_t* from = bytes_.data() + (first << bytes_log2_);
    const auto read_all = [&](auto kind) {
        for (std::size_t i = 0; i < count; ++i)
            out[i] = value_of(read<decltype(kind)>(from + i * sizeof kind));
    };
    if (bytes_log2_ == 0)
        read_all(std::uint8_t{});
    else if (bytes_log2_ == 1)
        read_all(std::uint16_t{});
    else
        read_all(std::uint32_t{});
}

std::vector<std::int32_t> PackedValues::all() const {
    std::vector<std::int32_t> values(size());
    copy(0, size(), values.data());
    return values;
}

void PackedValues::set(std::size_t i, std::int32_t value) {
    const std::uint32_t above = static_cast<std::uint32_t>(value) - static_cast<std::uint32_t>(least_);
    if (value >= least_ && (bytes_log2_ == 2 || above >> (8 << bytes_log2_) == 0)) return write(i, above);
    std::vector<std::int32_t> values = all();
    values[i] = value;
    *this = PackedValues{values};
}

bool PackedValues::operator==(const PackedValues& other) const {
    if (least_ == other.least_ && bytes_log2_ == other.bytes_log2_) return bytes_ == other.bytes_;
    return all() == other.all();  // Written to, they may be kept wider than need be
}

MapValues::MapValues(const std::vector<std::int32_t>& values) : size_{values.size()} {
    for (std::size_t first = 0; first < size_; first += part_size)
        parts_.push_back(std::make_shared<Part>(
            PackedValues{std::span{values}.subspan(first, std::min(part_size, size_ - first))}));
}

void MapValues::copy(std::size_t first, std::size_t count, std::int32_t* out) const noexcept {
    while (count > 0) {
        const PackedValues& from = parts_[first >> part_log2]->values;
        const std::size_t at = first & (part_size - 1), some = std::min(count, from.size() - at);
        from.copy(at, some, out);
        out += some;
        first += some;
        count -= some;
    }
}

const std::vector<std::int32_t>& MapValues::distinct() const {
    std::call_once(distinct_->once, [this] {
        std::int32_t least = std::numeric_limits<std::int32_t>::max(),
                     most = std::numeric_limits<std::int32_t>::min();
        for (const auto& part : parts_) {
            std::call_once(part->distinct.once, [&part] {
                const std::vector<std::int32_t> values = part->values.all();
                const auto [low, high] = std::minmax_element(values.begin(), values.end());
                Gathered gathered{*low, *high};
                gathered.add(values);
                part->distinct.values = std::move(gathered).values();
                part->distinct.known = true;
            });
            least = std::min(least, part->distinct.values.front());
            most = std::max(most, part->distinct.values.back());
        }
        if (parts_.empty()) return;
        Gathered gathered{least, most};
        for (const auto& part : parts_) gathered.add(part->distinct.values);
        distinct_->values = std::move(gathered).values();
        distinct_->known = true;
    });
    return distinct_->values;
}

bool MapValues::operator==(const MapValues& other) const {
    return size_ == other.size_ &&
           std::equal(parts_.begin(), parts_.end(), other.parts_.begin(),
                      [](const auto& a, const auto& b) { return a == b || a->values == b->values; });
}

void MapValues::set(std::size_t i, std::int32_t value) {
    std::shared_ptr<Part>& part = parts_[i >> part_log2];
    const std::size_t at = i & (part_size - 1);
    if (part->values[at] == value) return;
    if (part.use_count() > 1 || part->distinct.known) part = std::make_shared<Part>(part->values);
    part->values.set(at, value);
    if (distinct_.use_count() > 1 || distinct_->known) distinct_ = std::make_shared<Distinct>();
}

std::size_t MapValues::shared_with(const MapValues& other) const noexcept {
    std::size_t shared = 0;
    for (std::size_t i = 0; i < std::min(parts_.size(), other.parts_.size()); ++i)
        if (parts_[i] == other.parts_[i]) shared += parts_[i]->values.size();
    return shared;
}

std::size_t MapValues::memory_bytes() const noexcept {
    std::size_t bytes = 0;
    for (const auto& part : parts_) bytes += part->values.memory_bytes();
    return bytes;
}

}  // namespace tessera
