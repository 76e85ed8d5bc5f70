#include <algorithm>
#include <charconv>
#include <cmath>

#include "server/tiled/layer_data.h"
#include "server/tiled/read_objects.h"
#include "server/tiled/read_tileset.h"
#include "server/tiled/tiled_map.h"
#include "server/tiled/xml_file.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t farthest_cell = 1 << 20;  ///< Of an infinite map's chunks.
constexpr int max_group_depth = 32;
constexpr std::size_t max_layers = 64;  ///< As many as a layers block composites, the background among them.

/// "#rrggbb" or "#aarrggbb".
std::optional<std::array<std::uint8_t, 4>> color_of(std::string_view text) {
    if (text.starts_with('#')) text.remove_prefix(1);
    std::uint32_t value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if ((text.size() != 6 && text.size() != 8) || failure != std::errc{} || end != text.data() + text.size())
        return std::nullopt;
    if (text.size() == 6) value |= 0xff000000u;
    return std::array{static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 8),
                      static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 24)};
}

/// What a group hands down to its layers.
struct Inherited {
    double opacity = 1, offset_x = 0, offset_y = 0;
    std::array<double, 4> tint{1, 1, 1, 1};
    bool visible = true;
    int depth = 0;
};

class MapReader {
  public:
    explicit MapReader(const fs::path& file) : numbers_{file} {}

    Result<TiledMap> read() {
        const auto document = read_xml(numbers_.file(), "map");
        if (!document) return document.error();
        const pugi::xml_node root = document->document_element();
        if (auto head = read_head(root); !head) return head.error();
        for (const pugi::xml_node& set : root.children("tileset"))
            if (auto read = take_tileset(set); !read) return read.error();
        std::ranges::sort(map_.tilesets, {}, &Tileset::first);
        if (auto read = read_layers(root, {}); !read) return read.error();
        if (numbers_.error()) return *numbers_.error();
        if (map_.layers.empty() && map_.objects.empty())
            return numbers_.wrong(root,
                                  "has no visible layer of tiles or sprites, of which textures are made" +
                                      (map_.left_out.empty() ? "" : "; it has " + map_.left_out.front()));
        return std::move(map_);
    }

  private:
    void leave_out(const std::string& what) { map_.left_out.push_back(what); }

    Result<void> read_head(const pugi::xml_node& root) {
        const std::string_view orientation = root.attribute("orientation").as_string("orthogonal");
        if (orientation != "orthogonal")
            return numbers_.wrong(
                root, "is " + std::string{orientation} + "; only orthogonal maps become textures");
        map_.tile_width = static_cast<std::int32_t>(numbers_.integer(root, "tilewidth", 1, max_tile_texels));
        map_.tile_height =
            static_cast<std::int32_t>(numbers_.integer(root, "tileheight", 1, max_tile_texels));
        if (!root.attribute("infinite").as_bool()) {
            map_.width = static_cast<std::int32_t>(numbers_.integer(root, "width", 1, 32768));
            map_.height = static_cast<std::int32_t>(numbers_.integer(root, "height", 1, 32768));
        }
        if (const pugi::xml_attribute color = root.attribute("backgroundcolor")) {
            map_.background = color_of(color.value());
            if (!map_.background)
                return numbers_.wrong(root,
                                      "backgroundcolor is \"" + std::string{color.value()} + "\"; #rrggbb");
        }
        if (numbers_.error()) return *numbers_.error();
        return {};
    }

    Result<void> take_tileset(const pugi::xml_node& set) {
        const auto first = static_cast<std::uint32_t>(numbers_.integer(set, "firstgid", 1, (1 << 28) - 1));
        if (numbers_.error()) return *numbers_.error();
        const std::string source = set.attribute("source").value();
        if (source.empty()) return read_tileset(set, first, numbers_, map_);
        XmlNumbers numbers{numbers_.file().parent_path() / source};
        const auto document = read_xml(numbers.file(), "tileset");
        if (!document) return document.error();
        return read_tileset(document->document_element(), first, numbers, map_);
    }

    Result<void> read_layers(const pugi::xml_node& parent, const Inherited& from) {
        for (const pugi::xml_node& node : parent.children()) {
            const std::string_view kind = node.name();
            const std::string name = node.attribute("name").value();
            if (kind == "imagelayer") {
                leave_out("image layer \"" + name + "\": an image at one place; keep it as a layer of tiles");
            } else if (kind == "layer" || kind == "group" || kind == "objectgroup") {
                const Inherited own = inherited(node, from);
                if (!own.visible) {
                    leave_out((kind == "group"   ? "group \""
                               : kind == "layer" ? "layer \""
                                                 : "object layer \"") +
                              name + "\": is hidden in the editor");
                } else if (kind == "objectgroup") {
                    take_objects(node, own);
                } else if (kind == "group") {
                    if (own.depth > max_group_depth) return numbers_.wrong(node, "is nested too deep");
                    if (auto read = read_layers(node, own); !read) return read;
                } else if (auto read = read_layer(node, own); !read) {
                    return read;
                }
            }
        }
        if (numbers_.error()) return *numbers_.error();
        return {};
    }

    Inherited inherited(const pugi::xml_node& node, Inherited from) {
        from.opacity *= std::clamp(numbers_.number(node, "opacity", 1), 0.0, 1.0);
        from.offset_x += numbers_.number(node, "offsetx", 0);
        from.offset_y += numbers_.number(node, "offsety", 0);
        from.visible = from.visible && node.attribute("visible").as_bool(true);
        if (const pugi::xml_attribute tint = node.attribute("tintcolor")) {
            if (const auto color = color_of(tint.value()))
                for (std::size_t i = 0; i < 4; ++i) from.tint[i] *= (*color)[i] / 255.0;
            else
                numbers_.fail(node, "tintcolor is \"" + std::string{tint.value()} + "\"; #rrggbb");
        }
        const std::string who = std::string{node.name()} + " \"" + node.attribute("name").value() + "\": ";
        if (numbers_.number(node, "parallaxx", 1) != 1 || numbers_.number(node, "parallaxy", 1) != 1)
            leave_out(who + "moves slower or faster than the map (parallax)");
        if (const std::string mode = node.attribute("mode").as_string("normal"); mode != "normal")
            leave_out(who + "is blended as \"" + mode + "\"; it is laid over what is below");
        ++from.depth;
        return from;
    }

    void take_objects(const pugi::xml_node& group, const Inherited& own) {
        ObjectLayer layer = read_objects(group, numbers_, map_.left_out);
        if (layer.objects.empty()) return;
        layer.above = map_.layers.size();
        layer.opacity = own.opacity;
        layer.tint = own.tint;
        layer.offset_x = own.offset_x;
        layer.offset_y = own.offset_y;
        map_.objects.push_back(std::move(layer));
    }

    Result<void> read_layer(const pugi::xml_node& node, const Inherited& own) {
        if (map_.layers.size() + 1 >= max_layers)
            return numbers_.wrong(node, "is one layer too many; at most " + std::to_string(max_layers - 1));
        TileLayer layer;
        layer.name = node.attribute("name").value();
        layer.opacity = own.opacity;
        layer.tint = own.tint;
        layer.offset_x = own.offset_x;
        layer.offset_y = own.offset_y;
        const pugi::xml_node data = node.child("data");
        if (!data) return numbers_.wrong(node, "has no data");
        if (map_.width != 0) {
            layer.width = static_cast<std::int32_t>(numbers_.integer(node, "width", 1, 32768));
            layer.height = static_cast<std::int32_t>(numbers_.integer(node, "height", 1, 32768));
            if (auto good = check_size(node, layer.width, layer.height); !good) return good;
            auto tiles = read_tiles(node, data, data, std::size_t(layer.width) * std::size_t(layer.height));
            if (!tiles) return tiles.error();
            layer.tiles = std::move(*tiles);
        } else if (auto read = read_chunks(node, data, layer); !read) {
            return read;
        }
        if (layer.width == 0) {
            leave_out("layer \"" + layer.name + "\": is empty");
            return {};
        }
        map_.layers.push_back(std::move(layer));
        return {};
    }

    Result<void> check_size(const pugi::xml_node& node, std::int64_t width, std::int64_t height) {
        if (numbers_.error()) return *numbers_.error();
        cells_ += width * height;
        if (width * height <= max_tiled_cells && cells_ <= 4 * max_tiled_cells) return {};
        return numbers_.wrong(node, "covers " + std::to_string(width) + "×" + std::to_string(height) +
                                        " cells; a layer has at most " + std::to_string(max_tiled_cells) +
                                        ", a map four times as many");
    }

    /// The tiles of a <data> or of a <chunk> in it.
    Result<std::vector<TileRef>> read_tiles(const pugi::xml_node& layer, const pugi::xml_node& data,
                                            const pugi::xml_node& part, std::size_t count) {
        std::vector<TileRef> tiles;
        tiles.reserve(count);
        const std::string_view encoding = data.attribute("encoding").value();
        if (encoding.empty()) {  // one element a tile
            for (const pugi::xml_node& tile : part.children("tile")) {
                if (tiles.size() == count) break;
                tiles.push_back(
                    {static_cast<std::uint32_t>(numbers_.integer(tile, "gid", 0, 0xffffffff, 0))});
            }
            if (numbers_.error()) return *numbers_.error();
            if (tiles.size() != count)
                return numbers_.wrong(layer, "lists " + std::to_string(tiles.size()) + " tiles for " +
                                                 std::to_string(count) + " cells");
            return tiles;
        }
        const auto numbers =
            decode_layer(part.text().get(), encoding, data.attribute("compression").value(), count);
        if (!numbers) return numbers_.wrong(layer, numbers.error().detail);
        for (const std::uint32_t gid : *numbers) tiles.push_back({gid});
        return tiles;
    }

    /// The rectangle around all chunks.
    Result<void> read_chunks(const pugi::xml_node& node, const pugi::xml_node& data, TileLayer& layer) {
        struct Chunk {
            std::int64_t x, y, width, height;
            pugi::xml_node element;
        };
        std::vector<Chunk> chunks;
        std::int64_t chunk_cells = 0;
        std::int64_t left = farthest_cell, top = farthest_cell, right = -farthest_cell,
                     bottom = -farthest_cell;
        for (const pugi::xml_node& element : data.children("chunk")) {
            const Chunk chunk{numbers_.integer(element, "x", -farthest_cell, farthest_cell),
                              numbers_.integer(element, "y", -farthest_cell, farthest_cell),
                              numbers_.integer(element, "width", 1, 4096),
                              numbers_.integer(element, "height", 1, 4096), element};
            if (numbers_.error()) return *numbers_.error();
            if ((chunk_cells += chunk.width * chunk.height) > 2 * max_tiled_cells)
                return numbers_.wrong(
                    node, "has chunks of more than " + std::to_string(2 * max_tiled_cells) + " cells");
            left = std::min(left, chunk.x), top = std::min(top, chunk.y);
            right = std::max(right, chunk.x + chunk.width), bottom = std::max(bottom, chunk.y + chunk.height);
            chunks.push_back(chunk);
        }
        if (chunks.empty()) return {};
        if (right - left > 32768 || bottom - top > 32768)
            return numbers_.wrong(node, "reaches over more than 32768 cells");
        if (auto good = check_size(node, right - left, bottom - top); !good) return good;
        layer.x = static_cast<std::int32_t>(left);
        layer.y = static_cast<std::int32_t>(top);
        layer.width = static_cast<std::int32_t>(right - left);
        layer.height = static_cast<std::int32_t>(bottom - top);
        layer.tiles.resize(std::size_t(layer.width) * std::size_t(layer.height));
        for (const Chunk& chunk : chunks) {
            const auto tiles =
                read_tiles(node, data, chunk.element, std::size_t(chunk.width) * std::size_t(chunk.height));
            if (!tiles) return tiles.error();
            for (std::int64_t y = 0; y < chunk.height; ++y)
                std::copy_n(tiles->begin() + y * chunk.width, chunk.width,
                            layer.tiles.begin() + (chunk.y - top + y) * layer.width + (chunk.x - left));
        }
        return {};
    }

    XmlNumbers numbers_;
    TiledMap map_;
    std::int64_t cells_ = 0;
};

}  // namespace

Result<TiledMap> read_tiled_map(const fs::path& file) { return MapReader{file}.read(); }

}  // namespace tessera
