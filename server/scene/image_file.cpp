#include "server/scene/image_file.h"

namespace tessera {

Result<Rgb8Image> read_rgb_image(const std::filesystem::path& file, const ImageLimits&) {
    return Error{ErrorCode::io_failure, file.string() + ": cannot be read"};
}

}  // namespace tessera
