#include "server/texture/joined_shapes.h"

#include <algorithm>
#include <bit>
#include <map>

namespace tessera {

/// A row of shapes under way.
struct JoinedShapes::Row {
    static constexpr std::uint32_t nobody = ~std::uint32_t{0};

    const Shapes* shapes;
    std::vector<Part> parts;             ///< All segments of all shapes.
    std::vector<std::uint32_t> counts;   ///< For each column, texels of shapes in the window around.
    std::vector<std::uint32_t> copiers;  ///< For each column, the part that it shows alone.
};

JoinedShapes::JoinedShapes(const ExchangeAsset& asset, const Shapes& shapes, bool join)
    : joined_(shapes.size()) {
    std::map<std::uint16_t, std::vector<Member>> groups;
    const auto exemplar_width = static_cast<std::uint32_t>(asset.exemplar.width);
    for (std::uint32_t s = 0; s < shapes.size(); ++s) {
        const ExchangeAsset::Patch& patch = asset.patches[shapes[s].patch];
        if (!join || patch.group == 0) {
            const Member alone{s, shapes[s].x, shapes[s].y};
            add(shapes, exemplar_width, {&alone, 1});
            continue;
        }
        groups[patch.group].push_back({s, patch.x - shapes.radius(), patch.y - shapes.radius()});
    }
    for (auto& [number, members] : groups) {
        // The first one's own place, which is relative to the tile that it begins on
        const Shapes::Shape& first = shapes[members[0].shape];
        const std::int32_t x = members[0].x - first.x, y = members[0].y - first.y;
        for (Member& member : members) member.x -= x, member.y -= y;
        add(shapes, exemplar_width, members);
        joins_ = true;
    }
    row_begin_.push_back(static_cast<std::uint32_t>(spans_.size()));
}

void JoinedShapes::add(const Shapes& shapes, std::uint32_t exemplar_width, std::span<const Member> members) {
    Joined& joined = joined_[members[0].shape];
    std::int32_t right = INT32_MIN, bottom = INT32_MIN;
    joined.x = joined.y = INT32_MAX;
    for (const Member& member : members) {
        joined.x = std::min(joined.x, member.x);
        joined.y = std::min(joined.y, member.y);
        right = std::max(right, member.x + shapes[member.shape].width);
        bottom = std::max(bottom, member.y + shapes[member.shape].height);
    }
    joined.width = right - joined.x;
    joined.height = bottom - joined.y;
    joined.first_row = static_cast<std::uint32_t>(row_begin_.size());
    Row row;
    row.shapes = &shapes;
    for (std::int32_t y = 0; y < joined.height; ++y) {
        row_begin_.push_back(static_cast<std::uint32_t>(spans_.size()));
        row.parts.clear();
        for (const Member& member : members) {
            const Shapes::Shape& shape = shapes[member.shape];
            const std::int32_t line = joined.y + y - member.y, left = member.x - joined.x;
            if (line < 0 || line >= shape.height) continue;
            const std::uint32_t from = static_cast<std::uint32_t>(shape.from_y + line) * exemplar_width +
                                       static_cast<std::uint32_t>(shape.from_x);
            for (const Shapes::Segment& segment : shapes.row(shape, line))
                row.parts.push_back({static_cast<std::uint16_t>(left + segment.begin),
                                     static_cast<std::uint16_t>(left + segment.end), from + segment.begin,
                                     segment.weights});
        }
        row.counts.assign(static_cast<std::size_t>(joined.width), 0);
        row.copiers.assign(static_cast<std::size_t>(joined.width), Row::nobody);
        add_row(row);
    }
}

void JoinedShapes::add_row(Row& row) {
    const auto diameter = static_cast<std::uint32_t>(2 * row.shapes->radius() + 1);
    const std::uint32_t window = diameter * diameter;
    for (std::uint32_t p = 0; p < row.parts.size(); ++p) {
        const Part& part = row.parts[p];
        if (part.weights == Shapes::Segment::all_one) {
            std::fill(row.copiers.begin() + part.begin, row.copiers.begin() + part.end, p);
            continue;
        }
        const std::uint16_t* weight = row.shapes->weights({part.begin, part.end, part.weights});
        // A weight is count·one / window, rounded down, and a step of it more than one: this is the count
        for (std::size_t x = part.begin; x < part.end; ++x)
            row.counts[x] += (*weight++ * window + Shapes::weight_one - 1) / Shapes::weight_one;
    }
    const auto width = static_cast<std::uint32_t>(row.counts.size());
    const std::size_t first = spans_.size();
    for (std::uint32_t x = 0; x < width;) {
        const std::uint32_t copier = row.copiers[x], count = row.counts[x];
        const auto alike = [&](std::uint32_t at) {
            if (copier != Row::nobody || row.copiers[at] != Row::nobody) return row.copiers[at] == copier;
            return (row.counts[at] == 0) == (count == 0) && (row.counts[at] == window) == (count == window);
        };
        std::uint32_t end = x + 1;
        while (end < width && alike(end)) ++end;
        if (copier != Row::nobody)
            spans_.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(end),
                              row.parts[copier].from + (x - row.parts[copier].begin), 0, 0, Kind::copied});
        else if (count > 0)
            spans_.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(end), 0, 0, 0,
                              count == window ? Kind::sealed : Kind::open});
        x = end;
    }
    // What is copied between or beside sealed texels, and is short, is kept with them
    constexpr int short_span = 16;
    std::size_t last = first;
    for (std::size_t s = first; s < spans_.size(); ++s) {
        const Span span = spans_[s];
        const auto sealed = [&](std::size_t at) {
            return at >= first && at < spans_.size() && spans_[at].kind == Kind::sealed;
        };
        const bool after =
            last > first && spans_[last - 1].kind == Kind::sealed && spans_[last - 1].end == span.begin;
        const bool before = sealed(s + 1) && spans_[s + 1].begin == span.end;
        const bool kept =
            span.kind == Kind::copied && span.end - span.begin <= short_span && (after || before);
        if (after && (kept || span.kind == Kind::sealed)) {
            spans_[last - 1].end = span.end;
            continue;
        }
        spans_[last] = span;
        if (kept) spans_[last].kind = Kind::sealed;
        ++last;
    }
    spans_.resize(last);
    for (std::size_t s = first; s < last; ++s) {
        Span& span = spans_[s];
        if (span.kind == Kind::copied) continue;
        span.from = static_cast<std::uint32_t>(uncopied_);
        uncopied_ += static_cast<std::size_t>(span.end - span.begin);
        span.first_part = static_cast<std::uint32_t>(parts_.size());
        for (const Part& part : row.parts) {
            const std::uint16_t begin = std::max(part.begin, span.begin), end = std::min(part.end, span.end);
            if (begin >= end) continue;
            const auto skipped = static_cast<std::uint32_t>(begin - part.begin);
            parts_.push_back(
                {begin, end, part.from + skipped,
                 part.weights == Shapes::Segment::all_one ? part.weights : part.weights + skipped});
        }
        span.part_count = static_cast<std::uint16_t>(parts_.size() - span.first_part);
    }
}

Variants JoinedShapes::joined(const Variants& variants, std::int32_t tile_side) const {
    Variants out;
    out.unit_tiles = variants.unit_tiles;
    out.apart = variants.apart;
    std::vector<Shown> list;
    for (std::uint32_t type = 0; type < variants.types(); ++type) {
        list.clear();
        for (const Shown& shown : variants.of(type))
            if (joined_[shown.shape].height > 0) list.push_back(shown);
        out.add(list);
    }
    const auto top_of = [&](const Shown& one) {
        return std::int64_t{one.tile_y} * tile_side + joined_[one.shape].y;
    };
    out.sort([&](const Shown& a, const Shown& b) { return top_of(a) < top_of(b); });
    return out;
}

std::size_t JoinedShapes::memory_bytes() const noexcept {
    return joined_.size() * sizeof(Joined) + row_begin_.size() * sizeof(std::uint32_t) +
           spans_.size() * sizeof(Span) + parts_.size() * sizeof(Part);
}

}  // namespace tessera
