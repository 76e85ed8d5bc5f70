#include "server/accuracy/exported_textures.h"

#include <algorithm>

#include "server/scene/image_file.h"
#include "server/texture/texture.h"

namespace tessera {

Result<void> export_textures(const AccuracyOptions& options, const std::filesystem::path& folder,
                             Progress& progress) {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure) return Error{ErrorCode::io_failure, folder.string() + ": " + failure.message()};
    AccuracyOptions stored = options;
    if (stored.textures.empty()) stored.textures = {"photograph", "checker", "text"};
    const auto textures = measured_textures(stored, folder, progress);
    if (!textures) return textures.error();
    for (const MeasuredTexture& texture : *textures) {
        if (!texture.image) continue;
        const bool opaque = [&] {
            for (std::size_t i = 3; i < texture.image->values.size(); i += 4)
                if (texture.image->values[i] < 1) return false;
            return true;
        }();
        if (!opaque)
            return Error{ErrorCode::invalid_input,
                         texture.name + ": is transparent; only opaque images are exported"};
        Rgba8Image coded(texture.image->width, texture.image->height);
        encode(*texture.image, coded);
        Rgb8Image image;
        image.width = coded.width;
        image.height = coded.height;
        for (std::size_t i = 0; i < coded.bytes.size(); ++i)
            if (i % 4 != 3) image.bytes.push_back(coded.bytes[i]);
        if (auto written = write_rgb_png(folder / (texture.name + ".png"), image); !written) return written;
    }
    return {};
}

}  // namespace tessera
