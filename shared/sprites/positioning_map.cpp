#include "shared/sprites/positioning_map.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <string>
#include <utility>

namespace tessera {

namespace detail {

/// A cell of the grid of 2^height texels: its own sprites, and the finer cells inside that hold any. Nodes
/// with neither sprites nor two children are left out.
struct PositioningNode {
    using Children = std::array<PositioningNodePtr, 4>;

    mutable std::atomic<std::uint32_t> references{0};
    std::uint8_t height = 0;
    std::uint16_t count = 0;
    std::int64_t x = 0, y = 0;
    std::unique_ptr<Children> children;
    std::unique_ptr<Sprite[]> sprites;

    PositioningNode(std::uint8_t h, std::int64_t cell_x, std::int64_t cell_y)
        : height{h}, x{cell_x}, y{cell_y} {}
    PositioningNode(const PositioningNode& other)
        : height{other.height}, count{other.count}, x{other.x}, y{other.y} {
        if (other.children) children = std::make_unique<Children>(*other.children);
        if (count > 0) {
            sprites = std::make_unique<Sprite[]>(count);
            std::copy_n(other.sprites.get(), count, sprites.get());
        }
    }
    PositioningNode& operator=(const PositioningNode&) = delete;

    void add(const Sprite& sprite) {
        auto more = std::make_unique<Sprite[]>(count + std::size_t{1});
        std::move(sprites.get(), sprites.get() + count, more.get());
        more[count++] = sprite;
        sprites = std::move(more);
    }
    Sprite* find(const Sprite& sprite) const {
        return std::find_if(sprites.get(), sprites.get() + count,
                            [&](const Sprite& s) { return same_sprite(s, sprite); });
    }
    bool holds(const Sprite& sprite) const { return find(sprite) != sprites.get() + count; }
    /// Of one that it holds.
    void take(const Sprite& sprite) {
        Sprite *const end = sprites.get() + count, *const found = find(sprite);
        auto fewer = count > 1 ? std::make_unique<Sprite[]>(count - std::size_t{1}) : nullptr;
        std::move(found + 1, end, std::move(sprites.get(), found, fewer.get()));
        sprites = std::move(fewer);
        --count;
    }
    int child_count() const noexcept {
        return children ? static_cast<int>(std::count_if(children->begin(), children->end(),
                                                         [](const auto& child) { return child != nullptr; }))
                        : 0;
    }
    /// Where the node's sprites may reach: from their own cells into the next.
    TexelBox reach() const noexcept {
        return {x << height, y << height, (x + 2) << height, (y + 2) << height};
    }
};

void intrusive_ptr_add_ref(const PositioningNode* node) noexcept {
    node->references.fetch_add(1, std::memory_order_relaxed);
}

void intrusive_ptr_release(const PositioningNode* node) noexcept {
    if (node->references.fetch_sub(1, std::memory_order_acq_rel) == 1) delete node;
}

}  // namespace detail

namespace {

using Node = detail::PositioningNode;
using NodePtr = detail::PositioningNodePtr;

/// A cell of one of the grids.
struct Cell {
    std::uint8_t height = 0;
    std::int64_t x = 0, y = 0;

    bool operator==(const Cell&) const = default;
    bool holds(const Cell& finer) const noexcept {
        const int up = height - finer.height;
        return up >= 0 && finer.x >> up == x && finer.y >> up == y;
    }
    Cell parent() const noexcept { return {static_cast<std::uint8_t>(height + 1), x >> 1, y >> 1}; }
    /// Which quarter of a cell of `of_height`, above this one, it lies in.
    std::size_t quarter(std::uint8_t of_height) const noexcept {
        const int up = of_height - 1 - height;
        return static_cast<std::size_t>((x >> up & 1) | (y >> up & 1) << 1);
    }
};

Cell cell_of(const Node& node) noexcept { return {node.height, node.x, node.y}; }

Cell home_of(const TexelBox& box) noexcept {
    const std::int64_t side = std::max(box.x1 - box.x0, box.y1 - box.y0);
    std::uint8_t height = 0;
    while (std::int64_t{1} << height < side) ++height;
    return {height, box.x0 >> height, box.y0 >> height};
}

std::size_t quadrant(const Cell& cell) noexcept {
    return static_cast<std::size_t>((cell.x < 0 ? 1 : 0) | (cell.y < 0 ? 2 : 0));
}

/// The node behind `slot`, copied if other maps see it too.
Node& own(NodePtr& slot) {
    if (slot->references.load(std::memory_order_acquire) > 1) slot.reset(new Node{*slot});
    return *slot;
}

Node::Children& children_of(Node& node) {
    if (!node.children) node.children = std::make_unique<Node::Children>();
    return *node.children;
}

void insert(NodePtr& root, const Cell& home, const Sprite& sprite) {
    NodePtr* slot = &root;
    while (*slot && cell_of(**slot) != home && cell_of(**slot).holds(home)) {
        Node& node = own(*slot);
        slot = &children_of(node)[home.quarter(node.height)];
    }
    if (*slot && cell_of(**slot) != home) {
        // Something else hangs here: both go below the finest cell that holds both
        Cell common = home;
        const Cell there = cell_of(**slot);
        while (!common.holds(there)) common = common.parent();
        NodePtr fork{new Node{common.height, common.x, common.y}};
        children_of(*fork)[there.quarter(common.height)] = std::move(*slot);
        *slot = std::move(fork);
        if (common != home) slot = &(*(*slot)->children)[home.quarter(common.height)];
    }
    if (!*slot) slot->reset(new Node{home.height, home.x, home.y});
    own(*slot).add(sprite);
}

/// Leaves out what no longer holds anything by itself.
void tidy(NodePtr& slot) {
    if (slot->count > 0) return;
    const int children = slot->child_count();
    if (children == 0) slot.reset();
    if (children != 1) return;
    NodePtr only = *std::find_if(slot->children->begin(), slot->children->end(),
                                 [](const NodePtr& child) { return child != nullptr; });
    slot = std::move(only);
}

/// Of a sprite that is below `slot`.
void erase(NodePtr& slot, const Cell& home, const Sprite& sprite) {
    Node& node = own(slot);
    if (cell_of(node) == home)
        node.take(sprite);
    else
        erase((*node.children)[home.quarter(node.height)], home, sprite);
    tidy(slot);
}

/// Calls `visit` for each sprite whose box meets, until it says false.
template <class Visit>
bool visit_meeting(const Node& node, const TexelBox& box, const Visit& visit) {
    if (!node.reach().meets(box)) return true;
    for (std::size_t i = 0; i < node.count; ++i)
        if (box_of(node.sprites[i]).meets(box) && !visit(node.sprites[i])) return false;
    if (node.children)
        for (const NodePtr& child : *node.children)
            if (child && !visit_meeting(*child, box, visit)) return false;
    return true;
}

template <class Visit>
void visit_meeting(const std::array<NodePtr, 4>& roots, const TexelBox& box, const Visit& visit) {
    for (const NodePtr& root : roots)
        if (root && !visit_meeting(*root, box, visit)) return;
}

/// Sprites of the grid of `height` that meet `box`: finer nodes, and what is below them, hold none.
std::size_t count_on_grid(const Node& node, std::uint8_t height, const TexelBox& box) {
    if (node.height < height || !node.reach().meets(box)) return 0;
    if (node.height == height)
        return static_cast<std::size_t>(
            std::count_if(node.sprites.get(), node.sprites.get() + node.count,
                          [&](const Sprite& sprite) { return box_of(sprite).meets(box); }));
    std::size_t met = 0;
    if (node.children)
        for (const NodePtr& child : *node.children)
            if (child) met += count_on_grid(*child, height, box);
    return met;
}

const Node* find(const NodePtr& root, const Cell& home) noexcept {
    const Node* node = root.get();
    while (node && cell_of(*node) != home)
        node = node->children && cell_of(*node).holds(home)
                   ? (*node->children)[home.quarter(node->height)].get()
                   : nullptr;
    return node;
}

std::size_t bytes_of(const Node& node) noexcept {
    std::size_t bytes = sizeof(Node) + node.count * sizeof(Sprite);
    for (std::size_t i = 0; i < node.count; ++i)
        if (node.sprites[i].life) bytes += sizeof(SpriteLife);
    if (!node.children) return bytes;
    bytes += sizeof(Node::Children);
    for (const NodePtr& child : *node.children)
        if (child) bytes += bytes_of(*child);
    return bytes;
}

}  // namespace

Result<void> PositioningMap::check_room(const Sprite& sprite) const {
    if (auto checked = check_sprite(sprite); checked.has_error()) return checked;
    const TexelBox box = box_of(sprite);
    const Cell home = home_of(box);
    for (std::int64_t y = box.y0 >> home.height; y <= (box.y1 - 1) >> home.height; ++y)
        for (std::int64_t x = box.x0 >> home.height; x <= (box.x1 - 1) >> home.height; ++x) {
            const TexelBox cell{x << home.height, y << home.height, (x + 1) << home.height,
                                (y + 1) << home.height};
            std::size_t met = 0;
            for (const NodePtr& root : roots_)
                if (root) met += count_on_grid(*root, home.height, cell);
            if (met >= overlap_layers_)
                return Error{ErrorCode::invalid_input,
                             "sprite " + std::to_string(sprite.id) + ": " + std::to_string(met) +
                                 " sprites already meet the cell of " +
                                 std::to_string(std::int64_t{1} << home.height) + " texels at " +
                                 std::to_string(cell.x0) + ", " + std::to_string(cell.y0) +
                                 ", as many as there are overlap layers; move it or remove one"};
        }
    return {};
}

Result<void> PositioningMap::place(const Sprite& sprite) {
    if (auto room = check_room(sprite); room.has_error()) return room;
    const Cell home = home_of(box_of(sprite));
    insert(roots_[quadrant(home)], home, sprite);
    ++size_;
    if (sprite.life) ++living_;
    return {};
}

bool PositioningMap::remove(const Sprite& sprite) {
    if (check_sprite(sprite).has_error()) return false;
    const Cell home = home_of(box_of(sprite));
    NodePtr& root = roots_[quadrant(home)];
    // Looked for first, so that a miss copies nothing
    const Node* node = find(root, home);
    if (!node || !node->holds(sprite)) return false;
    erase(root, home, sprite);
    --size_;
    if (sprite.life) --living_;
    return true;
}

std::vector<Sprite> PositioningMap::meeting(const TexelBox& box) const {
    std::vector<Sprite> met;
    visit_meeting(roots_, box, [&](const Sprite& sprite) {
        met.push_back(sprite);
        return true;
    });
    std::sort(met.begin(), met.end(), drawn_before);
    return met;
}

std::vector<Sprite> PositioningMap::meeting_at(const TexelBox& box, Step step) const {
    std::vector<Sprite> met = meeting(box);
    std::erase_if(met, [&](const Sprite& sprite) { return !box_at(sprite, step).meets(box); });
    return met;
}

std::vector<Sprite> PositioningMap::some_meeting(const TexelBox& box, std::size_t most) const {
    std::vector<Sprite> met;
    if (most == 0) return met;
    visit_meeting(roots_, box, [&](const Sprite& sprite) {
        met.push_back(sprite);
        return met.size() < most;
    });
    std::sort(met.begin(), met.end(), drawn_before);
    return met;
}

bool PositioningMap::any_meets(const TexelBox& box) const {
    bool any = false;
    visit_meeting(roots_, box, [&](const Sprite&) { return !(any = true); });
    return any;
}

std::size_t PositioningMap::memory_bytes() const noexcept {
    std::size_t bytes = sizeof(*this);
    for (const NodePtr& root : roots_)
        if (root) bytes += bytes_of(*root);
    return bytes;
}

}  // namespace tessera
