#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/texture/texture.h"
#include "shared/page/accuracy.h"

namespace tessera::tests {

/// A texture that the hard cases are tried on, made in memory: the same on every machine.
struct Subject {
    std::string name;  ///< "content_exchange", "pattern_overflow", …: no blanks.
    std::shared_ptr<const Texture> texture;
    /// Of the squares that are looked at: less where a texel costs much.
    std::int32_t side = 40;
    bool has_slices = false;
    /// It puts what is see-through on a ground: premultiplied colours are kept in 65535ths, and are rounded.
    bool composites = false;

    /// exact, high and fast in turn by level; where descending makes exact texels dear, not exact.
    Accuracy accuracy_at(std::uint8_t level) const {
        const Accuracy asked = accuracies[level % accuracies.size()];
        return side < 20 && level > 3 && asked == Accuracy::exact ? Accuracy::fast : asked;
    }
};

/// Every way to make texels: constants, checkers, content exchange, interchangeable patches, corner tiles,
/// the channels of a surface, and every kind of pattern block.
std::vector<Subject> subjects();

/// The textures of them that mix, all of whose texels have this one sRGB code: what they mix is that colour.
std::vector<Subject> constant_subjects(std::uint8_t code);

}  // namespace tessera::tests
