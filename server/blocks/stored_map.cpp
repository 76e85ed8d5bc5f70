#include "server/blocks/stored_map.h"

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

MapValues::MapValues(const std::vector<std::int32_t>& values) : size_{values.size()} {
    for (std::size_t first = 0; first < size_; first += part_size)
        parts_.push_back(
            std::make_shared<Part>(std::span{values}.subspan(first, std::min(part_size, size_ - first))));
}

void MapValues::copy(std::size_t first, std::size_t count, std::int32_t* out) const noexcept {
    while (count > 0) {
        const std::vector<std::int32_t>& from = parts_[first >> part_log2]->values;
        const std::size_t at = first & (part_size - 1), some = std::min(count, from.size() - at);
        out = std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(at), some, out);
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
                const auto [low, high] = std::minmax_element(part->values.begin(), part->values.end());
                Gathered gathered{*low, *high};
                gathered.add(part->values);
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

bool MapValues::operator==(const MapValues& other) const noexcept {
    return size_ == other.size_ &&
           std::equal(parts_.begin(), parts_.end(), other.parts_.begin(),
                      [](const auto& a, const auto& b) { return a == b || a->values == b->values; });
}

void MapValues::set(std::size_t i, std::int32_t value) {
    std::shared_ptr<Part>& part = parts_[i >> part_log2];
    std::int32_t& old = part->values[i & (part_size - 1)];
    if (old == value) return;
    if (part.use_count() > 1 || part->distinct.known)
        part = std::make_shared<Part>(std::span<const std::int32_t>{part->values});
    part->values[i & (part_size - 1)] = value;
    if (distinct_.use_count() > 1 || distinct_->known) distinct_ = std::make_shared<Distinct>();
}

std::vector<std::int32_t> possible_values(const StoredMap& map) {
    std::vector<std::int32_t> values = map.values.distinct();
    for (std::int32_t value = map.least; value <= map.most; ++value) values.push_back(value);
    if (map.edge == StoredMap::Edge::blank) values.push_back(-1);
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

}  // namespace tessera
