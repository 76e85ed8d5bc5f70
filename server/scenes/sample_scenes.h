#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/prepare/recorded.h"
#include "server/progress/progress.h"
#include "server/scene/image_file.h"
#include "shared/page/opening_view.h"
#include "shared/result/result.h"

namespace tessera {

/// A scene that ships with Tessera.
struct Sample {
    enum class Source { painting, photograph, constant, checker, patterns, moving };
    std::string_view name;  ///< The scene's id.
    std::string_view title;
    std::string_view attribution;
    Source source = Source::photograph;
    ExchangeMethod method = ExchangeMethod::content_exchange;  ///< Of what is made of an image.
    std::optional<OpeningView> view{};  ///< Of a painted one; empty: the middle at level 1 is a good place.
};

const std::vector<Sample>& all_samples();

/// Null if there is none of that name.
const Sample* find_sample(std::string_view name);

/// Where a sample's photograph is in the cache folder that fetch_photos.sh fills.
std::filesystem::path photo_of(const Sample& sample, const std::filesystem::path& photos);

/// What became of a scene folder.
enum class Made { kept, written };

/// Makes `folder`/NAME, unless a scene that loads is there already and `force` is not set. An asset that
/// another version prepared is prepared again; the scene file stays as it is, and so do contents that a
/// person pinned or dropped. Errors: io_failure, invalid_input, cancelled; the message names the file.
Result<Made> make_sample(const Sample& sample, const std::filesystem::path& folder,
                         const std::filesystem::path& photos, bool force, Progress& progress);

struct PhotoScene {
    std::string id;
    Made made = Made::kept;
};

struct PhotoSceneOptions {
    PrepareOptions prepare;
    ImageLimits limits;
    bool force = false;
};

/// Makes a scene of a person's own photograph in `folder`. A picture that has a scene of the method there
/// keeps it, as make_sample() does, unless `force` is set; a new one is put where nothing is: in
/// scene_id_of(photo), with the method behind it if that is not content exchange, or with a number; never
/// under a sample's name. Errors as above, and invalid_input if the picture's scene does not load.
Result<PhotoScene> make_photo_scene(const std::filesystem::path& photo, const std::filesystem::path& folder,
                                    const PhotoSceneOptions& options, Progress& progress);

}  // namespace tessera
