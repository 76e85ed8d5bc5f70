// Maps are painted a rectangle at a time, through a brush.
#include <algorithm>
#include <map>
#include <optional>
#include <string>

#include "server/edits/live_document.h"
#include "shared/result/in_quotes.h"

namespace tessera {

namespace {

constexpr std::int64_t most_entries = 65536;
/// The edit that undoes one has to fit into one.
constexpr std::size_t most_inverse_bytes = std::size_t{40} << 10;
constexpr std::int32_t most_coded = 0xfffe;

Error wrong(const std::string& what) { return {ErrorCode::invalid_input, what}; }

const EditableMap* find_map(const LiveDocument& document, const std::string& block) {
    if (!document.maps) return nullptr;
    const auto found = std::find_if(document.maps->begin(), document.maps->end(),
                                    [&](const EditableMap& map) { return map.block == block; });
    return found == document.maps->end() ? nullptr : &*found;
}

Error no_such_map(const LiveDocument& document, const std::string& block) {
    constexpr std::size_t most_bytes = 512;
    std::string names;
    if (document.maps)
        for (const EditableMap& map : *document.maps) {
            names += (names.empty() ? "" : ", ") + map.block;
            if (names.size() <= most_bytes) continue;
            names.replace(most_bytes, std::string::npos, " and so on");
            break;
        }
    return wrong("block: " + in_quotes(block) + " is no map that the scene file lists as editable" +
                 (names.empty() ? "; there is none" : "; there are: " + names));
}

bool brushed(const proto::MapPaint& paint, std::size_t i) {
    return paint.mask().empty() || (static_cast<unsigned char>(paint.mask()[i / 8]) >> (i % 8) & 1) != 0;
}

std::int32_t painted_value(const proto::MapPaint& paint, std::size_t i) {
    if (paint.paint_case() == proto::MapPaint::kValue) return paint.value();
    const auto low = static_cast<unsigned char>(paint.values()[2 * i]),
               high = static_cast<unsigned char>(paint.values()[2 * i + 1]);
    const std::int32_t code = low | high << 8;
    return code == 0xffff ? -1 : code;
}

Result<void> check(const proto::MapPaint& paint, const EditableMap& map) {
    const std::int64_t width = paint.width(), height = paint.height();
    if (width < 1 || height < 1) return wrong("width, height: are at least 1");
    if (width > most_entries || height > most_entries || width * height > most_entries)
        return wrong("width, height: are " + std::to_string(width) + " × " + std::to_string(height) +
                     " entries; at most 65536 in all, paint in several rectangles");
    if (paint.x() < 0 || paint.y() < 0 || paint.x() > map.map.width - width ||
        paint.y() > map.map.height - height)
        return wrong("x, y: the rectangle of " + std::to_string(width) + " × " + std::to_string(height) +
                     " entries from (" + std::to_string(paint.x()) + ", " + std::to_string(paint.y()) +
                     ") on is not inside the map, which has " + std::to_string(map.map.width) + " × " +
                     std::to_string(map.map.height));
    const auto entries = static_cast<std::size_t>(width * height);
    if (paint.paint_case() == proto::MapPaint::PAINT_NOT_SET)
        return wrong("value: is missing; give value or values");
    if (paint.paint_case() == proto::MapPaint::kValues && paint.values().size() != entries * 2)
        return wrong("values: have " + std::to_string(paint.values().size()) + " bytes; two for each of " +
                     std::to_string(entries) + " entries");
    if (!paint.mask().empty() && paint.mask().size() != (entries + 7) / 8)
        return wrong("mask: has " + std::to_string(paint.mask().size()) + " bytes; a bit for each of " +
                     std::to_string(entries) + " entries are " + std::to_string((entries + 7) / 8));
    const std::int32_t least = map.map.bounded() ? map.map.least : -1;
    const std::int32_t most = map.map.bounded() ? map.map.most : 0x7fffffff;
    for (std::size_t i = 0; i < entries; ++i) {
        if (!brushed(paint, i)) continue;
        if (const std::int32_t value = painted_value(paint, i); value < least || value > most)
            return wrong("value: " + std::to_string(value) + " is not among what the map can hold; from " +
                         std::to_string(least) + " to " + std::to_string(most));
    }
    return {};
}

/// Old values of the brushed entries, as paints of the same rectangle: one for each value, or one of all.
Result<void> write_inverse(const proto::MapPaint& paint, const StoredMap& map, std::size_t entries,
                           proto::Change& inverse) {
    std::map<std::int32_t, std::string> masks;
    bool coded = true;
    for (std::size_t i = 0; i < entries; ++i) {
        if (!brushed(paint, i)) continue;
        const std::int64_t x = paint.x() + static_cast<std::int64_t>(i % paint.width()),
                           y = paint.y() + static_cast<std::int64_t>(i / paint.width());
        const std::int32_t value = map.values[static_cast<std::size_t>(y * map.width + x)];
        coded = coded && value <= most_coded;
        if (masks.size() <= 1 || masks.contains(value)) {
            std::string& mask = masks[value];
            mask.resize((entries + 7) / 8);
            mask[i / 8] = static_cast<char>(static_cast<unsigned char>(mask[i / 8]) | 1u << (i % 8));
        } else {
            masks[value];  // There are more than two: no use in masks
        }
    }
    proto::MapPaint& back = *inverse.mutable_paint_map();
    back.set_block(paint.block());
    back.set_x(paint.x());
    back.set_y(paint.y());
    back.set_width(paint.width());
    back.set_height(paint.height());
    *back.mutable_mask() = paint.mask();
    if (masks.size() <= 1) {
        back.set_value(masks.empty() ? 0 : masks.begin()->first);
        if (masks.empty()) back.mutable_mask()->assign((entries + 7) / 8, '\0');
        return {};
    }
    if (!coded || entries * 2 > most_inverse_bytes)
        return wrong("width, height: paint over more than can be undone by one edit; at most " +
                     std::to_string(most_inverse_bytes / 2) +
                     " entries that differ from each other: paint in several rectangles");
    std::string& values = *back.mutable_values();
    values.reserve(entries * 2);
    for (std::size_t i = 0; i < entries; ++i) {
        const std::int64_t x = paint.x() + static_cast<std::int64_t>(i % paint.width()),
                           y = paint.y() + static_cast<std::int64_t>(i / paint.width());
        const std::int32_t value =
            brushed(paint, i) ? map.values[static_cast<std::size_t>(y * map.width + x)] : 0;
        values += static_cast<char>(value & 0xff);
        values += static_cast<char>(value >> 8 & 0xff);
    }
    return {};
}

}  // namespace

Result<void> paint_map(const proto::MapPaint& paint, LiveDocument& document, proto::Change& inverse,
                       std::vector<TexelBox>& dirty) {
    if (!document.maps_known)
        if (auto settled = settle(document); !settled) return settled;
    const EditableMap* map = find_map(document, paint.block());
    if (map == nullptr) return no_such_map(document, paint.block());
    if (auto checked = check(paint, *map); !checked) return checked;
    const auto entries = static_cast<std::size_t>(paint.width()) * paint.height();
    StoredMap& painted = document.painted.try_emplace(paint.block(), map->map).first->second;
    if (auto written = write_inverse(paint, painted, entries, inverse); !written) return written;
    for (std::size_t i = 0; i < entries; ++i)
        if (brushed(paint, i))
            painted.values.set(
                static_cast<std::size_t>((paint.y() + static_cast<std::int64_t>(i / paint.width())) *
                                             painted.width +
                                         paint.x() + static_cast<std::int64_t>(i % paint.width())),
                painted_value(paint, i));
    const std::vector<TexelBox> boxes =
        texels_of_entries(*map,
                          {paint.x(), paint.y(), static_cast<std::int32_t>(paint.width()),
                           static_cast<std::int32_t>(paint.height())},
                          document.extent);
    dirty.insert(dirty.end(), boxes.begin(), boxes.end());
    document.edited = true;
    // Of what nobody knows how it is used, only a compilation knows whether it can be
    if (!map->map.bounded()) document.settled = false;
    return {};
}

}  // namespace tessera
