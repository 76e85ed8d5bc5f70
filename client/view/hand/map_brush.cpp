#include "client/view/hand/map_brush.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

/// A rectangle of an edit: its mask takes a bit an entry, and its inverse two bytes.
constexpr std::int64_t most_entries = 16384;

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
    const std::int64_t q = a / b;
    return q * b > a ? q - 1 : q;
}

}  // namespace

std::vector<MapBrush::Entry> MapBrush::entries_at(const HandPoint& at) const {
    const auto side = static_cast<std::int64_t>(grid_.entry_texels());
    std::vector<Entry> entries;
    if (side < 1 || grid_.width() < 1 || grid_.height() < 1) return entries;
    // Relative to the map's corner, in texels; entries at corners have their middles there
    const double x = static_cast<double>(at.x - grid_.x() * sprite_units) / sprite_units,
                 y = static_cast<double>(at.y - grid_.y() * sprite_units) / sprite_units;
    const double shift = grid_.corners() ? 0 : 0.5, texels = static_cast<double>(side);
    const double reach = std::min(radius_texels / texels, 60.0);
    const double column = x / texels - shift, row = y / texels - shift;
    const auto nearest_column = static_cast<std::int64_t>(std::floor(column + 0.5)),
               nearest_row = static_cast<std::int64_t>(std::floor(row + 0.5));
    const auto around = static_cast<std::int64_t>(reach) + 1;
    for (std::int64_t j = nearest_row - around; j <= nearest_row + around; ++j)
        for (std::int64_t i = nearest_column - around; i <= nearest_column + around; ++i) {
            const bool is_under = i == nearest_column && j == nearest_row;
            if (!is_under &&
                std::hypot(static_cast<double>(i) - column, static_cast<double>(j) - row) > reach)
                continue;
            Entry entry{j, i};
            if (grid_.repeats()) {
                entry.x -= floor_div(i, grid_.width()) * grid_.width();
                entry.y -= floor_div(j, grid_.height()) * grid_.height();
            } else if (i < 0 || j < 0 || i >= grid_.width() || j >= grid_.height()) {
                continue;
            }
            entries.push_back(entry);
        }
    return entries;
}

std::optional<TexelBox> MapBrush::border() const {
    if (grid_.repeats()) return std::nullopt;
    const auto side = static_cast<std::int64_t>(grid_.entry_texels());
    const std::int64_t shift = grid_.corners() ? side / 2 : 0;
    const std::int64_t left = grid_.x() - shift, top = grid_.y() - shift;
    return TexelBox{left, top, left + grid_.width() * side, top + grid_.height() * side};
}

void MapBrush::stamp(const HandPoint& at) {
    for (const Entry& entry : entries_at(at))
        if (done_.insert(entry).second) waiting_.insert(entry);
}

void MapBrush::press(const HandPoint& at) {
    done_.clear();
    stroke_value_ = value;
    joins_ = false;
    last_ = at;
    stamp(at);
}

void MapBrush::drag(const HandPoint& at) {
    if (!last_) return;
    const double dx = static_cast<double>(at.x - last_->x), dy = static_cast<double>(at.y - last_->y);
    const double step =
        std::max(radius_texels, static_cast<double>(grid_.entry_texels()) / 2) / 2 * sprite_units;
    const int steps = static_cast<int>(std::min(256.0, std::hypot(dx, dy) / std::max(step, 1.0)));
    for (int i = 1; i <= steps; ++i) {
        const double share = static_cast<double>(i) / (steps + 1);
        stamp({last_->x + static_cast<std::int64_t>(share * dx),
               last_->y + static_cast<std::int64_t>(share * dy)});
    }
    stamp(at);
    last_ = at;
}

void MapBrush::release() { last_.reset(); }

void MapBrush::advance() {
    if (edits_.is_waiting(under_way_)) return;
    under_way_.clear();
    if (waiting_.empty()) return;
    // One rectangle around as many rows as fit; what lies far apart goes with the next edit
    proto::Change change;
    proto::MapPaint& paint = *change.mutable_paint_map();
    std::int64_t left = waiting_.begin()->x, right = left;
    const std::int64_t top = waiting_.begin()->y;
    std::vector<Entry> taken;
    for (const Entry& entry : waiting_) {
        const std::int64_t to_left = std::min(left, entry.x), to_right = std::max(right, entry.x);
        if ((to_right - to_left + 1) * (entry.y - top + 1) > most_entries) continue;
        left = to_left;
        right = to_right;
        taken.push_back(entry);
    }
    const std::int64_t width = right - left + 1, height = taken.back().y - top + 1;
    std::string mask(static_cast<std::size_t>((width * height + 7) / 8), '\0');
    for (const Entry& entry : taken) {
        const auto bit = static_cast<std::size_t>((entry.y - top) * width + entry.x - left);
        mask[bit / 8] = static_cast<char>(static_cast<unsigned char>(mask[bit / 8]) | 1U << bit % 8);
        waiting_.erase(entry);
    }
    paint.set_block(grid_.block());
    paint.set_x(left);
    paint.set_y(top);
    paint.set_width(static_cast<std::uint32_t>(width));
    paint.set_height(static_cast<std::uint32_t>(height));
    paint.set_value(stroke_value_);
    paint.set_mask(std::move(mask));
    under_way_ = edits_.make({std::move(change)}, 0, joins_);
    joins_ = true;
}

}  // namespace tessera
