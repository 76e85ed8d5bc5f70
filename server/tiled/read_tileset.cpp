#include "server/tiled/read_tileset.h"

#include <algorithm>
#include <charconv>

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t max_tile_number = (1 << 28) - 1;
constexpr std::int64_t max_image_texels = std::int64_t{1} << 27;  ///< Of all images of a map together.
constexpr std::size_t max_tiles = 65536;                          ///< Of a tileset.

std::optional<std::array<std::uint8_t, 3>> color_of(std::string_view text) {
    if (text.starts_with('#')) text.remove_prefix(1);
    std::uint32_t value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if (text.size() != 6 || failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return std::array{static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 8),
                      static_cast<std::uint8_t>(value)};
}

/// Reads one tileset, part by part.
class TilesetReader {
  public:
    TilesetReader(const pugi::xml_node& element, XmlNumbers& numbers, TiledMap& map, Tileset& set)
        : element_{element}, numbers_{numbers}, map_{map}, set_{set} {}

    /// "topleft", "bottom", "center", …; unset or "unspecified" is the bottom left of orthogonal maps.
    void align(std::string_view name) {
        if (name.empty() || name == "unspecified") return;
        const auto holds = [name](std::string_view part) { return name.find(part) != name.npos; };
        set_.align_x = holds("left") ? 0 : holds("right") ? 1 : 0.5;
        set_.align_y = holds("top") ? 0 : holds("bottom") ? 1 : 0.5;
    }

    Result<void> read() {
        set_.name = element_.attribute("name").as_string("tiles");
        const pugi::xml_node offset = element_.child("tileoffset");
        set_.offset_x = static_cast<std::int32_t>(numbers_.integer(offset, "x", -4096, 4096, 0));
        set_.offset_y = static_cast<std::int32_t>(numbers_.integer(offset, "y", -4096, 4096, 0));
        align(element_.attribute("objectalignment").value());
        if (std::string_view{element_.attribute("tilerendersize").as_string("tile")} != "tile")
            leave_out("its tiles are drawn in their own size, and not fitted to the map's grid");
        if (const pugi::xml_node image = element_.child("image"))
            if (auto cut = cut_image(image); !cut) return cut;
        for (const pugi::xml_node& tile : element_.children("tile"))
            if (auto read = read_tile(tile); !read) return read;
        if (shapes_ > 0)
            leave_out(std::to_string(shapes_) + " tiles have collision shapes, which are no colours");
        read_wang_sets();
        read_terrains();
        if (numbers_.error()) return *numbers_.error();
        return {};
    }

  private:
    void leave_out(const std::string& what) {
        map_.left_out.push_back("tileset \"" + set_.name + "\": " + what);
    }

    Result<std::size_t> read_image(const pugi::xml_node& image) {
        const std::string source = image.attribute("source").value();
        if (source.empty())
            return numbers_.wrong(image, "has no source; images inside of the file are not read");
        std::int64_t texels = 0;
        for (const auto& known : map_.images) texels += std::int64_t{known.width} * known.height;
        auto read = read_rgba_image(numbers_.file().parent_path() / source,
                                    {.max_texels = max_image_texels - texels});
        if (!read) return read.error();
        if (const char* trans = image.attribute("trans").value(); *trans != '\0') {
            const auto key = color_of(trans);
            if (!key)
                return numbers_.wrong(image,
                                      "trans is \"" + std::string{trans} + "\"; six hexadecimal digits");
            for (std::size_t i = 0; i < read->bytes.size(); i += 4)
                if (std::equal(key->begin(), key->end(),
                               read->bytes.begin() + static_cast<std::ptrdiff_t>(i)))
                    read->bytes[i + 3] = 0;
        }
        map_.images.push_back(std::move(*read));
        return map_.images.size() - 1;
    }

    /// All tiles of one image, row by row.
    Result<void> cut_image(const pugi::xml_node& element) {
        const auto width = numbers_.integer(element_, "tilewidth", 1, max_tile_texels);
        const auto height = numbers_.integer(element_, "tileheight", 1, max_tile_texels);
        const auto margin = numbers_.integer(element_, "margin", 0, 4096, 0);
        const auto spacing = numbers_.integer(element_, "spacing", 0, 4096, 0);
        if (numbers_.error()) return *numbers_.error();
        const auto index = read_image(element);
        if (!index) return index.error();
        const StraightRgba8Image& image = map_.images[*index];
        const auto fit = [&](std::int64_t side, std::int64_t tile) {
            return std::max<std::int64_t>(0, (side - margin + spacing) / (tile + spacing));
        };
        const std::int64_t columns = fit(image.width, width), rows = fit(image.height, height);
        if (columns * rows < 1 || columns * rows > static_cast<std::int64_t>(max_tiles))
            return numbers_.wrong(element_, "its image, " + std::to_string(image.width) + "×" +
                                                std::to_string(image.height) + ", holds " +
                                                std::to_string(columns * rows) + " tiles; 1 to " +
                                                std::to_string(max_tiles));
        for (std::int64_t i = 0; i < columns * rows; ++i)
            set_.tiles[static_cast<std::uint32_t>(i)] = {
                *index, static_cast<std::int32_t>(margin + i % columns * (width + spacing)),
                static_cast<std::int32_t>(margin + i / columns * (height + spacing)),
                static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
        return {};
    }

    Result<void> read_tile(const pugi::xml_node& tile) {
        const auto id = static_cast<std::uint32_t>(numbers_.integer(tile, "id", 0, max_tile_number));
        if (const double probability = numbers_.number(tile, "probability", 1); probability != 1) {
            if (probability < 0) numbers_.fail(tile, "probability is below 0");
            set_.probabilities[id] = probability;
        }
        if (tile.child("objectgroup")) ++shapes_;
        if (numbers_.error()) return *numbers_.error();
        if (const pugi::xml_node element = tile.child("image")) {
            if (set_.tiles.size() >= max_tiles) return numbers_.wrong(element_, "has more than 65536 tiles");
            const auto index = read_image(element);
            if (!index) return index.error();
            const StraightRgba8Image& image = map_.images[*index];
            // Since Tiled 1.9 a tile may be a part of its image
            TileImage part{*index};
            part.x = static_cast<std::int32_t>(numbers_.integer(tile, "x", 0, image.width - 1, 0));
            part.y = static_cast<std::int32_t>(numbers_.integer(tile, "y", 0, image.height - 1, 0));
            part.width = static_cast<std::int32_t>(
                numbers_.integer(tile, "width", 1, image.width - part.x, image.width - part.x));
            part.height = static_cast<std::int32_t>(
                numbers_.integer(tile, "height", 1, image.height - part.y, image.height - part.y));
            if (std::max(part.width, part.height) > max_tile_texels)
                return numbers_.wrong(tile, "is " + std::to_string(part.width) + "×" +
                                                std::to_string(part.height) + " texels; at most " +
                                                std::to_string(max_tile_texels) + " a side");
            set_.tiles[id] = part;
        }
        if (const pugi::xml_node animation = tile.child("animation")) {
            TileAnimation& frames = set_.animations[id];
            for (const pugi::xml_node& frame : animation.children("frame"))
                frames.frames.push_back(
                    {static_cast<std::uint32_t>(numbers_.integer(frame, "tileid", 0, max_tile_number)),
                     static_cast<std::uint32_t>(numbers_.integer(frame, "duration", 1, 1 << 30))});
            if (frames.frames.empty()) set_.animations.erase(id);
        }
        return {};
    }

    void read_wang_sets() {
        for (const pugi::xml_node& element : element_.child("wangsets").children("wangset")) {
            WangSet wang{element.attribute("name").as_string("terrain"), {}, {}};
            const std::string_view type = element.attribute("type").as_string("corner");
            if (type != "corner") {
                leave_out("the terrain set \"" + wang.name + "\" colours " + std::string{type} +
                          " sides; transition tiles know corners only");
                continue;
            }
            // Before Tiled 1.5 colours of corners and edges were listed apart
            for (const pugi::xml_node& color : element.children())
                if (const std::string_view name = color.name();
                    name == "wangcolor" || name == "wangcornercolor")
                    wang.colors.emplace_back(color.attribute("name").as_string("color"));
            for (const pugi::xml_node& tile : element.children("wangtile")) {
                WangTile colored{
                    static_cast<std::uint32_t>(numbers_.integer(tile, "tileid", 0, max_tile_number)), {}};
                const auto id = wang_id(tile.attribute("wangid").value());
                if (!id)
                    return numbers_.fail(
                        tile,
                        "wangid is \"" + std::string{tile.attribute("wangid").value()} + "\"; eight colours");
                // Clockwise from the top: the odd ones are corners, the first of them top right
                colored.corners = {(*id)[7], (*id)[1], (*id)[5], (*id)[3]};
                wang.tiles.push_back(colored);
            }
            set_.wang_sets.push_back(std::move(wang));
        }
    }

    /// "0,1,0,2,0,1,0,1", or before Tiled 1.5 "0x10201010", the last digit first.
    static std::optional<std::array<std::uint8_t, 8>> wang_id(std::string_view text) {
        std::array<std::uint8_t, 8> id{};
        if (text.starts_with("0x")) {
            std::uint32_t value = 0;
            const auto [end, failure] =
                std::from_chars(text.data() + 2, text.data() + text.size(), value, 16);
            if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
            for (std::size_t i = 0; i < 8; ++i) id[i] = static_cast<std::uint8_t>(value >> 4 * i & 15);
            return id;
        }
        const char* at = text.data();
        const char* const end = at + text.size();
        for (std::size_t i = 0; i < 8; ++i) {
            const auto [next, failure] = std::from_chars(at, end, id[i]);
            if (failure != std::errc{} || (i == 7 ? next != end : next == end || *next != ','))
                return std::nullopt;
            at = next + 1;
        }
        return id;
    }

    /// Terrains, which Wang sets replaced in Tiled 1.5: terrain="top left,top right,bottom left,bottom
    /// right".
    void read_terrains() {
        const pugi::xml_node types = element_.child("terraintypes");
        if (!types) return;
        WangSet wang{"terrains", {}, {}};
        for (const pugi::xml_node& terrain : types.children("terrain"))
            wang.colors.emplace_back(terrain.attribute("name").as_string("terrain"));
        for (const pugi::xml_node& tile : element_.children("tile")) {
            const std::string_view text = tile.attribute("terrain").value();
            if (text.empty()) continue;
            WangTile colored{static_cast<std::uint32_t>(tile.attribute("id").as_uint()), {}};
            std::size_t begin = 0;
            for (std::size_t corner = 0; corner < 4 && begin <= text.size(); ++corner) {
                const std::size_t end = std::min(text.find(',', begin), text.size());
                unsigned color = 0;
                if (std::from_chars(text.data() + begin, text.data() + end, color).ec == std::errc{} &&
                    color < 254)
                    colored.corners[corner] = static_cast<std::uint8_t>(color + 1);
                begin = end + 1;
            }
            wang.tiles.push_back(colored);
        }
        set_.wang_sets.push_back(std::move(wang));
    }

    const pugi::xml_node& element_;
    XmlNumbers& numbers_;
    TiledMap& map_;
    Tileset& set_;
    std::size_t shapes_ = 0;
};

}  // namespace

Result<void> read_tileset(const pugi::xml_node& element, std::uint32_t first, XmlNumbers& numbers,
                          TiledMap& map) {
    Tileset set;
    set.first = first;
    if (auto read = TilesetReader{element, numbers, map, set}.read(); !read) return read;
    map.tilesets.push_back(std::move(set));
    return {};
}

}  // namespace tessera
