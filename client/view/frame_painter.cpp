#include "client/view/frame_painter.h"

#include <algorithm>
#include <iterator>

namespace tessera {
namespace {

constexpr int line_pixels = 2;

PlaneStyle style_of(const ViewFrame& frame) {
    return {.filter = frame.filter, .fade_ms = frame.fade_ms, .haze = frame.haze, .overlay = frame.overlay};
}

/// What the pages do not show in this frame.
std::vector<HeldSprite> still_held(std::vector<HeldSprite> held, const ResidencyFrame& frame) {
    const auto is_one_of = [](const std::vector<std::uint32_t>& holds, std::uint32_t hold) {
        return std::ranges::find(holds, hold) != holds.end();
    };
    std::erase_if(held, [&](const HeldSprite& sprite) {
        return sprite.hold != 0 &&
               (is_one_of(frame.ended_holds, sprite.hold) || is_one_of(frame.unlifted_holds, sprite.hold));
    });
    return held;
}

/// Of both parts of the picture; what covers how much of it, by their widths.
void add_part(ResidencyFrame& frame, ResidencyFrame part, double share) {
    std::ranges::move(part.uploads, std::back_inserter(frame.uploads));
    frame.needed += part.needed;
    frame.missing += part.missing;
    frame.stale += part.stale;
    frame.lod_bias = std::max(frame.lod_bias, part.lod_bias);
    frame.resident_share += share * (part.resident_share - frame.resident_share);
    frame.mip_deficit += share * (part.mip_deficit - frame.mip_deficit);
}

}  // namespace

ResidencyFrame FramePainter::update(const ViewFrame& frame) {
    scene_.set_uploads_per_frame(frame.most_uploads);
    scene_.hold(frame.holds);
    const PlaneView view = frame.view();
    beside_.reset();
    if (!frame.split || !frame.split->is_second || !second_) {
        ResidencyFrame whole = scene_.update(view, frame.time, frame.filter);
        scene_.show_held(still_held(frame.held, whole));
        return whole;
    }
    const int column = frame.split_column();
    ResidencyFrame left = scene_.update(view.part(0, column), frame.time, frame.filter);
    second_->set_uploads_per_frame(frame.most_uploads);
    second_->hold(frame.holds);
    ResidencyFrame right = second_->update(view.part(column, frame.width), frame.time, frame.split->filter);
    scene_.show_held(still_held(frame.held, left));
    second_->show_held(still_held(frame.held, right));
    beside_ = {std::move(right.sampled), right.uploads.size()};
    add_part(left, std::move(right), 1 - static_cast<double>(column) / frame.width);
    return left;
}

Result<void> FramePainter::draw(const ViewFrame& frame, const FrameTarget& target) {
    const PlaneView view = frame.view();
    PlaneStyle style = style_of(frame);
    if (!frame.split) return scene_.draw(target, view, style);
    const int column = frame.split_column();
    style.end_column = column;
    if (const auto left = scene_.draw(target, view, style); !left) return left.error();
    style.filter = frame.split->filter;
    style.first_column = column;
    style.end_column = frame.width;
    PlaneScene& right = frame.split->is_second && second_ ? *second_ : scene_;
    if (const auto drawn = right.draw(target, view, style); !drawn) return drawn.error();

    target.bind();
    glEnable(GL_SCISSOR_TEST);
    glScissor(std::max(column - line_pixels / 2, 0), 0, line_pixels, frame.height);
    constexpr float white[] = {0.95F, 0.97F, 1, 1};
    glClearBufferfv(GL_COLOR, 0, white);
    glDisable(GL_SCISSOR_TEST);
    return {};
}

}  // namespace tessera
