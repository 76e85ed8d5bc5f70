#include "server/blocks/running_cells.h"

#include <algorithm>
#include <utility>

namespace tessera {

namespace {

/// Of how many values it is worth to know what they show.
constexpr std::size_t most_values = 1024;

}  // namespace

class RunningCells::Cells final : public StandingCells {
  public:
    /// `values`: entries are compared, and not what cells show.
    Cells(const RunningCells& of, std::int64_t z, bool values, bool only_patterns, const Ask& ask)
        : of_{of}, z_{z}, values_{values}, only_patterns_{only_patterns}, ask_{ask} {}

    void ask(std::span<const CellAt> cells, std::span<Look> looks,
             std::span<Validity> frames) const override {
        if (!of_.framed_) return ask_(cells, looks, frames);
        const auto& [cycles, look] = *of_.framed_;
        AnimationOp::Followed followed{0, 0, {0, 0}};
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const Shown is = cycles.shown_within(cells[i], z_, followed);
            frames[i] = is.validity;
            looks[i] = look;
            looks[i].pattern = cycles.pattern_of(is.frame);
        }
    }
    bool sifts() const noexcept override { return of_.framed_.has_value(); }
    std::size_t sift(std::span<CellAt> cells, const Look& look) const override {
        if (!sifts() || cells.empty()) return cells.size();
        const auto& [cycles, rest] = *of_.framed_;
        Look resting = rest;
        resting.pattern = cycles.pattern_of(0);
        if (!same(resting, look)) return cells.size();
        if (!rows_) rows_.emplace();
        return cycles.leave_resting_out(cells, z_, *rows_, followed_);
    }
    Still still_at(Step step, const Look& look) const override {
        if (of_.animation_ == nullptr || values_) return still_ever(look);
        const AnimationOp::Followed followed = of_.animation_->looked_at(step);
        return still(followed.first, followed.last, followed.holds, look);
    }
    Still still_ever(const Look& look) const override {
        return still(0, of_.animation_ == nullptr ? 0 : of_.animation_->settings().size() - 1, {}, look);
    }
    std::int64_t comes_again() const noexcept override { return values_ ? 0 : of_.comes_again_; }
    bool same(const Look& a, const Look& b) const noexcept override {
        return only_patterns_ ? a.pattern == b.pattern : shows_same(a, b);
    }

  private:
    Still still(std::size_t first, std::size_t last, const Validity& holds, const Look& look) const {
        const auto kinds = of_.find(first, last, values_);
        Still still{{}, StillRuns::other, holds};
        if (!kinds || !kinds->runs) return still;
        const auto found = std::find_if(kinds->looks.begin(), kinds->looks.end(),
                                        [&](const Look& kind) { return same(kind, look); });
        if (found == kinds->looks.end()) return still;
        still.runs = kinds->runs;
        still.kind = static_cast<StillRuns::Kind>(found - kinds->looks.begin());
        return still;
    }

    const RunningCells& of_;
    mutable AnimationOp::Followed followed_{0, 0, {0, 0}};
    mutable std::optional<MappedCycles::Rows> rows_;
    std::int64_t z_;
    bool values_, only_patterns_;
    const Ask& ask_;
};

RunningCells::RunningCells(const Scroll& scroll, const std::optional<VaryingMap>& varying,
                           const AnimationOp* animation, LooksOf looks_of, bool only_map,
                           std::optional<Framed> framed)
    : scroll_{scroll}, animation_{animation}, looks_of_{std::move(looks_of)}, framed_{std::move(framed)} {
    if (!varying || possible_values(*varying->map).size() > most_values) return;
    map_ = std::make_shared<const StoredMap>(*varying->map);  // Shares its entries
    values_ = possible_values(*map_);
    looks_.resize(animation_ == nullptr ? 1 : animation_->settings().size());
    drawn_ = varying->sampling != VaryingMap::Sampling::nearest || varying->corners;
    if (only_map && map_->edge == StoredMap::Edge::wrap)
        comes_again_ = std::int64_t{map_->width} << map_->cells_log2;
}

std::shared_ptr<const RunningCells::Kinds> RunningCells::find(std::size_t first, std::size_t last,
                                                              bool values) const {
    if (!map_ || (drawn_ && !values)) return nullptr;
    const std::lock_guard lock{mutex_};
    const auto found = std::find_if(known_.begin(), known_.end(), [&](const Known& known) {
        return values ? known.values : !known.values && known.first == first && known.last == last;
    });
    if (found != known_.end()) {
        known_.splice(known_.begin(), known_, found);
    } else {
        Known known{first, last, values, {}, {}};
        known.kinds = make(known);
        known_.push_front(std::move(known));
        if (known_.size() > most_known) known_.pop_back();
    }
    return known_.front().kinds;
}

const RunningCells::SingleLooks& RunningCells::looks_under(std::size_t setting) const {
    if (animation_ != nullptr) {
        const auto settings = animation_->settings();
        setting = static_cast<std::size_t>(std::find(settings.begin(), settings.end(), settings[setting]) -
                                           settings.begin());
    }
    std::optional<SingleLooks>& looks = looks_[setting];
    if (looks) return *looks;
    looks.emplace();
    for (const std::int32_t value : values_) {
        const std::vector<Look> shown = looks_of_(value, setting);
        const auto same = [&](const Look& look) { return shows_same(look, shown.front()); };
        looks->push_back(!shown.empty() && std::all_of(shown.begin(), shown.end(), same)
                             ? std::optional{shown.front()}
                             : std::nullopt);
    }
    return *looks;
}

/// What cells in entries of value number `value` show under all of these settings.
std::optional<Look> RunningCells::look_of(const Known& known, std::size_t value) const {
    if (known.values) return Look{.pattern = values_[value]};
    std::optional<Look> look = looks_under(known.first)[value];
    for (std::size_t setting = known.first + 1; look && setting <= known.last; ++setting) {
        const std::optional<Look>& other = looks_under(setting)[value];
        if (!other || !shows_same(*look, *other)) look.reset();
    }
    return look;
}

/// What is told apart in entries; runs are looked for among those that are known.
std::shared_ptr<const RunningCells::Kinds> RunningCells::make(Known& known) const {
    Kinds kinds;
    for (std::size_t value = 0; value < values_.size(); ++value) {
        known.kind_of_value.push_back(StillRuns::other);
        const std::optional<Look> shown = look_of(known, value);
        if (!shown) continue;
        // Of values each has its own
        const auto is = known.values
                            ? kinds.looks.end()
                            : std::find_if(kinds.looks.begin(), kinds.looks.end(),
                                           [&](const Look& look) { return shows_same(look, *shown); });
        known.kind_of_value.back() = static_cast<StillRuns::Kind>(is - kinds.looks.begin());
        if (is == kinds.looks.end()) kinds.looks.push_back(*shown);
    }
    if (kinds.looks.empty()) return std::make_shared<const Kinds>();
    const auto alike = std::find_if(known_.begin(), known_.end(), [&](const Known& other) {
        return other.kind_of_value == known.kind_of_value;
    });
    kinds.runs = alike != known_.end() ? alike->kinds->runs
                                       : std::make_shared<const StillRuns>(map_, known.kind_of_value);
    return std::make_shared<const Kinds>(std::move(kinds));
}

Validity RunningCells::through_shifts(const CellBlock& block, const SeenCells& seen, const Validity& frames,
                                      const Ask& ask) const {
    return scroll_interval(scroll_, block, seen, frames,
                           Cells{*this, block.z, false, seen.only_patterns(), ask});
}

Validity RunningCells::through_map(const CellBlock& block) const {
    const Scroll::Place place = scroll_.at(block.step);
    const auto kinds = find(0, 0, true);
    if (!kinds) return place.validity;
    // What is dithered looks at the entries beside
    const std::int64_t margin = std::int64_t{1} << map_->cells_log2;
    CellBlock wide = block;
    wide.x -= margin, wide.y -= margin;
    wide.width += static_cast<std::int32_t>(2 * margin), wide.height += static_cast<std::int32_t>(2 * margin);
    const std::int64_t left = wide.x + place.shift;
    const StillRuns::Kind kind = kinds->runs->kind_at(left, wide.y);
    for (std::int64_t y = wide.y; y < wide.y + wide.height; ++y)
        if (StillRuns::Walk{*kinds->runs, kinds->runs->row_of(y), kind, left, true}.next(wide.width).kind !=
            kind)
            return place.validity;
    SeenCells seen{scroll_.cells};
    const std::int32_t value = kinds->looks[static_cast<std::size_t>(kind)].pattern;
    seen.see(wide.x, wide.y, std::span{&value, 1});
    // Of every entry it is known what it is, and that it stays so
    return scroll_interval(scroll_, wide, seen, {}, Cells{*this, block.z, true, true, {}});
}

std::size_t RunningCells::memory_bytes() const noexcept {
    if (!map_) return 0;
    // Two bits an entry: of two messages and both, and of values; and where its words are
    const auto entries = static_cast<std::size_t>(map_->width) * static_cast<std::size_t>(map_->height);
    return entries + entries / 32 + static_cast<std::size_t>(map_->height) * 512;
}

}  // namespace tessera
