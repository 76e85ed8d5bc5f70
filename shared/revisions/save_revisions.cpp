#include <algorithm>
#include <bit>
#include <cstring>

#include "shared/revisions/page_revisions.h"
#include "shared/revisions/revision_tree.h"

namespace tessera {
namespace {

using detail::Cell;
using detail::DirtyRect;
using detail::RevisionNode;
using detail::RevisionNodePtr;

constexpr std::string_view magic = "tsrprv01";

void put(std::string& bytes, std::uint64_t number, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) bytes += static_cast<char>(number >> (8 * i));
}

void put_node(std::string& bytes, const RevisionNode& node) {
    unsigned mask = 0;
    for (unsigned i = 0; i < 4; ++i) mask |= node.children[i] ? 1u << i : 0u;
    put(bytes, node.cell.log2, 1);
    put(bytes, mask | static_cast<unsigned>(node.rects.rects().size()) << 4, 1);
    put(bytes, node.cell.x, 5);
    put(bytes, node.cell.y, 5);
    for (const DirtyRect& rect : node.rects.rects()) {
        for (const std::uint32_t place : {rect.x0, rect.y0, rect.x1, rect.y1}) put(bytes, place, 4);
        put(bytes, rect.revision, 8);
    }
    for (const RevisionNodePtr& child : node.children) {
        if (child) put_node(bytes, *child);
    }
}

/// Reads from the front; `bad` once there was nothing, or nonsense.
struct Reader {
    std::string_view bytes;
    bool bad = false;

    std::uint64_t take(std::size_t count) {
        if (bytes.size() < count) bad = true;
        if (bad) return 0;
        std::uint64_t number = 0;
        for (std::size_t i = 0; i < count; ++i)
            number |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
        bytes.remove_prefix(count);
        return number;
    }
};

/// A node of `within`, and all under it.
RevisionNodePtr take_node(Reader& reader, const Cell& within) {
    RevisionNodePtr node{new RevisionNode};
    node->cell.log2 = static_cast<std::uint8_t>(reader.take(1));
    const std::uint64_t counts = reader.take(1);
    node->cell.x = reader.take(5);
    node->cell.y = reader.take(5);
    const Cell& cell = node->cell;
    const std::uint64_t rects = counts >> 4, mask = counts & 15;
    if (reader.bad || !within.contains(cell) || cell.log2 < detail::smallest_cell_log2 ||
        rects > detail::DirtyRects::max_rects || (rects == 0 && std::popcount(mask) < 2) ||
        ((cell.x | cell.y) & ((std::uint64_t{1} << cell.log2) - 1)) != 0) {
        reader.bad = true;
        return node;
    }
    const std::uint64_t last = (std::uint64_t{1} << std::min<int>(cell.log2, 32)) - 1;
    for (std::uint64_t i = 0; i < rects; ++i) {
        DirtyRect rect;
        for (std::uint32_t* place : {&rect.x0, &rect.y0, &rect.x1, &rect.y1})
            *place = static_cast<std::uint32_t>(reader.take(4));
        rect.revision = reader.take(8);
        if (rect.x0 > rect.x1 || rect.y0 > rect.y1 || rect.x1 > last || rect.y1 > last) reader.bad = true;
        node->rects.restore(rect);
    }
    for (std::size_t i = 0; i < 4 && !reader.bad; ++i) {
        if ((mask >> i & 1) == 0) continue;
        const auto log2 = static_cast<std::uint8_t>(cell.log2 - 1);
        const std::uint64_t side = std::uint64_t{1} << log2;
        node->children[i] = take_node(reader, {cell.x + (i % 2) * side, cell.y + (i / 2) * side, log2});
    }
    node->sum_up();
    return node;
}

}  // namespace

std::string PageRevisions::save() const {
    std::string bytes{magic};
    put(bytes, hand_x_, 5);
    put(bytes, hand_y_, 5);
    put(bytes, joined_log2_, 1);
    put(bytes, passed_log2_, 1);
    put(bytes, root_ ? 1 : 0, 1);
    if (root_) put_node(bytes, *root_);
    return bytes;
}

Result<PageRevisions> PageRevisions::load(std::string_view bytes, std::size_t memory_bytes) {
    const Error nonsense{ErrorCode::invalid_input, "page revisions: are not what this program saved"};
    if (!bytes.starts_with(magic)) return nonsense;
    Reader reader{bytes.substr(magic.size())};
    PageRevisions revisions{memory_bytes};
    revisions.hand_x_ = reader.take(5);
    revisions.hand_y_ = reader.take(5);
    revisions.joined_log2_ = static_cast<std::uint8_t>(reader.take(1));
    revisions.passed_log2_ = static_cast<std::uint8_t>(reader.take(1));
    const std::uint64_t rooted = reader.take(1);
    if (revisions.joined_log2_ < 8 || rooted > 1) return nonsense;
    if (rooted != 0) revisions.root_ = take_node(reader, {0, 0, detail::plane_log2});
    if (reader.bad || !reader.bytes.empty()) return nonsense;
    return revisions;
}

}  // namespace tessera
