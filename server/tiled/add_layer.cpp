#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "server/tiled/scene_builder.h"

namespace tessera {
namespace {

constexpr std::size_t max_pieces = std::size_t{1} << 25;

std::int64_t floor_div(std::int64_t a, std::int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

/// A cell that a tile meets.
struct Piece {
    std::int32_t x, y;     ///< The cell.
    std::uint32_t placed;  ///< Of LayerCells::placed_.
};

/// What lies in each cell of a layer. Tiles may be larger than cells, or moved: then they meet several, and
/// cells hold several tiles, in the order in which the editor draws them (row by row).
class LayerCells {
  public:
    LayerCells(SceneBuilder& builder, const TileLayer& layer) : builder_{builder}, layer_{layer} {}

    Result<void> place(std::int32_t first_x, std::int32_t first_y) {
        if (std::max(std::abs(layer_.offset_x), std::abs(layer_.offset_y)) > (1 << 24))
            return Error{ErrorCode::invalid_input, "layer \"" + layer_.name + "\": is moved too far"};
        const std::int64_t move_x = std::llround(layer_.offset_x), move_y = std::llround(layer_.offset_y);
        if (double(move_x) != layer_.offset_x || double(move_y) != layer_.offset_y)
            leave_out("is moved by parts of a texel; it is moved by (" + std::to_string(move_x) + ", " +
                      std::to_string(move_y) + ")");
        for (std::int32_t y = 0; y < layer_.height; ++y)
            for (std::int32_t x = 0; x < layer_.width; ++x) {
                const TileRef tile =
                    layer_.tiles[std::size_t(y) * std::size_t(layer_.width) + std::size_t(x)];
                if (tile.number() == 0) continue;
                if (tile.has(TileRef::turned_hexagon)) ++hexagons_;
                const TileRef shown = at_rest({tile.gid & ~TileRef::turned_hexagon});
                if (builder_.painter.find(shown) == nullptr) {
                    ++unknown_;
                    continue;
                }
                ++tiles_;
                meet(shown, layer_.x + x - first_x, layer_.y + y - first_y, move_x, move_y);
                if (pieces_.size() > max_pieces)
                    return Error{ErrorCode::invalid_input,
                                 "layer \"" + layer_.name +
                                     "\": its tiles are so large that they meet more than " +
                                     std::to_string(max_pieces) + " cells"};
            }
        if (unknown_ > 0) leave_out(std::to_string(unknown_) + " cells name tiles that no tileset has");
        if (hexagons_ > 0) leave_out(std::to_string(hexagons_) + " tiles are turned as only hexagons can be");
        return {};
    }

    bool empty() const noexcept { return pieces_.empty(); }
    std::size_t tiles() const noexcept { return tiles_; }

    /// The patterns' texels, and which of them each cell shows: a rectangle from (left, top) on.
    struct Painted {
        std::vector<std::uint8_t> codes;
        std::int32_t left = 0, top = 0, width = 0, height = 0;
        std::vector<std::int32_t> patterns;  ///< −1: none
        std::int32_t count = 0;
    };
    Result<Painted> paint() {
        Painted out;
        const auto [left, right] = std::ranges::minmax(pieces_, {}, &Piece::x);
        const auto [top, bottom] = std::ranges::minmax(pieces_, {}, &Piece::y);
        out.left = left.x, out.top = top.y;
        const std::int64_t width = std::int64_t{right.x} - left.x + 1,
                           height = std::int64_t{bottom.y} - top.y + 1;
        if (width > 32768 || height > 32768 || width * height > 2 * max_tiled_cells)
            return Error{ErrorCode::invalid_input, "layer \"" + layer_.name + "\": its tiles reach too far"};
        out.width = static_cast<std::int32_t>(width), out.height = static_cast<std::int32_t>(height);
        out.patterns.assign(std::size_t(width * height), -1);
        std::ranges::stable_sort(pieces_, {}, [](const Piece& piece) { return std::pair{piece.y, piece.x}; });

        std::map<std::vector<std::uint32_t>, std::int32_t> known;
        std::vector<const std::vector<std::uint32_t>*> stacks;  // By pattern.
        for (std::size_t begin = 0; begin < pieces_.size();) {
            std::vector<std::uint32_t> stack;
            const Piece& cell = pieces_[begin];
            for (; begin < pieces_.size() && pieces_[begin].x == cell.x && pieces_[begin].y == cell.y;
                 ++begin)
                stack.push_back(pieces_[begin].placed);
            const auto [found, is_new] = known.try_emplace(stack, out.count);
            if (is_new) {
                stacks.push_back(&found->first);
                if (++out.count > builder_.most_patterns(builder_.painter.side()))
                    return builder_.too_many_patterns("layer \"" + layer_.name + "\"");
            }
            out.patterns[std::size_t(cell.y - out.top) * std::size_t(width) +
                         std::size_t(cell.x - out.left)] = found->second;
        }
        for (const auto* const stack : stacks) {
            std::vector<PlacedTile> tiles;
            for (const std::uint32_t placed : *stack) tiles.push_back(placed_[placed]);
            builder_.painter.paint(tiles, layer_.opacity, layer_.tint, out.codes);
        }
        return out;
    }

  private:
    void leave_out(const std::string& what) {
        builder_.scene().left_out.push_back("layer \"" + layer_.name + "\": " + what);
    }

    /// An animated tile as it is at step 0: its first frame.
    TileRef at_rest(TileRef tile) const {
        const Tileset* const set = builder_.painter.tileset_of(tile);
        if (set == nullptr) return tile;
        const auto animation = set->animations.find(tile.number() - set->first);
        if (animation == set->animations.end()) return tile;
        return {(tile.gid & (7u << 29)) | (set->first + animation->second.frames.front().tile)};
    }

    /// Tiles stand on the bottom of their cell, and begin at its left.
    void meet(TileRef tile, std::int64_t x, std::int64_t y, std::int64_t move_x, std::int64_t move_y) {
        const TileImage& image = *builder_.painter.find(tile);
        const Tileset& set = *builder_.painter.tileset_of(tile);
        const bool transposed = tile.has(TileRef::transposed);
        const std::int64_t width = transposed ? image.height : image.width;
        const std::int64_t height = transposed ? image.width : image.height;
        const std::int64_t cell_width = builder_.map().tile_width, cell_height = builder_.map().tile_height;
        const std::int64_t left = x * cell_width + set.offset_x + move_x;
        const std::int64_t top = (y + 1) * cell_height - height + set.offset_y + move_y;
        for (std::int64_t j = floor_div(top, cell_height); j * cell_height < top + height; ++j)
            for (std::int64_t i = floor_div(left, cell_width); i * cell_width < left + width; ++i) {
                const PlacedTile placed{tile, static_cast<std::int32_t>(left - i * cell_width),
                                        static_cast<std::int32_t>(top - j * cell_height)};
                const auto [found, is_new] =
                    numbers_.try_emplace(placed, static_cast<std::uint32_t>(placed_.size()));
                if (is_new) placed_.push_back(placed);
                pieces_.push_back(
                    {static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), found->second});
            }
    }

    SceneBuilder& builder_;
    const TileLayer& layer_;
    std::vector<PlacedTile> placed_;
    std::map<PlacedTile, std::uint32_t> numbers_;
    std::vector<Piece> pieces_;
    std::size_t tiles_ = 0, unknown_ = 0, hexagons_ = 0;
};

}  // namespace

Result<std::string> add_layer(SceneBuilder& builder, const TileLayer& layer, std::int32_t first_x,
                              std::int32_t first_y, Progress& progress) {
    LayerCells cells{builder, layer};
    if (auto placed = cells.place(first_x, first_y); !placed) return placed.error();
    if (progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
    if (cells.empty()) {
        builder.scene().left_out.push_back("layer \"" + layer.name + "\": shows no tile");
        return std::string{};
    }
    const auto painted = cells.paint();
    if (!painted) return painted.error();
    const std::string name = layer.name.empty() ? "layer" : layer.name;
    const auto patterns =
        builder.add_patterns(name + "-tiles", "layer \"" + layer.name + "\"", painted->codes);
    if (!patterns) return patterns.error();

    proto::Block& map = builder.add_block(name + "-map");
    TiledScene::Map image{map.name() + ".png", {painted->width, painted->height, {}}};
    const auto blank = static_cast<std::uint16_t>(painted->count);
    for (const std::int32_t pattern : painted->patterns)
        image.image.labels.push_back(pattern < 0 ? blank : static_cast<std::uint16_t>(pattern));
    proto::ExplicitMap& stored = *map.mutable_explicit_indirection_map();
    stored.set_grid(grid_name);
    stored.set_image(image.file);
    stored.set_edge(proto::ExplicitMap::blank);
    stored.set_blank_code(blank);
    stored.set_x(painted->left);
    stored.set_y(painted->top);
    const std::string map_name = map.name();
    builder.scene().maps.push_back(std::move(image));

    proto::Block& texture = builder.add_block(name);
    proto::ReferenceTexture& reference = *texture.mutable_reference_texture();
    reference.set_patterns(*patterns);
    reference.set_grid(grid_name);
    reference.mutable_index()->set_block(map_name);
    builder.scene().made.push_back("layer \"" + layer.name + "\": reference texture \"" + texture.name() +
                                   "\", " + std::to_string(cells.tiles()) + " tiles, " +
                                   std::to_string(painted->count) + " patterns");
    return texture.name();
}

}  // namespace tessera
