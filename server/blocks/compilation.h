#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/blocks/cell_node.h"
#include "server/blocks/editable_map.h"
#include "server/blocks/field_error.h"
#include "server/blocks/graph.h"
#include "server/blocks/plan.h"

namespace tessera {

/// How numbers become the steps of a look.
struct LookSteps {
    std::int32_t turns = 1;       ///< Steps of a whole turn, …
    std::int32_t first_turn = 0;  ///< … and the first that occurs.
    std::int32_t scales = 1;
    std::int32_t scale_least = 0, scale_most = 0;

    std::uint8_t turn(std::int32_t value) const noexcept;   ///< `value`: 0 to 1 turn.
    std::uint8_t scale(std::int32_t value) const noexcept;  ///< `value`: scale_least to scale_most.
};

/// A transform's inputs, as nodes, and how they are rounded.
struct TransformNodes {
    std::size_t x = 0, y = 0, turn = 0, scale = 0;
    LookSteps steps;
    std::size_t grid = no_block;
    std::shared_ptr<const TransformPlan> plan;
    std::string path;
};

/// What a block became. Which of these is set follows from its output.
struct Compiled {
    std::size_t node = no_block;
    std::shared_ptr<const PatternImages> patterns;
    std::shared_ptr<const FrameLine> frames;
    std::shared_ptr<const TransformNodes> transform;
    std::size_t texture = no_block;  ///< In Plan::textures.
    std::size_t weight = 1;          ///< Of a texture: itself and all it shows, as often as it shows them.
};

/// The most that a texture may weigh: what shows itself through many ways costs each of them.
inline constexpr std::size_t max_texture_weight = 1024;

struct GridBlock {
    Grid grid;
    std::uint32_t types = 4096;
};

/// A reference texture that waits until all generators are known.
struct PendingReference {
    std::size_t block = no_block;
    std::size_t texture = no_block;
    std::size_t grid = no_block;
    std::size_t index = no_block;  ///< Node
    std::shared_ptr<const TransformNodes> transform;
    Scroll scroll;
};

/// A plan while it is compiled. Blocks come parts before wholes.
struct Compilation {
    const Graph& graph;
    BlockFiles& files;
    std::uint64_t seed = 0;
    std::vector<CellNode> nodes{};
    std::vector<Compiled> blocks{};            ///< By block.
    std::map<std::size_t, GridBlock> grids{};  ///< By block.
    std::vector<PendingReference> references{};
    std::vector<std::string> notes{};               ///< By block: for PlanLine.
    std::size_t table_room = std::size_t{1} << 24;  ///< Integers that look-up tables may still take.
    Plan plan{};

    /// The block that a field names. Its name was checked.
    std::size_t named(std::string_view name) const { return graph.find(name); }
    const CellNode& node_of(std::size_t block) const { return nodes[blocks[block].node]; }

    std::size_t add_constant(std::int32_t value, bool number);
    /// Adds a node of `block`: works out grid, reach and steps from its inputs, and folds it if it can show
    /// one value only. Error: its inputs live on different grids, or corners of corners reach too far.
    Result<std::size_t> add_node(std::size_t block, CellNode node);

    /// The node of an integer field. `fallback` where it is unset. Errors: a number; outside [least, most].
    Result<std::size_t> integer(std::size_t block, std::string_view field, const proto::Value& value,
                                std::int32_t fallback);
    /// The node of a number field, in steps of 2^-16; integers are turned into numbers.
    Result<std::size_t> number(std::size_t block, std::string_view field, const proto::Value& value,
                               double fallback, double least, double most);
    /// The textures that `block`, a texture itself, shows, as indices of Plan::textures; notes its weight.
    /// Error: it weighs more than max_texture_weight.
    Result<std::vector<std::size_t>> shown(std::size_t block,
                                           const google::protobuf::RepeatedPtrField<std::string>& names);
    /// The key of a block's stream on a grid.
    std::uint64_t stream_key(std::size_t block, std::uint32_t asked, std::size_t grid) const;

    Error error(std::size_t block, std::string_view field, std::string_view what) const {
        return field_error(graph.blocks[block].path + std::string{field}, what);
    }
};

/// "from 0 to 15", for messages.
std::string range_text(const CellNode& node);
/// 0.5 and the like, for messages: as many digits as say it.
std::string number_text(double value);
/// The nearest step of 2^-16. `value` is finite and within ±32767.
std::int32_t to_number(double value) noexcept;

/// Whether the block lists `what` as editable: a field by its path, or "map".
bool is_editable(const proto::Block& block, std::string_view what);
/// What all that read the map `block` take, where each of them has a list to choose from; nothing where one
/// does not, or there are very many.
std::optional<std::pair<std::int32_t, std::int32_t>> paintable_range(const Compilation& c, std::size_t block);
/// How far the editable maps are seen, of all that was compiled. Before the programs are made.
void find_support(Compilation& c);

// One for each block: compiles block `block`, whose parts are compiled.
Result<void> compile_pattern_set(Compilation& c, std::size_t block);
Result<void> compile_virtual_tile_map(Compilation& c, std::size_t block);
Result<void> compile_explicit_indirection_map(Compilation& c, std::size_t block);
Result<void> compile_virtual_indirection_map(Compilation& c, std::size_t block);
Result<void> compile_virtual_random_map(Compilation& c, std::size_t block);
Result<void> compile_probability_map(Compilation& c, std::size_t block);
Result<void> compile_materials_map(Compilation& c, std::size_t block);
Result<void> compile_areas_map(Compilation& c, std::size_t block);
Result<void> compile_dithered_areas_map(Compilation& c, std::size_t block);
Result<void> compile_transition_tiles(Compilation& c, std::size_t block);
Result<void> compile_animation_sequence(Compilation& c, std::size_t block);
Result<void> compile_animation_map(Compilation& c, std::size_t block);
Result<void> compile_driven_animation(Compilation& c, std::size_t block);  ///< By targets, or by requests.
Result<void> compile_tile_transform(Compilation& c, std::size_t block);
Result<void> compile_reference_texture(Compilation& c, std::size_t block);
Result<void> compile_pixel_map(Compilation& c, std::size_t block);
Result<void> compile_layers(Compilation& c, std::size_t block);
Result<void> compile_given(Compilation& c, std::size_t block);

}  // namespace tessera
