// Animation Sequence (3.4, figure 12): "the first pattern of the sequence is considered as the pattern at
// rest".
#include <algorithm>

#include "server/blocks/compilation.h"

namespace tessera {

Result<void> compile_animation_sequence(Compilation& c, std::size_t block) {
    const proto::AnimationSequence& message = c.graph.blocks[block].message->animation_sequence();
    if (message.frames().empty())
        return c.error(block, ".frames", "is empty; give at least the pattern at rest");
    if (message.frames_size() > 65536)
        return c.error(block, ".frames",
                       "lists " + std::to_string(message.frames_size()) + "; at most 65536");
    std::vector<std::int32_t> patterns;
    std::vector<std::uint32_t> steps;
    std::int64_t total = 0;
    for (int i = 0; i < message.frames_size(); ++i) {
        const proto::AnimationSequence::Frame& frame = message.frames(i);
        const std::string field = ".frames[" + std::to_string(i) + "]";
        if (frame.pattern() < -1)
            return c.error(
                block, field + ".pattern",
                "is " + std::to_string(frame.pattern()) + "; a pattern from 0 on, or -1 for blank");
        if (frame.has_steps() && frame.steps() == 0)
            return c.error(block, field + ".steps", "is 0; at least 1, or leave the frame out");
        steps.push_back(frame.has_steps() ? frame.steps() : 1);
        total += steps.back();
        patterns.push_back(frame.pattern());
    }
    const auto [least, most] = std::minmax_element(patterns.begin(), patterns.end());
    const std::int32_t range[] = {*least, *most};
    c.notes[block] = std::to_string(patterns.size()) + " frames, " + std::to_string(total) + " steps";
    c.blocks[block].frames = std::make_shared<const FrameLine>(
        FrameLine{std::move(patterns), TimeLine{steps}, range[0], range[1]});
    return {};
}

}  // namespace tessera
