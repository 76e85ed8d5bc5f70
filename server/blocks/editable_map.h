#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/blocks/stored_map.h"
#include "shared/page/page_key.h"
#include "shared/page/texel_box.h"

namespace tessera {

/// A map whose entries edits may change, and how far an entry is seen: of all textures that read it, the
/// farthest.
struct EditableMap {
    std::string block;
    StoredMap map;  ///< Where its range is not bounded, entries are only known to be possible once compiled.
    int cell_log2 = 0;       ///< Texels of a cell's side.
    bool shown = false;      ///< Some texture depends on it.
    bool between_x = false;  ///< Cells between two entries depend on both: the map is dithered.
    bool between_y = false;
    int reach = 0;          ///< A cell reads entries of cells so much further right and below: transitions.
    bool overflow = false;  ///< Instances hang over into the next cells.
    bool scrolls = false;   ///< Cells run, and an entry with them.
};

/// Entries (x, y) to (x + width, y + height), inside the map.
struct EntryBox {
    std::int64_t x = 0, y = 0;
    std::int32_t width = 1, height = 1;
};

/// The whole plane, for what may change everywhere.
inline constexpr TexelBox every_texel{-(std::int64_t{1} << 39), -(std::int64_t{1} << 39),
                                      std::int64_t{1} << 39, std::int64_t{1} << 39};

/// The texels of level 0 that depend on these entries. No page of `extent` outside of them, at any level,
/// changes with them by a byte. A map that repeats gives several boxes, or the whole plane.
std::vector<TexelBox> texels_of_entries(const EditableMap& map, const EntryBox& entries, Extent extent);

}  // namespace tessera
