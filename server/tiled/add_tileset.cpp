#include <algorithm>
#include <cmath>
#include <map>

#include "server/tiled/scene_builder.h"

namespace tessera {
namespace {

/// What draws among tiles: fine enough for probabilities of a thousandth.
constexpr std::uint32_t draws = 65536;

class TilesetBlocks {
  public:
    TilesetBlocks(SceneBuilder& builder, const Tileset& set) : builder_{builder}, set_{set} {}

    Result<void> add(std::uint32_t step_milliseconds) {
        if (set_.probabilities.empty() && set_.animations.empty() && set_.wang_sets.empty()) return {};
        const TiledMap& map = builder_.map();
        for (const auto& [tile, image] : set_.tiles)
            if (image.width != map.tile_width || image.height != map.tile_height) {
                leave_out(
                    "its tiles are not of the map's size, so its probabilities, terrains and animations "
                    "stay behind");
                return {};
            }
        if (auto painted = paint(); !painted) return painted;
        if (!set_.probabilities.empty()) add_probabilities();
        for (const auto& [tile, animation] : set_.animations)
            add_animation(tile, animation, step_milliseconds);
        if (!set_.animations.empty())
            leave_out(std::to_string(set_.animations.size()) +
                      " animated tiles stand at their first frame where layers show them; a step of their "
                      "sequences is " +
                      std::to_string(step_milliseconds) + " ms");
        for (const WangSet& wang : set_.wang_sets) add_terrains(wang);
        return {};
    }

  private:
    void leave_out(const std::string& what) {
        builder_.scene().left_out.push_back("tileset \"" + set_.name + "\": " + what);
    }
    void say(const std::string& what) {
        builder_.scene().made.push_back("tileset \"" + set_.name + "\": " + what);
    }

    /// A scene has at most 4096 blocks; some are kept for what follows.
    bool has_room() const { return builder_.scene().scene.pattern().blocks_size() < 3900; }

    Result<void> paint() {
        if (std::ssize(set_.tiles) > builder_.most_patterns(builder_.painter.side()))
            return builder_.too_many_patterns("tileset \"" + set_.name + "\"");
        std::vector<std::uint8_t> codes;
        for (const auto& [tile, image] : set_.tiles) {
            patterns_[tile] = static_cast<std::int32_t>(patterns_.size());
            builder_.painter.paint({{TileRef{set_.first + tile}, 0, 0}}, 1, {1, 1, 1, 1}, codes);
        }
        const auto patterns =
            builder_.add_patterns(set_.name + "-tiles", "tileset \"" + set_.name + "\"", codes);
        if (!patterns) return patterns.error();
        patterns_name_ = *patterns;
        return {};
    }

    /// A draw for each cell, made when it is first needed.
    const std::string& draw() {
        if (!draw_name_.empty()) return draw_name_;
        proto::Block& block = builder_.add_block(set_.name + "-draw");
        block.mutable_virtual_indirection_map()->set_grid(grid_name);
        block.mutable_virtual_indirection_map()->set_count(draws);
        return draw_name_ = block.name();
    }

    std::string add_texture(const std::string& wish, const std::string& index) {
        proto::Block& block = builder_.add_block(wish);
        block.mutable_reference_texture()->set_patterns(patterns_name_);
        block.mutable_reference_texture()->set_grid(grid_name);
        block.mutable_reference_texture()->mutable_index()->set_block(index);
        return block.name();
    }

    /// These tiles, each as often as its probability says.
    void fill(proto::Material& material, const std::vector<std::uint32_t>& tiles) {
        std::vector<double> shares;
        double sum = 0;
        for (const std::uint32_t tile : tiles) {
            const auto found = set_.probabilities.find(tile);
            shares.push_back(found == set_.probabilities.end() ? 1 : found->second);
            sum += shares.back();
        }
        if (sum <= 0) {
            leave_out("all probabilities of a choice are 0; its tiles are equally likely");
            std::ranges::fill(shares, 1);
            sum = double(shares.size());
        }
        const bool even = std::ranges::all_of(shares, [&](double share) { return share == shares.front(); });
        const double scale = even ? 1 / shares.front()
                                  : std::min(100.0 / *std::ranges::max_element(shares),
                                             (65536.0 - double(tiles.size())) / sum);
        for (std::size_t i = 0; i < tiles.size(); ++i) {
            const auto weight = static_cast<std::uint32_t>(std::llround(shares[i] * scale));
            if (shares[i] <= 0) continue;
            auto& entry = *material.add_entries();
            entry.set_pattern(patterns_.at(tiles[i]));
            if (weight != 1) entry.set_weight(std::max(1u, weight));
        }
    }

    void add_probabilities() {
        std::vector<std::uint32_t> tiles;
        for (const auto& [tile, pattern] : patterns_) tiles.push_back(tile);
        const std::string index = draw();
        proto::Block& block = builder_.add_block(set_.name + "-probabilities");
        const std::string name = block.name();
        proto::ProbabilityMap& map = *block.mutable_probability_map();
        map.mutable_index()->set_block(index);
        fill(*map.mutable_material(), tiles);
        say("probability map \"" + name + "\", shown by \"" + add_texture(set_.name + "-random", name) +
            "\"");
    }

    void add_animation(std::uint32_t tile, const TileAnimation& animation, std::uint32_t step_milliseconds) {
        const std::string who = set_.name + "-" + std::to_string(tile);
        for (const auto& frame : animation.frames)
            if (!patterns_.contains(frame.tile))
                return leave_out("the animation of tile " + std::to_string(tile) +
                                 " names a tile that is not there");
        proto::Block& sequence = builder_.add_block(who + "-frames");
        const std::string sequence_name = sequence.name();
        for (const auto& frame : animation.frames) {
            auto& own = *sequence.mutable_animation_sequence()->add_frames();
            own.set_pattern(patterns_.at(frame.tile));
            own.set_steps(frame.milliseconds / step_milliseconds);
        }
        proto::Block& moving = builder_.add_block(who + "-moving");
        const std::string moving_name = moving.name();
        moving.mutable_animation_map()->set_sequence(sequence_name);
        say("animation sequence \"" + sequence_name + "\", shown by \"" +
            add_texture(who + "-animated", moving_name) + "\"");
    }

    using Corners = std::array<std::uint8_t, 4>;
    using Combinations = std::map<Corners, std::vector<std::uint32_t>>;

    void add_terrains(const WangSet& wang) {
        Combinations combinations;
        for (const WangTile& tile : wang.tiles)
            if (patterns_.contains(tile.tile) && std::ranges::count(tile.corners, 0) == 0)
                combinations[tile.corners].push_back(tile.tile);
        const std::string who = "terrain set \"" + wang.name + "\": ";
        std::size_t meeting = 0;
        for (std::uint8_t a = 1; a <= wang.colors.size() && a < 255; ++a)
            for (std::uint8_t b = static_cast<std::uint8_t>(a + 1); b <= wang.colors.size() && b < 255; ++b) {
                std::size_t there = 0, mixed = 0;
                for (int bits = 0; bits < 16; ++bits)
                    if (combinations.contains(corners_of(bits, a, b)))
                        ++there, mixed += bits != 0 && bits != 15;
                if (mixed == 0 || !has_room()) continue;
                ++meeting;
                const std::string pair = wang.colors[a - 1u] + " and " + wang.colors[b - 1u];
                if (there < 16)
                    leave_out(who + pair + " lack " + std::to_string(16 - there) +
                              " of the 16 combinations of corners, so no transition tiles");
                else
                    say(who + pair + ": transition tiles, shown by \"" +
                        add_transition(wang.colors[a - 1u] + "-" + wang.colors[b - 1u], combinations, a, b) +
                        "\"");
            }
        if (meeting == 0) leave_out(who + "none of its colours meet in a tile");
    }

    static Corners corners_of(int bits, std::uint8_t a, std::uint8_t b) {
        Corners corners{};
        for (std::size_t i = 0; i < 4; ++i) corners[i] = (bits >> i & 1) != 0 ? b : a;
        return corners;
    }

    std::string add_transition(const std::string& pair, const Combinations& combinations, std::uint8_t a,
                               std::uint8_t b) {
        const std::string index = draw();
        proto::Block& areas = builder_.add_block(set_.name + "-" + pair + "-areas");
        const std::string areas_name = areas.name();
        areas.mutable_virtual_indirection_map()->set_grid(grid_name);
        areas.mutable_virtual_indirection_map()->set_count(2);
        proto::Block& block = builder_.add_block(set_.name + "-" + pair + "-transitions");
        const std::string name = block.name();
        proto::TransitionTiles& tiles = *block.mutable_transition_tiles();
        tiles.mutable_material()->set_block(areas_name);
        tiles.mutable_index()->set_block(index);
        tiles.set_families(2);
        for (int bits = 0; bits < 16; ++bits) {
            auto& combination = *tiles.add_combinations();
            for (int i = 0; i < 4; ++i) combination.add_corners(static_cast<std::uint32_t>(bits >> i & 1));
            fill(*combination.mutable_patterns(), combinations.at(corners_of(bits, a, b)));
        }
        return add_texture(set_.name + "-" + pair, name);
    }

    SceneBuilder& builder_;
    const Tileset& set_;
    std::map<std::uint32_t, std::int32_t> patterns_;  ///< Of tiles.
    std::string patterns_name_, draw_name_;
};

}  // namespace

Result<void> add_tileset(SceneBuilder& builder, const Tileset& set, std::uint32_t step_milliseconds) {
    return TilesetBlocks{builder, set}.add(step_milliseconds);
}

}  // namespace tessera
