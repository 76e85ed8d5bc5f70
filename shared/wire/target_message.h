#pragma once

#include <cstdint>
#include <vector>

#include "shared/motion/targets.h"
#include "shared/result/result.h"

namespace google::protobuf {
template <class T>
class RepeatedPtrField;
}

namespace tessera {

namespace proto {
class Target;
}

using TargetId = std::uint64_t;

inline constexpr int max_targets = 256;
inline constexpr int max_target_legs = 1024;

/// Checked here. Error: invalid_input; the message starts with the field ("legs[3].steps: …").
Result<MovingTarget> target_of(const proto::Target& message);

/// All targets of a scene: their ids differ, and those that move come round together. Error: invalid_input;
/// the message starts with the target's index ("[3].id: …").
Result<std::vector<MovingTarget>> targets_of(
    const google::protobuf::RepeatedPtrField<proto::Target>& messages);

}  // namespace tessera
