#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/unit_choice.h"

namespace tessera {

/// `choice: kolar`: which patches a tile shows as the paper has it (section 4.2), for comparison. Tiles are A
/// or B by the parity of their coordinates; a formula of sines draws active patches of the tile's set
/// (equation 1), and what overlaps is thinned out (algorithm 2).
///
/// Sines are polynomials of +, −, × and ÷, so that every machine draws the same; the formula itself squares
/// the coordinates, and loses its last random bit in a double where tiles are some 2^26 from the origin:
/// every patch is active then
/// (tests/unit/server/texture/kolar_choice_test.cpp). `typed` has no such end.
class KolarChoice {
  public:
    KolarChoice(const ExchangeAsset& asset, const Shapes& shapes, std::uint64_t seed);

    std::vector<Shown> shown_by(std::int64_t tile_x, std::int64_t tile_y) const;

  private:
    struct Member {
        Shown shown;
        double alpha = 0, beta = 0;  ///< The formula's parameters of this patch, 0 to 1.
    };
    struct Set {
        std::vector<Member> members;
        std::vector<std::vector<bool>> overlaps;  ///< The paper's binary matrix.
    };
    Set sets_[2];
};

/// Equation (1) without its threshold: 0 to 1.
double kolar_draw(double alpha, double beta, std::int64_t a, std::int64_t b);

}  // namespace tessera
