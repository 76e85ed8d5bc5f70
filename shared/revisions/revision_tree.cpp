#include "shared/revisions/revision_tree.h"

#include <algorithm>
#include <bit>

namespace tessera::detail {
namespace {

/// The node, of which nobody else has a copy.
RevisionNode& own(RevisionNodePtr& link) {
    if (link->references.load(std::memory_order_acquire) != 1) {
        const RevisionNodePtr copy{new RevisionNode};
        copy->cell = link->cell;
        copy->weight = link->weight;
        copy->newest = link->newest;
        copy->rects = link->rects;
        copy->children = link->children;
        link = copy;
    }
    return *link;
}

RevisionNodePtr make_node(const Cell& cell) {
    RevisionNodePtr node{new RevisionNode};
    node->cell = cell;
    return node;
}

/// A node that holds nothing itself is replaced by its only child, or by nothing.
void straighten(RevisionNodePtr& link) {
    if (!link->rects.empty()) return;
    RevisionNodePtr only;
    for (const RevisionNodePtr& child : link->children) {
        if (child && only) return;
        if (child) only = child;
    }
    link = only;
}

PlaceBox common(const PlaceBox& a, const PlaceBox& b) noexcept {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

/// Takes away what lies under `box`, all of which `revision` touched.
void cover(RevisionNodePtr& link, const PlaceBox& box, Revision revision) {
    const PlaceBox all = link->cell.box();
    if (!box.meets(all)) return;
    if (box.contains(all) && link->newest <= revision) {
        link.reset();
        return;
    }
    RevisionNode& node = own(link);
    // In larger cells a rectangle is more than its box
    if (node.cell.log2 <= 32) node.rects.remove_under(rect_in(node.cell, common(box, all), revision));
    for (RevisionNodePtr& child : node.children) {
        if (child) cover(child, box, revision);
    }
    node.sum_up();
    straighten(link);
}

void relieve(RevisionNode& node, int& pushes);

/// insert() for one cell, which holds `box`.
void insert_in(RevisionNodePtr& link, const Cell& cell, const PlaceBox& box, Revision revision, int& pushes) {
    if (!link) {
        link = make_node(cell);
    } else if (!link->cell.contains(cell)) {
        if (cell.contains(link->cell)) {
            // The cell comes in between
            RevisionNodePtr node = make_node(cell);
            const std::size_t quarter = cell.quarter(link->cell.x, link->cell.y);
            node->children[quarter] = std::move(link);
            link = std::move(node);
        } else {
            // The smallest cell around both
            const auto bits =
                static_cast<std::uint8_t>(std::bit_width((cell.x ^ link->cell.x) | (cell.y ^ link->cell.y)));
            const std::uint64_t mask = ~((std::uint64_t{1} << bits) - 1);
            RevisionNodePtr node = make_node({cell.x & mask, cell.y & mask, bits});
            const std::size_t quarter = node->cell.quarter(link->cell.x, link->cell.y);
            node->children[quarter] = std::move(link);
            link = std::move(node);
        }
    }
    RevisionNode& node = own(link);
    if (node.cell == cell) {
        for (RevisionNodePtr& child : node.children) {
            if (child) cover(child, box, revision);
        }
        node.rects.add(rect_in(cell, box, revision));
        relieve(node, pushes);
    } else {
        insert_in(node.children[node.cell.quarter(cell.x, cell.y)], cell, box, revision, pushes);
    }
    node.sum_up();
}

/// Makes four rectangles of more: the oldest goes to smaller cells, while there is any use and leave.
void relieve(RevisionNode& node, int& pushes) {
    while (node.rects.crowded()) {
        if (node.cell.log2 <= smallest_cell_log2 || --pushes < 0) {
            node.rects.join_two();
            continue;
        }
        const DirtyRect oldest = node.rects.take_oldest();
        const PlaceBox box = box_of(node.cell, oldest);
        const auto log2 = static_cast<std::uint8_t>(node.cell.log2 - 1);
        for (std::size_t i = 0; i < 4; ++i) {
            const Cell quarter{node.cell.x + (i % 2 << log2), node.cell.y + (i / 2 << log2), log2};
            if (!box.meets(quarter.box())) continue;
            DirtyRect left = rect_in(node.cell, common(box, quarter.box()), oldest.revision);
            if (node.cell.log2 <= 32 && !node.rects.trim(left)) continue;
            insert(node.children[i], quarter, common(box_of(node.cell, left), quarter.box()), oldest.revision,
                   pushes);
        }
    }
}

/// Whether place a comes before place b: y's bits weigh more than x's.
bool z_less(std::uint64_t ax, std::uint64_t ay, std::uint64_t bx, std::uint64_t by) noexcept {
    const std::uint64_t dx = ax ^ bx, dy = ay ^ by;
    const bool x_decides = dy < dx && dy < (dx ^ dy);
    return x_decides ? ax < bx : ay < by;
}

}  // namespace

void intrusive_ptr_add_ref(const RevisionNode* node) noexcept {
    node->references.fetch_add(1, std::memory_order_relaxed);
}

void intrusive_ptr_release(const RevisionNode* node) noexcept {
    if (node->references.fetch_sub(1, std::memory_order_acq_rel) == 1) delete node;
}

bool RevisionNode::leaf() const noexcept {
    return std::none_of(children.begin(), children.end(), [](const RevisionNodePtr& child) { return child; });
}

void RevisionNode::sum_up() noexcept {
    constexpr std::uint64_t allocation = 16;
    weight = sizeof(RevisionNode) + allocation;
    newest = 0;
    if (!rects.empty()) weight += rects.rects().size() * sizeof(DirtyRect) + allocation;
    for (const DirtyRect& rect : rects.rects()) newest = std::max(newest, rect.revision);
    for (const RevisionNodePtr& child : children) {
        if (!child) continue;
        weight += child->weight;
        newest = std::max(newest, child->newest);
    }
}

DirtyRect rect_in(const Cell& cell, const PlaceBox& box, Revision revision) noexcept {
    const int shift = std::max(0, cell.log2 - 32);
    const auto unit = [shift](std::uint64_t distance) {
        return static_cast<std::uint32_t>(distance >> shift);
    };
    return {unit(box.x0 - cell.x), unit(box.y0 - cell.y), unit(box.x1 - cell.x), unit(box.y1 - cell.y),
            revision};
}

PlaceBox box_of(const Cell& cell, const DirtyRect& rect) noexcept {
    const int shift = std::max(0, cell.log2 - 32);
    const std::uint64_t last = (std::uint64_t{1} << shift) - 1;
    return {cell.x + (std::uint64_t{rect.x0} << shift), cell.y + (std::uint64_t{rect.y0} << shift),
            cell.x + (std::uint64_t{rect.x1} << shift) + last,
            cell.y + (std::uint64_t{rect.y1} << shift) + last};
}

void insert(RevisionNodePtr& link, const Cell& within, const PlaceBox& box, Revision revision, int& pushes) {
    const std::uint64_t side = std::max(box.x1 - box.x0, box.y1 - box.y0);
    const int wanted = std::max(static_cast<int>(std::bit_width(side)) + 1, int{page_cell_log2});
    const auto log2 = static_cast<std::uint8_t>(std::min(wanted, int{within.log2}));
    const auto corner = [log2](std::uint64_t place) { return place >> log2 << log2; };
    for (std::uint64_t y = corner(box.y0); y <= box.y1; y += std::uint64_t{1} << log2) {
        for (std::uint64_t x = corner(box.x0); x <= box.x1; x += std::uint64_t{1} << log2) {
            const Cell cell{x, y, log2};
            insert_in(link, cell, common(box, cell.box()), revision, pushes);
        }
    }
}

void find_newest(const RevisionNode& node, const PlaceBox& box, Revision& best, int& visits) noexcept {
    if (node.newest <= best || !box.meets(node.cell.box())) return;
    if (--visits < 0 || box.contains(node.cell.box())) {
        best = node.newest;
        return;
    }
    for (const DirtyRect& rect : node.rects.rects()) {
        if (rect.revision > best && box.meets(box_of(node.cell, rect))) best = rect.revision;
    }
    // The newest first: the others are then mostly passed by
    std::array<const RevisionNode*, 4> order{};
    std::size_t count = 0;
    for (const RevisionNodePtr& child : node.children) {
        if (!child) continue;
        std::size_t at = count++;
        for (; at > 0 && order[at - 1]->newest < child->newest; --at) order[at] = order[at - 1];
        order[at] = child.get();
    }
    for (std::size_t i = 0; i < count; ++i) find_newest(*order[i], box, best, visits);
}

std::optional<Cell> next_to_join(const RevisionNode& node, JoiningHand& hand) {
    const PlaceBox all = node.cell.box();
    if (node.leaf() || !z_less(hand.x, hand.y, all.x1, all.y1) || --hand.visits < 0) return std::nullopt;
    bool of_leaves = true;
    for (const RevisionNodePtr& child : node.children) {
        if (!child || child->leaf()) continue;
        of_leaves = false;
        if (const auto found = next_to_join(*child, hand)) return found;
        if (hand.visits < 0) return std::nullopt;
    }
    hand.x = all.x1;
    hand.y = all.y1;
    if (!of_leaves) return std::nullopt;
    if (node.cell.log2 <= hand.joined_log2) return node.cell;
    hand.passed_log2 = std::min(hand.passed_log2, node.cell.log2);
    return std::nullopt;
}

void join(RevisionNodePtr& link, const Cell& cell) {
    RevisionNode& node = own(link);
    if (node.cell == cell) {
        for (RevisionNodePtr& child : node.children) {
            if (!child) continue;
            for (const DirtyRect& rect : child->rects.rects())
                node.rects.add(rect_in(cell, box_of(child->cell, rect), rect.revision));
            child.reset();
        }
        while (node.rects.crowded()) node.rects.join_two();
    } else {
        join(node.children[node.cell.quarter(cell.x, cell.y)], cell);
    }
    node.sum_up();
}

}  // namespace tessera::detail
