#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proto/pattern.pb.h"

#include "server/blocks/animation_op.h"
#include "server/blocks/cell_op.h"
#include "server/blocks/cell_program.h"
#include "server/blocks/driven_op.h"
#include "server/blocks/graph.h"
#include "server/blocks/stored_map.h"

namespace tessera {

using Generator = proto::Draw::Generator;

/// What a random block draws. Draws of one `key` come from the same bits.
struct CellDraw {
    Generator generator = proto::Draw::automatic;
    std::uint64_t key = 0;    ///< Of its stream and grid.
    std::uint32_t count = 1;  ///< Draws 0 to count − 1.
    std::uint32_t types = 0;  ///< Of the grid's quadtree, once it is known to be typed.
    std::uint64_t base = 0;   ///< stream_base(), once it is known to be independent.
};

/// What a map on the grid gives, dithered or not.
struct CellMap {
    std::shared_ptr<const StoredMap> map;
    VaryingMap::Sampling sampling = VaryingMap::Sampling::nearest;
    bool nested = false;
    std::uint64_t key = 0;  ///< Of the stream that dithers; 0 if none does.
};

/// An integer or a number for each cell, while it is compiled. Inputs are earlier nodes.
struct CellNode {
    std::size_t block = no_block;  ///< Whose it is; none for a constant in a field.
    std::shared_ptr<const CellOp> op;
    std::vector<std::size_t> inputs;
    bool corners = false;  ///< The first input is read at (0, 0), (1, 0), (0, 1), (1, 1).
    bool number = false;   ///< In steps of 2^-16.
    bool steps = false;    ///< Changes with the step.
    bool shown = false;    ///< A texture's looks depend on it: known once all blocks are.
    std::int32_t least = 0, most = 0;
    std::size_t grid = no_block;  ///< The block of its grid; none for a constant.
    int reach = 0;                ///< How many cells further its inputs are read.
    std::optional<CellDraw> draw;
    std::optional<CellMap> map;
    std::shared_ptr<const AnimationOp> animation;  ///< The op, where it is one.
    std::shared_ptr<const DrivenOp> driven;        ///< The same.

    bool constant() const noexcept { return least == most && !steps; }
};

}  // namespace tessera
