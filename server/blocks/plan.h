#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "proto/pattern.pb.h"

#include "server/blocks/cell_program.h"
#include "server/blocks/editable_map.h"
#include "server/blocks/pattern_images.h"
#include "server/blocks/stored_map.h"
#include "server/blocks/target_law.h"
#include "server/texture/texture.h"
#include "server/texture/typed_quadtree.h"
#include "shared/result/result.h"

namespace tessera {

/// Cells of the whole plane: cell (i, j) covers texels from (i, j) << cell_log2 on.
struct Grid {
    std::string name;
    int cell_log2 = 0;             ///< 0 to 12.
    std::int32_t cell_slices = 0;  ///< 0: one cell for all slices.
    std::shared_ptr<const TypedQuadtree>
        quadtree;  ///< Its leaves are the cells. Null if nothing on the grid is typed.

    std::int64_t cell_z(std::int64_t slice) const noexcept {
        if (cell_slices == 0) return 0;
        return slice >= 0 ? slice / cell_slices : -((-slice + cell_slices - 1) / cell_slices);
    }
};

/// How instances are turned and scaled (3.2, Tile Transform). An instance's side is its pattern's side times
/// scale; turned, it takes the room of its bounding square.
struct TransformPlan {
    bool overflow =
        false;  ///< Instances may hang over into cells beside theirs, drawn in reading order of cells.
    std::vector<double> turns;   ///< In turns, 0 to 1 excluded; by Look::turn. At most 256.
    std::vector<double> scales;  ///< By Look::scale. At most 64.
};

/// One texture block that reaches the output. `textures` are indices of earlier entries of Plan::textures.
struct ReferencePlan {
    Grid grid;
    std::shared_ptr<const PatternImages> patterns;
    std::shared_ptr<const CellProgram> program;
    std::shared_ptr<const TransformPlan> transform;  ///< Null: the pattern fills its cell.
};
struct PixelMapPlan {
    std::shared_ptr<const StoredMap> map;  ///< cells_log2: texels along a side that an entry covers.
    std::vector<std::size_t> textures;     ///< By the map's integer.
};
struct LayersPlan {
    std::vector<std::size_t> textures;  ///< From the ground up.
};
struct GivenPlan {
    std::shared_ptr<const Texture> texture;  ///< A constant, or a prepared photograph.
};
struct PlannedTexture {
    std::string name;
    std::variant<ReferencePlan, PixelMapPlan, LayersPlan, GivenPlan> what;
};

/// How often a block runs: the coarsest that its inputs allow.
enum class Rate : std::uint8_t { scene, step, cell, texel };

/// What `tessera check` says of one block.
struct PlanLine {
    std::string name;
    std::string_view kind;  ///< "virtual_tile_map", …
    Rate rate = Rate::scene;
    std::string note;  ///< "typed, 4096 types", "folded to 3", "dropped: does not reach the output", …
    bool dropped = false;
};

/// A pattern texture compiled: what reaches the output, constants folded.
struct Plan {
    std::vector<PlannedTexture> textures;  ///< Parts before wholes; the last is the output.
    std::vector<TargetLaw> target_laws;    ///< What TexelRegion::targets are to be made of.
    /// Parameters from which on other frames are shown, rising from 0 on; empty where no request drives any.
    std::vector<std::int32_t> parameters;
    std::vector<PlanLine> lines;    ///< Every block of the scene file, in its order.
    std::vector<EditableMap> maps;  ///< Those that reach the output.
};

/// Where a plan's files come from. Called for all blocks, since each is checked. `field` is the path of the
/// field for messages: "pattern.blocks[3] \"tiles\".pattern_set".
class BlockFiles {
  public:
    virtual ~BlockFiles() = default;
    virtual Result<PatternImages> read_patterns(const std::string& field, const proto::PatternSet& set) = 0;
    /// The same, shared with whoever asked for it before.
    virtual Result<std::shared_ptr<const PatternImages>> share_patterns(const std::string& field,
                                                                        const proto::PatternSet& set) {
        auto read = read_patterns(field, set);
        if (!read) return read.error();
        return std::make_shared<const PatternImages>(std::move(*read));
    }
    /// The entries of a block's map as edits left them, sides included; null where none changed it.
    virtual const StoredMap* painted(const std::string& block) const {
        static_cast<void>(block);
        return nullptr;
    }
    /// The map's image: codes of its first channel (8 or 16 bits). Edge, cells and place are the caller's.
    virtual Result<StoredMap> read_map(const std::string& field, const std::string& image) = 0;
    /// `block` holds content_exchange, interchange or wang.
    virtual Result<std::shared_ptr<const Texture>> read_exchange(const std::string& field,
                                                                 const proto::Block& block) = 0;
};

/// Checks names, types, ranges, files and cycles of all blocks, drops those that do not reach the output,
/// folds constants, and compiles the decisions. Errors: invalid_input; the message starts with the field's
/// path
/// ("pattern.blocks[3] \"areas\".cells: …") and names the fix. A cycle is told with its path ("a -> b -> a").
Result<Plan> compile_plan(const proto::Pattern& message, BlockFiles& files);

}  // namespace tessera
