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
    FrameLine line;
    std::int64_t end = 0;
    for (int i = 0; i < message.frames_size(); ++i) {
        const proto::AnimationSequence::Frame& frame = message.frames(i);
        const std::string field = ".frames[" + std::to_string(i) + "]";
        if (frame.pattern() < -1)
            return c.error(
                block, field + ".pattern",
                "is " + std::to_string(frame.pattern()) + "; a pattern from 0 on, or -1 for blank");
        if (frame.has_steps() && frame.steps() == 0)
            return c.error(block, field + ".steps", "is 0; at least 1, or leave the frame out");
        end += frame.has_steps() ? frame.steps() : 1;
        line.patterns.push_back(frame.pattern());
        line.ends.push_back(end);
    }
    const auto [least, most] = std::minmax_element(line.patterns.begin(), line.patterns.end());
    line.least = *least;
    line.most = *most;
    c.notes[block] = std::to_string(line.patterns.size()) + " frames, " + std::to_string(end) + " steps";
    c.blocks[block].frames = std::make_shared<const FrameLine>(std::move(line));
    return {};
}

}  // namespace tessera
