#include "client/view/camera_path.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <sstream>

#include "client/view/view.pb.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

Result<CameraPath::Key> checked_key(const view::CameraKey& key, double field_of_view, Extent extent,
                                    const std::string& where) {
    const auto wrong = [&](const std::string& what) {
        return Error{ErrorCode::invalid_input, where + ": " + what};
    };
    const std::int64_t side = extent.side_texels();
    if (key.x() < 0 || key.y() < 0 || key.x() >= side || key.y() >= side)
        return wrong("x and y must be 0 to " + std::to_string(side - 1) + ", the scene's extent");
    const auto is_fraction = [](double value) { return value >= 0 && value < 1; };
    if (!is_fraction(key.x_fraction()) || !is_fraction(key.y_fraction()))
        return wrong("x_fraction and y_fraction must be 0 to below 1");
    if (!(key.height() > 0) || key.height() > 1e15)
        return wrong("height must be given, in texels, more than 0 and at most 1e15");
    if (!(key.pitch() >= -90 && key.pitch() <= 89)) return wrong("pitch must be -90 (down) to 89 degrees");
    if (!(std::abs(key.yaw()) <= 1e6)) return wrong("yaw must be a number of degrees");
    if (!std::isfinite(key.time())) return wrong("time must be a number of seconds");
    return CameraPath::Key{key.time(),
                           {{key.x(), key.y(), key.x_fraction(), key.y_fraction()},
                            key.height(),
                            key.yaw(),
                            key.pitch(),
                            field_of_view}};
}

}  // namespace

Result<CameraPath> CameraPath::read(const std::filesystem::path& file, Extent extent) {
    std::ifstream stream{file, std::ios::binary};
    std::string json{std::istreambuf_iterator<char>{stream}, {}};
    if (!stream || std::filesystem::is_directory(file))
        return Error{ErrorCode::invalid_input, file.string() + ": cannot be read"};
    return parse(json, file.string(), extent);
}

Result<CameraPath> CameraPath::parse(std::string_view json, std::string_view where, Extent extent) {
    view::CameraPath message;
    if (const auto read = read_json(json, where, message); !read) return read.error();
    if (message.keys().empty())
        return Error{ErrorCode::invalid_input, std::string{where} + ": keys must hold at least one key"};
    const double field_of_view = message.field_of_view() == 0 ? 50 : message.field_of_view();
    if (!(field_of_view >= 1 && field_of_view <= 150))
        return Error{ErrorCode::invalid_input,
                     std::string{where} + ": field_of_view must be 1 to 150 degrees"};
    std::vector<Key> keys;
    for (int i = 0; i < message.keys_size(); ++i) {
        const std::string key_name = std::string{where} + ": keys[" + std::to_string(i) + "]";
        auto key = checked_key(message.keys(i), field_of_view, extent, key_name);
        if (!key) return key.error();
        if (!keys.empty() && key->seconds <= keys.back().seconds)
            return Error{ErrorCode::invalid_input, key_name + ": time must be later than the key before"};
        keys.push_back(key.value());
    }
    return CameraPath{std::move(keys)};
}

Camera CameraPath::at(double seconds) const {
    const auto after =
        std::ranges::upper_bound(keys_, seconds, {}, [](const Key& key) { return key.seconds; });
    if (after == keys_.begin()) return keys_.front().camera;
    if (after == keys_.end()) return keys_.back().camera;
    const Camera &from = std::prev(after)->camera, &to = after->camera;
    const double t = (seconds - std::prev(after)->seconds) / (after->seconds - std::prev(after)->seconds);
    Camera camera = from;
    camera.ground =
        from.ground.moved(t * distance_x(from.ground, to.ground), t * distance_y(from.ground, to.ground));
    camera.height_texels = from.height_texels * std::pow(to.height_texels / from.height_texels, t);
    camera.yaw_degrees += t * (to.yaw_degrees - from.yaw_degrees);
    camera.pitch_degrees += t * (to.pitch_degrees - from.pitch_degrees);
    return camera;
}

std::string camera_key_json(double seconds, const Camera& camera) {
    std::ostringstream text;
    text.precision(9);
    text << "{\"time\": " << seconds << ", \"x\": \"" << camera.ground.x << "\", \"y\": \"" << camera.ground.y
         << "\", \"x_fraction\": " << std::min(camera.ground.fraction_x, 0.999999)
         << ", \"y_fraction\": " << std::min(camera.ground.fraction_y, 0.999999)
         << ", \"height\": " << camera.height_texels << ", \"yaw\": " << camera.yaw_degrees
         << ", \"pitch\": " << camera.pitch_degrees << "}";
    return text.str();
}

Camera first_camera(Extent extent) {
    const std::int64_t middle = extent.side_texels() / 2;
    return {.ground = {middle, middle, 0.5, 0.5},
            .height_texels = std::min(700.0, static_cast<double>(extent.side_texels())),
            .yaw_degrees = 24,
            .pitch_degrees = -22};
}

Camera first_camera(const OpeningView& view, Extent extent, double height_pixels) {
    constexpr double radians = std::numbers::pi / 180;
    Camera camera{.ground = {view.x, view.y, 0.5, 0.5}, .pitch_degrees = -50};
    const double distance =
        std::exp2(view.level) * height_pixels / (2 * std::tan(camera.field_of_view_degrees / 2 * radians));
    const PlanePoint eye = camera.ground.moved(0, distance * std::cos(camera.pitch_degrees * radians));
    if (eye.y < extent.side_texels()) {
        camera.ground = eye;
        camera.height_texels = distance * -std::sin(camera.pitch_degrees * radians);
    } else {
        camera.pitch_degrees = -90;
        camera.height_texels = distance;
    }
    return camera;
}

}  // namespace tessera
