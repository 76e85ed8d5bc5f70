// Reference Texture (3.2), its storage: "the user provides a single texture where he packed the T patterns".
#include <bit>

#include "server/blocks/compilation.h"

namespace tessera {

Result<void> compile_pattern_set(Compilation& c, std::size_t block) {
    const proto::PatternSet& message = c.graph.blocks[block].message->pattern_set();
    if (message.image().empty() == message.files().empty())
        return c.error(block, ".pattern_set",
                       message.image().empty() ? "has neither image nor files; give one of them"
                                               : "has both image and files; give one of them");
    if (message.side_texels() > 1024 ||
        (message.side_texels() != 0 && !std::has_single_bit(message.side_texels())))
        return c.error(block, ".pattern_set.side_texels",
                       "is " + std::to_string(message.side_texels()) + "; a power of two from 1 to 1024");
    if (message.slices() > 1024)
        return c.error(block, ".pattern_set.slices",
                       "is " + std::to_string(message.slices()) + "; at most 1024");
    const std::string field = c.graph.blocks[block].path + ".pattern_set";
    auto read = c.files.share_patterns(field, message);
    if (!read) return read.error();
    const std::shared_ptr<const PatternImages> images = std::move(*read);
    if (images->side < 1 || images->side > 1024 ||
        !std::has_single_bit(static_cast<unsigned>(images->side)) || images->count < 1 || images->slices < 1)
        return field_error(field, "gives " + std::to_string(images->count) + " patterns of " +
                                      std::to_string(images->side) +
                                      " texels; at least one, of a side that is a power of two up to 1024");
    c.notes[block] = std::to_string(images->count) + " patterns of " + std::to_string(images->side) + "²" +
                     (images->slices > 1 ? " × " + std::to_string(images->slices) : std::string{}) +
                     " texels";
    c.blocks[block].patterns = images;
    return {};
}

}  // namespace tessera
