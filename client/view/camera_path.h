#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "client/residency/camera.h"
#include "shared/page/opening_view.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

/// A camera that moves through keys; see view.proto.
class CameraPath {
  public:
    struct Key {
        double seconds = 0;
        Camera camera{};
    };

    /// Error: invalid_input, naming file, key and field.
    static Result<CameraPath> read(const std::filesystem::path& file, Extent extent);
    static Result<CameraPath> parse(std::string_view json, std::string_view where, Extent extent);
    /// A camera that stands still.
    explicit CameraPath(const Camera& camera) : keys_{{0, camera}} {}

    double begin_seconds() const { return keys_.front().seconds; }
    double end_seconds() const { return keys_.back().seconds; }
    /// The first key's camera before it, the last one's after it.
    Camera at(double seconds) const;

  private:
    explicit CameraPath(std::vector<Key> keys) : keys_{std::move(keys)} {}
    std::vector<Key> keys_;  ///< At least one
};

/// The camera as one line of a camera path.
std::string camera_key_json(double seconds, const Camera& camera);

/// Above the middle of the virtual texture, looking down at a slant: where a visit begins.
Camera first_camera(Extent extent);

/// Looks north at the view's middle, down at a slant, or straight down where an eye at a slant would lie
/// outside: in the middle of a picture `height_pixels` high, a pixel is as many texels wide as the view says.
Camera first_camera(const OpeningView& view, Extent extent, double height_pixels);

}  // namespace tessera
