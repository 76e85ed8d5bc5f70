#include "client/view/hand_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tessera {
namespace {

constexpr ImU32 amber = IM_COL32(242, 195, 119, 255), shadow = IM_COL32(10, 12, 14, 140),
                white = IM_COL32(255, 255, 255, 215), handle_fill = IM_COL32(255, 250, 240, 255),
                handle_rim = IM_COL32(201, 138, 43, 255);

/// A line on a bent surface is looked at this often at least, and from there on halved so often where two
/// looks are not enough: in ImGui's units, it may be this far off.
constexpr double step_texels = 32, most_steps = 48;
constexpr int most_halvings = 7;
constexpr float most_bend = 0.25F;

ImU32 colour_of(const HandDesk::Person& person, float alpha = 1) {
    return ImGui::ColorConvertFloat4ToU32({person.red, person.green, person.blue, alpha});
}

}  // namespace

ImVec4 value_colour(int value) {
    ImVec4 colour{0, 0, 0, 1};
    ImGui::ColorConvertHSVtoRGB(static_cast<float>(std::fmod(0.09 + value * 0.381966, 1.0)), 0.65F, 0.95F,
                                colour.x, colour.y, colour.z);
    return colour;
}

std::optional<ImVec2> HandOverlay::place(const HandPoint& at, const HandOffset& away) const {
    const auto pixel = picture_.pixel_of(at, away, sheet_);
    if (!pixel || std::abs(pixel->x) > 1e5 || std::abs(pixel->y) > 1e5) return std::nullopt;
    return ImVec2{static_cast<float>(pixel->x) / unit_, static_cast<float>(pixel->y) / unit_};
}

bool HandOverlay::trace(const HandPoint& middle, std::span<const HandOffset> corners) {
    lines_.clear();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const HandOffset &from = corners[i], &to = corners[(i + 1) % corners.size()];
        const double length = std::hypot(to.x - from.x, to.y - from.y);
        const auto steps =
            picture_.is_plane()
                ? 1
                : static_cast<int>(std::clamp(std::ceil(length / step_texels), 1.0, most_steps));
        std::vector<HandOffset> way{from};
        for (int step = 1; step <= steps; ++step) {
            const double share = static_cast<double>(step) / steps;
            way.push_back({std::lerp(from.x, to.x, share), std::lerp(from.y, to.y, share)});
        }
        follow(middle, way, i > 0);
    }
    std::erase_if(lines_, [](const Line& line) { return line.points.size() < 2; });
    if (lines_.empty()) return false;
    // Where the beginning is seen, it is the end too
    Line &first = lines_.front(), &last = lines_.back();
    const ImVec2 begin = first.points.front(), end = last.points.back();
    if (std::hypot(begin.x - end.x, begin.y - end.y) > 0.01F) return true;
    last.points.pop_back();
    if (lines_.size() == 1) {
        last.is_closed = true;
    } else {
        last.points.insert(last.points.end(), first.points.begin(), first.points.end());
        lines_.erase(lines_.begin());
    }
    return true;
}

void HandOverlay::follow(const HandPoint& middle, std::span<const HandOffset> way, bool goes_on) {
    Place before{way[0], place(middle, way[0])};
    if (before.seen && !(goes_on && !lines_.empty() && lines_.back().is_open)) begin_line(*before.seen);
    for (const HandOffset& away : way.subspan(1)) {
        const Place next{away, place(middle, away)};
        go_on(middle, before, next, most_halvings);
        before = next;
    }
}

void HandOverlay::begin_line(const ImVec2& at) {
    lines_.emplace_back().points.push_back(at);
    lines_.back().is_open = true;
}

/// Halved where the surface bends, and where what is seen ends.
void HandOverlay::go_on(const HandPoint& middle, const Place& from, const Place& to, int halvings) {
    const HandOffset half{(from.away.x + to.away.x) / 2, (from.away.y + to.away.y) / 2};
    const Place between{half, place(middle, half)};
    const auto is_straight = [&] {
        if (!from.seen || !to.seen || !between.seen) return !from.seen && !to.seen && !between.seen;
        const ImVec2 a = *from.seen, b = *to.seen, c = *between.seen;
        const float x = b.x - a.x, y = b.y - a.y, length = std::hypot(x, y);
        return std::abs(x * (c.y - a.y) - y * (c.x - a.x)) <= most_bend * std::max(length, 1.0F);
    };
    if (halvings > 0 && !is_straight()) {
        go_on(middle, from, between, halvings - 1);
        go_on(middle, between, to, halvings - 1);
        return;
    }
    if (to.seen && from.seen) lines_.back().points.push_back(*to.seen);
    if (to.seen && !from.seen) begin_line(*to.seen);
    if (!to.seen && !lines_.empty()) lines_.back().is_open = false;
}

/// Over a darker, wider one, so that it is seen on any ground.
void HandOverlay::stroke(ImU32 colour, float width, bool dashed) {
    for (const Line& line : lines_) {
        const auto count = static_cast<int>(line.points.size());
        const ImDrawFlags flags = line.is_closed ? ImDrawFlags_Closed : ImDrawFlags_None;
        list_.AddPolyline(line.points.data(), count, shadow, flags, (width + 2) * scale_);
        if (!dashed) {
            list_.AddPolyline(line.points.data(), count, colour, flags, width * scale_);
            continue;
        }
        float way = 0;  // along the line, so that dashes go on over its corners
        for (std::size_t i = 0; i + (line.is_closed ? 0 : 1) < line.points.size(); ++i)
            way = dashes(line.points[i], line.points[(i + 1) % line.points.size()], way, colour, width);
    }
}

float HandOverlay::dashes(const ImVec2& a, const ImVec2& b, float way, ImU32 colour, float width) {
    const float dash = 5 * scale_, period = 9 * scale_, length = std::hypot(b.x - a.x, b.y - a.y);
    const float phase = std::fmod(way, period);
    for (float at = -phase; at < std::min(length, 4000.0F); at += period) {
        const float first = std::max(at, 0.0F), end = std::min(at + dash, length);
        const auto on = [&](float share) {
            return ImVec2{a.x + (b.x - a.x) * share / length, a.y + (b.y - a.y) * share / length};
        };
        if (first < end) list_.AddLine(on(first), on(end), colour, width * scale_);
    }
    return std::fmod(way + length, period);
}

/// Hills would hide parts of it: there, the line alone says what is meant.
void HandOverlay::fill(ImU32 colour) {
    if (!picture_.is_plane()) return;
    for (const Line& line : lines_)
        list_.AddConvexPolyFilled(line.points.data(), static_cast<int>(line.points.size()), colour);
}

void HandOverlay::outline(const HandSprite& sprite, ImU32 colour, float width, bool dashed) {
    const auto corners = corners_of(sprite);
    if (trace({sprite.x, sprite.y}, corners)) stroke(colour, width, dashed);
}

void HandOverlay::selection(const HandDesk& desk) {
    if (desk.tool != HandDesk::Tool::hand) return;
    const Hand& hand = desk.hand();
    if (const HandSprite* hovered = hand.hovered())
        if (std::ranges::find(hand.selected(), hovered->id) == hand.selected().end())
            outline(resting_at(*hovered, hand.view().step), white, 1.25F);
    if (const auto ghost = hand.ghost()) outline(*ghost, white, 1.25F, true);
    const std::vector<HandSprite> selection = hand.selection();
    for (const HandSprite& sprite : selection) outline(sprite, amber, 1.75F);
    if (const auto box = hand.marquee()) {
        const HandPoint middle{box->x0 * sprite_units, box->y0 * sprite_units};
        const double x = static_cast<double>(box->x1 - box->x0), y = static_cast<double>(box->y1 - box->y0);
        const std::array<HandOffset, 4> corners{{{0, 0}, {x, 0}, {x, y}, {0, y}}};
        if (trace(middle, corners)) {
            fill(IM_COL32(242, 195, 119, 36));
            stroke(amber, 1.25F);
        }
    }
    const auto frame = hand.frame();
    if (!frame || hand.is_dragging()) return;
    if (selection.size() > 1 && trace(frame->middle, frame->corners))
        stroke(IM_COL32(242, 195, 119, 200), 1, true);
    const auto knob = place(frame->middle, frame->knob);
    const auto top = place(frame->middle, {(frame->corners[0].x + frame->corners[1].x) / 2,
                                           (frame->corners[0].y + frame->corners[1].y) / 2});
    if (knob && top) {
        list_.AddLine(*top, *knob, shadow, 3.5F * scale_);
        list_.AddLine(*top, *knob, amber, 1.5F * scale_);
    }
    const auto under = hand.hovered_handle();
    const auto dot = [&](const std::optional<ImVec2>& at, int which) {
        if (!at) return;
        const float radius = (under && under->which == which ? 7.0F : 5.5F) * scale_;
        list_.AddCircleFilled(*at, radius + 2 * scale_, shadow);
        list_.AddCircleFilled(*at, radius, handle_fill);
        list_.AddCircle(*at, radius, handle_rim, 0, 1.75F * scale_);
    };
    for (int corner = 0; corner < 4; ++corner)
        dot(place(frame->middle, frame->corners[static_cast<std::size_t>(corner)]), corner);
    dot(knob, 4);
}

/// In pieces, of which those behind the eye are left out: they grow with their distance from it.
void HandOverlay::border(const TexelBox& box) {
    const auto [eye, height] = picture_.eye();
    const HandPoint low{box.x0 * sprite_units, box.y0 * sprite_units},
        high{box.x1 * sprite_units, box.y1 * sprite_units};
    const auto side = [&](const HandPoint& from, const HandPoint& to) {
        const auto length = static_cast<double>((to.x - from.x) + (to.y - from.y)) / sprite_units;
        const bool is_along_x = from.y == to.y;
        const double nearest = std::clamp(
            static_cast<double>(is_along_x ? eye.x - from.x : eye.y - from.y) / sprite_units, 0.0, length);
        std::vector<double> marks{nearest};
        for (double away = height / 8; away < length; away *= 1.3) {
            if (nearest - away > 0) marks.insert(marks.begin(), nearest - away);
            if (nearest + away < length) marks.push_back(nearest + away);
        }
        marks.insert(marks.begin(), 0);
        marks.push_back(length);
        std::vector<HandOffset> way;
        for (const double mark : marks) way.push_back(is_along_x ? HandOffset{mark, 0} : HandOffset{0, mark});
        lines_.clear();
        follow(from, way, false);
        stroke(amber, 2);
    };
    side(low, {high.x, low.y});
    side({low.x, high.y}, high);
    side(low, {low.x, high.y});
    side({high.x, low.y}, high);
}

void HandOverlay::brush(HandDesk& desk) {
    if (desk.tool != HandDesk::Tool::brush || !desk.brush()) return;
    if (const auto box = desk.brush()->border()) border(*box);
    if (!desk.cursor()) return;
    constexpr int corners = 64;
    std::array<HandOffset, corners> circle;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        circle[static_cast<std::size_t>(i)] = {desk.brush()->radius_texels * std::cos(angle),
                                               desk.brush()->radius_texels * std::sin(angle)};
    }
    if (!trace(*desk.cursor(), circle)) return;
    const ImVec4 hue = value_colour(desk.brush()->value);
    fill(ImGui::ColorConvertFloat4ToU32({hue.x, hue.y, hue.z, 0.22F}));
    stroke(ImGui::ColorConvertFloat4ToU32(hue), 2);
}

void HandOverlay::targets(HandDesk& desk) {
    if (desk.tool != HandDesk::Tool::target) return;
    for (const proto::Target& target : desk.targets().targets()) {
        const HandPoint at{target.x() * sprite_units, target.y() * sprite_units};
        std::vector<HandOffset> way{{0, 0}};
        for (const auto& leg : target.legs())
            way.push_back(
                {static_cast<double>(leg.x() - target.x()), static_cast<double>(leg.y() - target.y())});
        if (way.size() > 1 && trace(at, way)) stroke(IM_COL32(242, 195, 119, 160), 1.25F, true);
        const auto middle = place(at);
        if (!middle) continue;
        const bool is_held = desk.targets().held() == target.id();
        const float radius = (is_held ? 12.0F : 10.0F) * scale_;
        list_.AddCircle(*middle, radius, shadow, 0, 5 * scale_);
        list_.AddCircle(*middle, radius, amber, 0, 2.5F * scale_);
        list_.AddCircleFilled(*middle, 3 * scale_, amber);
    }
}

void HandOverlay::people(const HandDesk& desk) {
    for (const auto& [session, person] : desk.people()) {
        const ImU32 colour = colour_of(person);
        if (person.held) outline(*person.held, colour, 1.5F, true);
        for (const SpriteId id : person.selected)
            if (!person.held || person.held->id != id)
                if (const auto sprite = desk.hand().now(id)) outline(*sprite, colour, 1.5F);
        const auto at = person.at ? place(*person.at) : std::nullopt;
        if (!at) continue;
        const auto tip = [&](float x, float y) { return ImVec2{at->x + x * scale_, at->y + y * scale_}; };
        const std::array<ImVec2, 4> arrow{tip(0, 0), tip(4.5F, 14), tip(7, 8.5F), tip(12.5F, 6)};
        list_.AddTriangleFilled(arrow[0], arrow[1], arrow[2], colour);
        list_.AddTriangleFilled(arrow[0], arrow[2], arrow[3], colour);
        list_.AddPolyline(arrow.data(), 4, shadow, ImDrawFlags_Closed, 1.25F * scale_);
        const ImVec2 size = ImGui::CalcTextSize(person.name.c_str()), low = tip(12, 13);
        const float pad = 5 * scale_;
        list_.AddRectFilled(low, {low.x + size.x + 2 * pad, low.y + size.y + pad}, colour, 5 * scale_);
        list_.AddText({low.x + pad, low.y + pad / 2}, IM_COL32(14, 16, 20, 255), person.name.c_str());
    }
}

}  // namespace tessera
