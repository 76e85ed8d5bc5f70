#include "server/blocks/cell_schedule.h"

#include <algorithm>

namespace tessera {

namespace {

/// A node's values for cells moved by (dx, dy); of stretches dx is 0, and `further` says how far right it
/// goes.
struct Need {
    int dx = 0, dy = 0, further = 0;
    std::size_t step = 0;  ///< Of the order in which they were found: wholes before parts.
};

struct Use {
    std::size_t node, need;
    int dx;
};

}  // namespace

CellSchedule::CellSchedule(const std::vector<CellNode>& nodes, std::span<const std::size_t> roots,
                           Rows rows) {
    std::vector<std::vector<Need>> needs(nodes.size());
    const auto need = [&](std::size_t node, int dx, int dy, int further) {
        std::vector<Need>& list = needs[node];
        const auto found =
            std::find_if(list.begin(), list.end(), [&](const Need& n) { return n.dx == dx && n.dy == dy; });
        if (found != list.end()) {
            found->further = std::max(found->further, further);
            return static_cast<std::size_t>(found - list.begin());
        }
        list.push_back({dx, dy, further, 0});
        return list.size() - 1;
    };

    // From wholes to parts; every user of a node comes after it, so that its needs are known when it is met
    std::size_t top = 0;
    for (const std::size_t root : roots) need(root, 0, 0, 0), top = std::max(top, root);
    std::vector<std::vector<Use>> uses;
    std::vector<std::pair<std::size_t, std::size_t>> found;  // Node and need of a step
    for (std::size_t node = top + 1; node-- > 0;) {
        for (std::size_t i = 0; i < needs[node].size(); ++i) {
            needs[node][i].step = found.size();
            const Need here = needs[node][i];
            found.emplace_back(node, i);
            std::vector<Use> inputs;
            for (std::size_t input = 0; input < nodes[node].inputs.size(); ++input) {
                const std::size_t part = nodes[node].inputs[input];
                const int corners = nodes[node].corners && input == 0 ? 4 : 1;
                for (int corner = 0; corner < corners; ++corner) {
                    const int right = corner & 1, down = corner >> 1;
                    if (rows == Rows::stretches)
                        inputs.push_back({part, need(part, 0, here.dy + down, here.further + right), right});
                    else
                        inputs.push_back({part, need(part, here.dx + right, here.dy + down, 0), 0});
                }
            }
            uses.push_back(std::move(inputs));
        }
    }

    // The same from parts to wholes, each row in a place that nobody needs any more
    std::vector<std::size_t> last_use(found.size(), 0);
    for (std::size_t step = 0; step < found.size(); ++step)
        for (const Use& use : uses[step]) {
            std::size_t& last = last_use[needs[use.node][use.need].step];
            last = std::max(last, found.size() - step);
        }
    for (const std::size_t root : roots) last_use[needs[root][0].step] = found.size() + 1;
    std::vector<std::size_t> row_of(found.size()), free_rows;
    std::vector<std::vector<std::size_t>> freed(found.size() + 2);
    for (std::size_t step = found.size(); step-- > 0;) {
        const auto [node, which] = found[step];
        const Need& here = needs[node][which];
        const bool leaf =
            nodes[node].draw || nodes[node].map || (nodes[node].driven && rows == Rows::corners);
        const bool given = leaf && rows == Rows::corners;
        // Leaves that are read on several rows keep them from one run to the next
        const bool kept = leaf && !given && needs[node].size() > 1;
        const std::size_t time = found.size() - step;
        if (given || kept || free_rows.empty()) free_rows.push_back(rows_++);
        row_of[step] = free_rows.back();
        free_rows.pop_back();
        // Given rows and kept ones are filled before the first step: their places are theirs alone
        if (!given && !kept) freed[last_use[step]].push_back(row_of[step]);
        if (given) {
            leaves_.push_back({node, here.dx, here.dy, row_of[step]});
            continue;
        }
        Step entry;
        entry.op = nodes[node].op;
        scatters_ &= !nodes[node].corners && entry.op->scatters();
        entry.dy = here.dy;
        entry.further = here.further;
        entry.row = row_of[step];
        for (const Need& other : needs[node])
            entry.kept |= kept && other.dy == here.dy + 1 && other.further >= here.further;
        for (const Use& use : uses[step])
            entry.inputs[static_cast<std::size_t>(entry.input_count++)] = {
                row_of[needs[use.node][use.need].step], use.dx};
        steps_.push_back(std::move(entry));
        free_rows.insert(free_rows.end(), freed[time].begin(), freed[time].end());
    }
    for (const std::size_t root : roots) roots_.push_back(row_of[needs[root][0].step]);

    // From above down, so that each row is read before it is written
    for (int dy = 0; dy < max_reach && rows == Rows::stretches; ++dy)
        for (std::size_t node = 0; node <= top; ++node) {
            if (!nodes[node].draw && !nodes[node].map) continue;
            for (const Need& to : needs[node])
                for (const Need& from : needs[node])
                    if (to.dy == dy && from.dy == dy + 1 && from.further >= to.further)
                        copies_.push_back({row_of[from.step], row_of[to.step], to.further});
        }
}

void CellSchedule::run(const Stretch& stretch, std::int32_t* space, bool follows) const {
    std::array<const std::int32_t*, max_inputs> in{};
    if (follows)
        for (const Copy& copy : copies_)
            std::copy_n(space + copy.from * row_stride, stretch.count + copy.further,
                        space + copy.to * row_stride);
    for (const Step& step : steps_) {
        if (follows && step.kept) continue;
        for (std::size_t i = 0; i < static_cast<std::size_t>(step.input_count); ++i)
            in[i] = space + step.inputs[i].row * row_stride + step.inputs[i].dx;
        Stretch moved = stretch;
        moved.y += step.dy;
        moved.count += step.further;
        step.op->run(moved, in.data(), space + step.row * row_stride);
    }
}

std::size_t CellSchedule::memory_bytes() const noexcept {
    std::size_t bytes = steps_.size() * sizeof(Step);
    for (const Step& step : steps_) bytes += step.op->memory_bytes();
    return bytes;
}

}  // namespace tessera
