#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/texture/texture.h"

namespace tessera::tests {

/// A texture that the hard cases are tried on, made in memory: the same on every machine.
struct Subject {
    std::string name;  ///< "content_exchange", "pattern_overflow", …: no blanks.
    std::shared_ptr<const Texture> texture;
    /// Of the squares that are looked at: less where a texel costs much.
    std::int32_t side = 40;
    bool has_slices = false;
    /// Whether a region gives the same bits however it is cut, at every level and accuracy. Layers, pixel
    /// maps and chance may answer a larger region less exactly, within their bounds.
    bool cut_keeps_bits = true;
};

/// Every way to make texels: constants, checkers, content exchange, interchangeable patches, corner tiles,
/// the channels of a surface, and every kind of pattern block.
std::vector<Subject> subjects();

/// The textures of them that mix, all of whose texels have this one sRGB code: what they mix is that colour.
std::vector<Subject> constant_subjects(std::uint8_t code);

}  // namespace tessera::tests
