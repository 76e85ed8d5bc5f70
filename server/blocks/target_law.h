#pragma once

#include <cstdint>
#include <memory>

namespace tessera {

struct FrameLine;

/// How an animation looks at targets; what TargetDistance is made of.
struct TargetLaw {
    std::shared_ptr<const FrameLine> frames;
    std::int64_t near = 0, far = 0;  ///< Texels
};

}  // namespace tessera
