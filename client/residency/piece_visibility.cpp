#include "client/residency/piece_visibility.h"

#include <algorithm>
#include <cmath>

#include "client/residency/quick_math.h"

namespace tessera {
namespace {

constexpr double pixel_margin = 0.02;  ///< By which the GPU may place a side elsewhere
constexpr float depth_margin = 1e-4F;  ///< Of 1

}  // namespace

PieceVisibility::PieceVisibility(const PlaneView& view) : view_{view} {
    known_.reserve(view.pieces().size());
    if (view.is_plane()) {
        for (const FlatPiece& piece : view.pieces()) known_.push_back({.box = box_of(piece)});
        return;
    }
    const auto width = static_cast<std::size_t>(view.width());
    nearest_.assign(width * static_cast<std::size_t>(view.height()), 0);
    for (const FlatPiece& piece : view.pieces()) add_to_nearest(piece);
    for (std::size_t i = 0; i < known_.size(); ++i) find_rows(view.pieces()[i], known_[i]);
}

/// What of it lies before the others so far; keeps its rows as they would be if nothing hid it.
void PieceVisibility::add_to_nearest(const FlatPiece& piece) {
    const Known& known = known_.emplace_back(Known{box_of(piece), rows_.size()});
    const Lines lines = lines_of(piece);
    const auto step = static_cast<float>(piece.w[0]);
    for (int y = known.box.top; y < known.box.bottom; ++y) {
        Span exact, wide;
        row_spans(lines, y + 0.5, known.box, exact, wide);
        rows_.push_back({wide.first, wide.end, 0});
        const auto begin = static_cast<float>(piece.w[0] * (0.5 - view_.width() / 2.0) +
                                              piece.w[1] * (y + 0.5 - view_.height() / 2.0) + piece.w[2]);
        float* row = nearest_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width());
        for (int x = exact.first; x < exact.end; ++x) {
            const float w = begin + static_cast<float>(x) * step;
            row[x] = row[x] < w ? w : row[x];
        }
    }
}

void PieceVisibility::find_rows(const FlatPiece& piece, const Known& known) {
    for (int y = known.box.top; y < known.box.bottom; ++y) {
        Row& row = rows_[known.first_row + static_cast<std::size_t>(y - known.box.top)];
        row = shown_in(piece, y, row.left, row.right);
    }
}

/// Of a row's pixels [first, end), which lie in the piece: those that show it.
PieceVisibility::Row PieceVisibility::shown_in(const FlatPiece& piece, int y, int first, int end) const {
    if (first >= end) return {};
    const float* row =
        nearest_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width());
    const auto step = static_cast<float>(piece.w[0]);
    const auto begin = static_cast<float>(piece.w[0] * (0.5 - view_.width() / 2.0) +
                                          piece.w[1] * (y + 0.5 - view_.height() / 2.0) + piece.w[2]);
    // Of a piece that is seen nearly edge on, w differs much from one pixel to the next
    const auto slack = static_cast<float>(pixel_margin * (std::abs(piece.w[0]) + std::abs(piece.w[1])));
    const auto shows = [&](int x) {
        return begin + static_cast<float>(x) * step + slack >= row[x] * (1 - depth_margin);
    };
    int pixels = 0;
    for (int x = first; x < end; ++x) pixels += shows(x) ? 1 : 0;
    if (pixels == 0) return {};
    while (!shows(first)) ++first;
    while (!shows(end - 1)) --end;
    return {first, end, pixels};
}

PieceVisibility::Lines PieceVisibility::lines_of(const FlatPiece& piece) const {
    Lines made;
    const double step = view_.pixel_step();
    // a·x + b·y + c ≥ 0 on the piece's side, in pixels once it is scaled
    const auto add = [&](double a, double b, double c) {
        const double scale = 1 / std::max(std::hypot(a, b), 1e-300);
        a *= scale;
        b *= scale;
        c *= scale;
        if (std::abs(a) < 1e-12) {
            made.level[made.levels++] = {b, c};
            return;
        }
        Line& line = a > 0 ? made.left[made.lefts++] : made.right[made.rights++];
        line = {-b / a, -c / a, -pixel_margin / a};
    };
    for (int i = 0; i < piece.corner_count; ++i) {
        // The plane through the eye and this side
        const Vector3 normal = cross(piece.corners[static_cast<std::size_t>((i + 1) % piece.corner_count)],
                                     piece.corners[static_cast<std::size_t>(i)]);
        add(step * dot(normal, view_.right()), -step * dot(normal, view_.up()), dot(normal, view_.forward()));
    }
    add(piece.w[0], piece.w[1], piece.w[2]);
    return made;
}

void PieceVisibility::row_spans(const Lines& lines, double y, const PixelBox& box, Span& exact,
                                Span& wide) const {
    const double py = y - view_.height() / 2.0, middle = view_.width() / 2.0;
    double low = box.left - middle, high = box.right - middle, wide_low = low, wide_high = high;
    for (int i = 0; i < lines.lefts; ++i) {
        const double at = lines.left[i].slope * py + lines.left[i].at;
        low = std::max(low, at);
        wide_low = std::max(wide_low, at + lines.left[i].wider);
    }
    for (int i = 0; i < lines.rights; ++i) {
        const double at = lines.right[i].slope * py + lines.right[i].at;
        high = std::min(high, at);
        wide_high = std::min(wide_high, at + lines.right[i].wider);
    }
    for (int i = 0; i < lines.levels; ++i) {
        const double rest = lines.level[i].b * py + lines.level[i].c;
        if (rest < 0) high = low;
        if (rest + pixel_margin < 0) wide_high = wide_low;
    }
    // Middles from low to high
    const auto span = [&](double from, double to) {
        const double left = std::clamp(from + middle - 0.5, -1e9, 1e9),
                     right = std::clamp(to + middle - 0.5, -1e9, 1e9);
        return Span{std::max(box.left, -static_cast<int>(floor_of(-left))),
                    std::min(box.right, static_cast<int>(floor_of(right)) + 1)};
    };
    exact = span(low, high);
    wide = span(wide_low, wide_high);
}

PixelBox PieceVisibility::box_of(const FlatPiece& piece) const {
    const PixelBox whole{view_.first_column(), 0, view_.end_column(), view_.height()};
    if (piece.corner_count == 0) return whole;
    double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
    const auto place = [&](const Vector3& corner) {
        return Vector3{dot(corner, view_.right()), dot(corner, view_.up()), dot(corner, view_.forward())};
    };
    double doubled_area = 0, last_x = 0, last_y = 0, first_x = 0, first_y = 0;
    int places = 0;
    const auto include = [&](const Vector3& v) {
        const double x = v.x / v.z / view_.pixel_step() + view_.width() / 2.0,
                     y = view_.height() / 2.0 - v.y / v.z / view_.pixel_step();
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
        if (places++ == 0) first_x = x, first_y = y;
        doubled_area += last_x * (y - first_y) - (x - first_x) * last_y;
        last_x = x - first_x;
        last_y = y - first_y;
    };
    for (int i = 0; i < piece.corner_count; ++i) {
        const Vector3 a = place(piece.corners[static_cast<std::size_t>(i)]),
                      b = place(piece.corners[static_cast<std::size_t>((i + 1) % piece.corner_count)]);
        // So near the eye that nothing before it is in the picture
        const double least = 1e-4 * view_.camera().height_texels;
        if (a.z > least) include(a);
        if ((a.z > least) != (b.z > least)) {
            const double part = (least - a.z) / (b.z - a.z);
            include({a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), least});
        }
    }
    // At the tips of slivers the margin along their sides reaches far
    const double longest = std::hypot(right - left, bottom - top);
    const double tips =
        std::min(2 * pixel_margin * longest * longest / std::max(std::abs(doubled_area), 1e-9), 1e4) +
        pixel_margin;
    const auto pixel = [](double at, int least, int most) {
        return static_cast<int>(
            std::clamp(std::floor(at), static_cast<double>(least), static_cast<double>(most)));
    };
    return {pixel(left - tips, whole.left, whole.right), pixel(top - tips, 0, whole.bottom),
            pixel(right + tips + 1, whole.left, whole.right), pixel(bottom + tips + 1, 0, whole.bottom)};
}

PieceVisibility::Seen PieceVisibility::seen(const FlatPiece& piece, const PixelBox& box) const {
    Seen found;
    found.box = {box.right, box.bottom, box.left, box.top};
    if (view_.is_plane()) {
        // The horizon is level
        const auto is_seen = [&](int y) {
            return piece.w[1] * (y + 0.5 - view_.height() / 2.0) + piece.w[2] > 0;
        };
        while (found.box.bottom < box.bottom) {
            if (is_seen(found.box.bottom)) break;
            ++found.box.bottom;
        }
        found.box = {box.left, found.box.bottom, box.right, box.bottom};
        found.pixels = std::max(found.box.pixels(), 0);
        if (found.box.is_empty()) found.pixels = 0;
        found.x = (box.left + box.right) / 2;
        found.y = (found.box.top + box.bottom) / 2;
        return found;
    }
    const Known& known = known_of(piece);
    const int middle_x = (box.left + box.right) / 2, middle_y = (box.top + box.bottom) / 2;
    int least_away = 1 << 30;
    for (int y = std::max(box.top, known.box.top); y < std::min(box.bottom, known.box.bottom); ++y) {
        Row row = rows_[known.first_row + static_cast<std::size_t>(y - known.box.top)];
        const bool is_whole = row.pixels == row.right - row.left;
        const bool is_inside = row.left >= box.left && row.right <= box.right;
        if (!is_inside) {
            row.left = std::max(row.left, box.left);
            row.right = std::min(row.right, box.right);
            if (row.left >= row.right) continue;
            if (is_whole)
                row.pixels = row.right - row.left;
            else
                row = shown_in(piece, y, row.left, row.right);
        }
        const auto [left, right, pixels] = row;
        if (pixels == 0) continue;
        found.pixels += pixels;
        found.box.left = std::min(found.box.left, left);
        found.box.right = std::max(found.box.right, right);
        found.box.top = std::min(found.box.top, y);
        found.box.bottom = y + 1;
        if (std::abs(y - middle_y) >= least_away) continue;
        const int x = std::abs(left - middle_x) < std::abs(right - 1 - middle_x) ? left : right - 1;
        const int nearest_x = pixels == right - left ? std::clamp(middle_x, left, right - 1) : x;
        const int away = std::abs(nearest_x - middle_x) + std::abs(y - middle_y);
        if (away < least_away) {
            least_away = away;
            found.x = nearest_x;
            found.y = y;
        }
    }
    return found;
}

}  // namespace tessera
