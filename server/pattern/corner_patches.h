#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "server/blocks/cell_program.h"
#include "server/pattern/chance_bounds.h"
#include "server/pattern/look_means.h"
#include "server/pattern/patch_basis.h"

namespace tessera {

/// The expectation over the cells of a patch, as coefficients of the functions of PatchBasis: [row][column].
using PatchCoefficients = std::array<Colour, most_functions * most_functions>;

/// Patches of cells that look at the states of their four corners (transition tiles): a function of the four
/// entries around the patch, made once for each four that occur.
class CornerPatches {
  public:
    struct Patch {
        PatchCoefficients coefficients{};
        Colour mean{};  ///< Over all of its cells.
        CornerSpread spread;
        ColourRange range;  ///< Of what its cells may show.
    };

    CornerPatches(const CellProgram& program, const VaryingMap& map, const LookMeans& means,
                  std::int32_t slice, std::span<const std::int32_t> states, const Colour& base);

    /// The number of the patch of four entries, by their states' numbers: (0, 0), (1, 0), (0, 1), (1, 1).
    std::uint32_t number(const std::array<std::uint16_t, 4>& entries);
    std::size_t count() const noexcept { return entries_.size(); }
    /// Makes all patches that have a number by now.
    void make();
    const Patch& operator[](std::uint32_t number) const noexcept { return patches_[number]; }
    std::size_t memory_bytes() const noexcept {
        return patches_.size() * sizeof(Patch) + entries_.size() * sizeof entries_[0];
    }

  private:
    struct Combination {
        Colour mean{};
        Colour variance{};
        ColourRange range;
    };
    const Combination& combination(const std::array<std::uint16_t, 4>& corners);
    static CornerSpread spread_of(const std::vector<const Combination*>& shown, std::size_t kinds,
                                  bool drawn);
    Patch made(const std::array<std::uint16_t, 4>& entries);
    void measure_means(const PatchCoefficients& means, const PatchCoefficients& squares,
                       const std::vector<const Combination*>& shown, CornerSpread& spread) const;

    const CellProgram& program_;
    const LookMeans& means_;
    std::int32_t slice_;
    std::span<const std::int32_t> states_;
    Colour base_;
    PatchBasis columns_, rows_;
    std::int64_t cells_;
    PatchProbes column_probes_, row_probes_;
    std::vector<std::array<std::uint16_t, 4>> entries_;  ///< By number.
    std::vector<Patch> patches_;
    std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
    std::unordered_map<std::uint64_t, Combination> combinations_;
};

}  // namespace tessera
