#include "client/view/window_hands.h"

#include <cmath>

namespace tessera {

WindowHands::WindowHands(ViewSource& source, const ServerAddress& server, const SceneInfo& scene,
                         const std::string& name, const WindowEvents& events) {
    BackgroundStreamClient* stream = source.stream();
    if (!stream) return;
    desk_ = std::make_unique<HandDesk>(*stream, server, scene, name);
    input_ = std::make_unique<HandInput>(events, *desk_);
    panel_ = std::make_unique<HandPanel>(*desk_);
}

void WindowHands::advance(const ViewFrame& last, Extent extent, double cursor_x, double cursor_y) {
    if (!desk_ || last.width == 0) return;
    const HandPicture& picture = picture_of(last.view());
    const double texels = picture.texels_per_pixel(cursor_x, cursor_y);
    input_->advance(picture, cursor_x, cursor_y, extent, static_cast<int>(std::lround(std::log2(texels))));
    desk_->advance({.now = last.time.now,
                    .step = last.time.step,
                    .texels_per_pixel = texels,
                    .view = picture.seen(extent)});
}

const HandPicture& WindowHands::picture_of(const PlaneView& view) {
    if (!picture_ || !picture_->view().is_same(view)) picture_.emplace(view);
    return *picture_;
}

void WindowHands::bring_pictures(PlaneScene& scene, PlaneScene* second, const PictureListener& brought) {
    if (!desk_) return;
    const auto bring = [&](PlaneScene& to, std::int32_t pattern) {
        if (const Rgba8Image* picture = desk_->picture(pattern))
            to.held_patterns().set_pattern(pattern, *picture, desk_->pattern_side_texels());
    };
    for (const std::int32_t pattern : desk_->take_new_pictures()) {
        bring(scene, pattern);
        if (second) bring(*second, pattern);
        if (const Rgba8Image* picture = desk_->picture(pattern))
            brought(pattern, *picture, desk_->pattern_side_texels());
    }
    if (second && second != known_second_)
        for (std::int32_t pattern = 0; pattern < desk_->pattern_count(); ++pattern) bring(*second, pattern);
    known_second_ = second;
}

PanelRoom WindowHands::draw_panels(const PlaneView& view, float scale, float pixels_per_unit) {
    return desk_ ? panel_->draw(picture_of(view), scale, pixels_per_unit) : PanelRoom{};
}

}  // namespace tessera
