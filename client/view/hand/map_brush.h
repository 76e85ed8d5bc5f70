#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "proto/editables.pb.h"

#include "client/view/hand/hand_edits.h"
#include "client/view/hand/hand_sprite.h"
#include "shared/page/texel_box.h"

namespace tessera {

/// Paints the entries of a stored map. A stroke is as many edits as the server keeps up with, one under way
/// at a time, and is undone as one.
class MapBrush {
  public:
    MapBrush(proto::EditableGrid grid, HandEdits& edits) : grid_{std::move(grid)}, edits_{edits} {}

    const proto::EditableGrid& grid() const { return grid_; }
    std::int32_t value = 0;     ///< What entries become: grid().least() to most().
    double radius_texels = 64;  ///< Entries whose middles lie inside are painted; at least the one under it.

    void press(const HandPoint& at);
    /// Entries between the last place and this one are painted, too.
    void drag(const HandPoint& at);
    void release();
    bool is_down() const { return last_.has_value(); }

    /// Sends what is painted and not sent, unless an edit is under way. Once a frame.
    void advance();
    bool is_under_way() const { return !under_way_.empty() || !waiting_.empty(); }

    struct Entry {
        std::int64_t y = 0, x = 0;
        auto operator<=>(const Entry&) const = default;
    };
    /// The entries that a stamp of the brush paints; none outside of the map.
    std::vector<Entry> entries_at(const HandPoint& at) const;
    /// All that the entries stand for. Nothing: the map repeats, and has no border.
    std::optional<TexelBox> border() const;

  private:
    void stamp(const HandPoint& at);

    proto::EditableGrid grid_;
    HandEdits& edits_;
    std::optional<HandPoint> last_;
    std::set<Entry> done_, waiting_;  ///< Of this stroke
    std::int32_t stroke_value_ = 0;
    std::string under_way_;
    bool joins_ = false;
};

}  // namespace tessera
