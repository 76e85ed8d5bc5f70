#include "client/view/record/frame_message.h"

#include <cmath>
#include <string>
#include <utility>

#include "client/residency/height_field.h"
#include "client/view/record/session.pb.h"

namespace tessera {
namespace {

Error wrong(const std::string& field) {
    return {ErrorCode::invalid_input, "a recorded frame's " + field + " is out of its range"};
}

void write_point(const PlanePoint& point, auto& message) {
    message.set_x(point.x);
    message.set_y(point.y);
    message.set_fraction_x(point.fraction_x);
    message.set_fraction_y(point.fraction_y);
}

PlanePoint read_point(const auto& message) {
    return {message.x(), message.y(), message.fraction_x(), message.fraction_y()};
}

void write_filter(const FilterChoice& choice, view::RecordedFilter& message) {
    message.set_filter(static_cast<std::int32_t>(choice.filter));
    message.set_subsamples(choice.subsamples);
    message.set_columns(choice.columns);
}

bool read_filter(const view::RecordedFilter& message, FilterChoice& choice) {
    if (message.filter() < 0 || message.filter() > static_cast<int>(Filter::stored)) return false;
    if (message.subsamples() < 1 || message.subsamples() > max_subsamples) return false;
    if (message.columns() < 1 || message.columns() > max_columns) return false;
    choice = {static_cast<Filter>(message.filter()), message.subsamples(), message.columns()};
    return true;
}

void write_box(const TexelBox& box, view::RecordedBox& message) {
    message.set_x0(box.x0);
    message.set_y0(box.y0);
    message.set_x1(box.x1);
    message.set_y1(box.y1);
}

std::vector<TexelBox> read_boxes(const google::protobuf::RepeatedPtrField<view::RecordedBox>& messages) {
    std::vector<TexelBox> boxes;
    for (const view::RecordedBox& box : messages) boxes.push_back({box.x0(), box.y0(), box.x1(), box.y1()});
    return boxes;
}

/// All that may be a number and no surprise.
bool are_finite(auto... numbers) { return (std::isfinite(numbers) && ...); }

}  // namespace

void write_frame(const ViewFrame& frame, view::RecordedFrame& message) {
    view::RecordedCamera& camera = *message.mutable_camera();
    write_point(frame.camera.ground, camera);
    camera.set_height(frame.camera.height_texels);
    camera.set_yaw(frame.camera.yaw_degrees);
    camera.set_pitch(frame.camera.pitch_degrees);
    camera.set_field_of_view(frame.camera.field_of_view_degrees);
    message.set_width(frame.width);
    message.set_height(frame.height);
    message.set_now_ms(frame.time.now.count());
    message.set_step(frame.time.step);
    message.set_steps_per_second(frame.time.steps_per_second);
    write_filter(frame.filter, *message.mutable_filter());
    message.set_fade_ms(frame.fade_ms);
    message.set_haze(frame.haze);
    message.set_overlay(static_cast<std::int32_t>(frame.overlay));
    view::RecordedSurface& surface = *message.mutable_surface();
    surface.set_kind(static_cast<std::int32_t>(frame.surface.kind));
    surface.set_relief(frame.surface.relief);
    surface.set_has_heights(frame.surface.heights != nullptr);
    surface.set_middle_x(frame.surface.middle_x);
    surface.set_half_side(frame.surface.half_side);
    if (frame.split) {
        view::RecordedSplit& split = *message.mutable_split();
        split.set_at(frame.split->at);
        write_filter(frame.split->filter, *split.mutable_filter());
        split.set_is_second(frame.split->is_second);
    }
    for (const HeldSprite& held : frame.held) {
        view::RecordedHeldSprite& sprite = *message.add_held();
        write_point(held.middle, sprite);
        sprite.set_pattern(held.pattern);
        sprite.set_scale(held.scale);
        sprite.set_turns(held.turns);
        sprite.set_opacity(held.opacity);
        sprite.set_sharp(held.sharp);
        sprite.set_hold(held.hold);
    }
    for (const PageHold& hold : frame.holds) {
        view::RecordedHold& one = *message.add_holds();
        one.set_id(hold.id);
        for (const TexelBox& box : hold.boxes) write_box(box, *one.add_boxes());
        one.set_waits(hold.waits);
        one.set_revision(hold.revision);
        for (const std::uint64_t sprite : hold.lifted) one.add_lifted(sprite);
        for (const TexelBox& box : hold.lifted_boxes) write_box(box, *one.add_lifted_boxes());
    }
    message.set_most_uploads(frame.most_uploads);
}

Result<ViewFrame> read_frame(const view::RecordedFrame& message,
                             const std::shared_ptr<const HeightImage>& heights) {
    ViewFrame frame;
    const view::RecordedCamera& camera = message.camera();
    frame.camera = {.ground = read_point(camera),
                    .height_texels = camera.height(),
                    .yaw_degrees = camera.yaw(),
                    .pitch_degrees = camera.pitch(),
                    .field_of_view_degrees = camera.field_of_view()};
    if (!are_finite(camera.fraction_x(), camera.fraction_y(), camera.height(), camera.yaw(), camera.pitch(),
                    camera.field_of_view()) ||
        !(camera.height() > 0) || camera.pitch() < -90 || camera.pitch() > 89 || camera.field_of_view() < 1 ||
        camera.field_of_view() > 150)
        return wrong("camera");
    if (message.width() < 1 || message.width() > 16384 || message.height() < 1 || message.height() > 16384)
        return wrong("size");
    frame.width = message.width();
    frame.height = message.height();
    frame.time = {ClientTime{message.now_ms()}, message.step(), message.steps_per_second()};
    if (!read_filter(message.filter(), frame.filter)) return wrong("filter");
    frame.fade_ms = message.fade_ms();
    frame.haze = message.haze();
    if (message.overlay() < 0 || message.overlay() >= static_cast<int>(overlays.size()))
        return wrong("overlay");
    frame.overlay = static_cast<Overlay>(message.overlay());
    const view::RecordedSurface& surface = message.surface();
    if (surface.kind() < 0 || surface.kind() > static_cast<int>(Surface::Kind::corridor) ||
        !are_finite(surface.relief(), surface.half_side()) || !(surface.half_side() > 0) ||
        surface.relief() < 0 || surface.relief() > 1000 || (surface.has_heights() && !heights))
        return wrong("surface");
    frame.surface = {.kind = static_cast<Surface::Kind>(surface.kind()),
                     .relief = surface.relief(),
                     .heights = surface.has_heights() ? heights : nullptr,
                     .middle_x = surface.middle_x(),
                     .half_side = surface.half_side()};
    if (message.has_split()) {
        SplitChoice split{.at = message.split().at(), .is_second = message.split().is_second()};
        if (!(split.at >= 0 && split.at <= 1) || !read_filter(message.split().filter(), split.filter))
            return wrong("split");
        frame.split = split;
    }
    for (const view::RecordedHeldSprite& held : message.held())
        frame.held.push_back({.pattern = held.pattern(),
                              .middle = read_point(held),
                              .scale = held.scale(),
                              .turns = held.turns(),
                              .opacity = held.opacity(),
                              .sharp = held.sharp(),
                              .hold = held.hold()});
    for (const view::RecordedHold& hold : message.holds())
        frame.holds.push_back({.id = hold.id(),
                               .boxes = read_boxes(hold.boxes()),
                               .waits = hold.waits(),
                               .revision = hold.revision(),
                               .lifted = {hold.lifted().begin(), hold.lifted().end()},
                               .lifted_boxes = read_boxes(hold.lifted_boxes())});
    if (message.most_uploads() < 1 || message.most_uploads() > 4096) return wrong("most_uploads");
    frame.most_uploads = message.most_uploads();
    return frame;
}

void write_settings(const ResidencySettings& settings, view::CacheSettings& message) {
    message.set_slots(settings.slots);
    message.set_window_side(settings.window_side);
    message.set_pinned_levels(settings.pinned_levels);
    message.set_uploads_per_frame(settings.uploads_per_frame);
    message.set_prefetch(settings.prefetch);
    message.set_stand_ins(settings.stand_ins);
    message.set_in_flight(settings.requests.in_flight);
    message.set_least_in_flight(settings.requests.least_in_flight);
    message.set_frames_unwanted(settings.requests.frames_unwanted);
    message.set_first_back_off_ms(settings.requests.first_back_off.count());
    message.set_longest_back_off_ms(settings.requests.longest_back_off.count());
    message.set_patience_ms(settings.requests.patience.count());
}

Result<ResidencySettings> read_settings(const view::CacheSettings& message) {
    const int side = message.window_side();
    if (message.slots() < 1 || message.slots() > 2048 || side < 4 || side > 256 || (side & (side - 1)) != 0 ||
        message.pinned_levels() < 0 || message.pinned_levels() > 5 || message.uploads_per_frame() < 1 ||
        message.uploads_per_frame() > 4096 || message.stand_ins() > 1024 || message.in_flight() < 1 ||
        message.in_flight() > 4096 || message.least_in_flight() < 1 || message.least_in_flight() > 4096)
        return Error{ErrorCode::invalid_input, "a recorded session's cache settings are out of their range"};
    return ResidencySettings{.slots = message.slots(),
                             .window_side = side,
                             .pinned_levels = message.pinned_levels(),
                             .uploads_per_frame = message.uploads_per_frame(),
                             .prefetch = message.prefetch(),
                             .stand_ins = message.stand_ins(),
                             .requests = {.in_flight = message.in_flight(),
                                          .least_in_flight = message.least_in_flight(),
                                          .frames_unwanted = message.frames_unwanted(),
                                          .first_back_off = ClientTime{message.first_back_off_ms()},
                                          .longest_back_off = ClientTime{message.longest_back_off_ms()},
                                          .patience = ClientTime{message.patience_ms()}}};
}

void write_heights(const HeightImage& heights, view::HeightField& message) {
    message.set_width(heights.width());
    message.set_height(heights.height());
    std::string& codes = *message.mutable_codes();
    for (const std::uint16_t code : heights.codes()) {
        codes += static_cast<char>(code & 255);
        codes += static_cast<char>(code >> 8);
    }
}

Result<std::shared_ptr<const HeightImage>> read_heights(const view::HeightField& message) {
    const std::int64_t width = message.width(), height = message.height();
    if (width < 2 || width > 8192 || height < 2 || height > 8192 ||
        message.codes().size() != static_cast<std::size_t>(2 * width * height))
        return Error{ErrorCode::invalid_input, "a recorded terrain's heights are broken"};
    std::vector<std::uint16_t> codes;
    codes.reserve(message.codes().size() / 2);
    for (std::size_t i = 0; i < message.codes().size(); i += 2)
        codes.push_back(static_cast<std::uint16_t>(static_cast<std::uint8_t>(message.codes()[i]) |
                                                   static_cast<std::uint8_t>(message.codes()[i + 1]) << 8));
    return std::shared_ptr<const HeightImage>{
        std::make_shared<HeightImage>(message.width(), message.height(), std::move(codes))};
}

}  // namespace tessera
