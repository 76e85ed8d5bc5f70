#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/pattern/joint_types.h"

namespace tessera {

inline bool is_typed(const ReferencePlan& plan) { return plan.program->basis() == CellProgram::Basis::typed; }

/// Types of the reference's own cells inside a common cell, row after row.
void cell_types(const ReferencePlan& plan, int cell_log2, std::uint16_t type,
                std::vector<std::uint16_t>& types);

/// Draws a part's share of common cells, at level 0.
class PartCells {
  public:
    virtual ~PartCells() = default;
    /// `out` is of a common cell's size.
    virtual void draw(std::uint16_t type, std::int32_t slice, LinearImage& out) const = 0;
    virtual std::size_t memory_bytes() const noexcept = 0;
    virtual std::string description() const = 0;
};

/// `grid`: of the common cells. What `part` points to lives as long.
std::unique_ptr<const PartCells> make_part_cells(const JointPart& part, const Grid& grid);

}  // namespace tessera
