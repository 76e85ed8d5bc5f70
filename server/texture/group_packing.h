#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/packed_ground.h"
#include "server/texture/shapes.h"
#include "server/texture/unit_choice.h"

namespace tessera {

/// Shapes that are shown together (ExchangeAsset::Patch::group).
struct ShownGroup {
    std::int32_t x = 0, y = 0;  ///< Where the asset has its first texel, in texels of a unit.
    PackedPiece piece;          ///< All of them.
    std::vector<Shown> shapes;  ///< There.
};

/// The asset's groups, without those of which a patch was dropped.
std::vector<ShownGroup> groups_of(const ExchangeAsset& asset, const Shapes& shapes);

/// Which groups lie together in a unit.
class GroupPacking {
  public:
    struct Place {
        std::size_t group = 0;
        std::int32_t x = 0, y = 0;            ///< Of the group's first texel in the unit.
        std::int32_t tile_x = 0, tile_y = 0;  ///< How far that is from where the asset has it.
    };

    /// `bare`: what is taken where nothing lies yet, of so many rows and at least as many columns; every
    /// group that begins in a unit, or a tile to the right of one, ends inside it.
    GroupPacking(const std::vector<ShownGroup>& groups, std::int32_t tile_side, const PackedGround& bare,
                 std::int32_t ground_side);

    /// Groups that do not overlap and cover about as many texels as can be had; those before others that were
    /// shown less often. None of those that are `spent`: empty, or one for each group.
    std::vector<Place> chosen(std::uint64_t seed, std::uint32_t type,
                              const std::vector<bool>& spent = {}) const;
    /// A unit shows these.
    void add(const std::vector<Place>& places);

    /// What units of each class show (UnitTree), as many classes being kept apart as there are groups for. No
    /// two classes that are kept apart share a group; others share few, each part of a unit for itself.
    struct Classes {
        int apart = 0;  ///< 0: of no classes.
        std::vector<std::vector<Place>> shown;
    };
    Classes classes(std::uint64_t seed);

  private:
    struct Search;
    std::int64_t covered(const std::vector<Place>& places) const;
    std::vector<std::vector<Place>> apart(std::uint64_t seed, std::uint32_t number, std::size_t most) const;
    void look(Search& search, const std::vector<std::size_t>& left, std::uint64_t worth) const;

    std::vector<Place> places_;
    std::vector<std::int32_t> texels_;  ///< Of each place's group.
    std::vector<std::int32_t> group_texels_;
    std::vector<bool> meets_;               ///< Of pairs of places: whether they overlap.
    std::vector<std::uint64_t> how_often_;  ///< Each group was shown.
};

}  // namespace tessera
