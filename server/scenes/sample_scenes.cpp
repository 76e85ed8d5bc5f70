#include "server/scenes/sample_scenes.h"

#include <algorithm>

#include "proto/scene.pb.h"

#include "server/prepare/prepare.h"
#include "server/scene/image_file.h"
#include "server/scene/scene.h"
#include "server/scenes/paint_pebbles.h"
#include "server/scenes/scene_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::int32_t painting_side = 1024;
constexpr std::uint64_t painting_seed = 1;
constexpr int most_of_one_name = 99;

proto::Scene described(std::string_view title, std::string_view attribution) {
    proto::Scene scene;
    scene.set_title(std::string{title});
    scene.set_attribution(std::string{attribution});
    return scene;
}

/// `where` names the exemplar in messages.
Result<ExchangeAsset> prepare(const Rgb8Image& exemplar, const std::string& where, Progress& progress) {
    auto prepared = prepare_exchange(exemplar, {}, nullptr, progress);
    if (!prepared) return Error{prepared.error().code, where + ": " + prepared.error().detail};
    return std::move(prepared->asset);
}

Result<Made> write_content_exchange_scene(const ExchangeAsset& asset, proto::Scene scene,
                                          const fs::path& folder, Progress& progress) {
    progress.advance("writing", 0);
    const std::uint64_t seed = PrepareOptions{}.seed;
    scene.mutable_content_exchange()->set_asset(asset_folder_name);
    scene.mutable_content_exchange()->set_seed(seed);
    if (auto written = write_scene_folder(folder, scene, &asset, seed); !written) return written.error();
    progress.advance("writing", 1);
    return Made::written;
}

Result<Made> make_of_photo(const fs::path& photo, proto::Scene scene, const fs::path& folder,
                           Progress& progress) {
    const auto exemplar = read_rgb_image(photo);
    if (!exemplar) return exemplar.error();
    const auto asset = prepare(*exemplar, photo.string(), progress);
    if (!asset) return asset.error();
    return write_content_exchange_scene(*asset, std::move(scene), folder, progress);
}

Result<Made> make_of_painting(proto::Scene scene, const fs::path& folder, Progress& progress) {
    progress.advance("painting", 0);
    const Rgb8Image exemplar = paint_pebbles(painting_side, painting_seed);
    progress.advance("painting", 1);
    const auto asset = prepare(exemplar, "pebbles", progress);
    if (!asset) return asset.error();
    return write_content_exchange_scene(*asset, std::move(scene), folder, progress);
}

/// The scene in `folder` that was made of this very picture, among those that its name leads to; else empty.
std::string id_of_picture(const Rgb8Image& picture, const fs::path& folder, const std::string& name) {
    for (int number = 1; number <= most_of_one_name; ++number)
        if (const std::string id = numbered_id(name, number);
            find_sample(id) == nullptr && was_made_of(folder / id, picture))
            return id;
    return {};
}

/// The first id for `name` that is no sample's and under which there is nothing; empty if all are taken.
std::string free_id(const fs::path& folder, const std::string& name) {
    for (int number = 1; number <= most_of_one_name; ++number)
        if (std::error_code failure;
            find_sample(numbered_id(name, number)) == nullptr &&
            !fs::exists(fs::symlink_status(folder / numbered_id(name, number), failure)))
            return numbered_id(name, number);
    return {};
}

Result<Made> make_pattern(proto::Scene scene, Sample::Source source, const fs::path& folder) {
    if (source == Sample::Source::constant) {
        proto::Color& color = *scene.mutable_constant()->mutable_color();
        color.set_red(188);  // half of white's light, and two codes that no rounding confuses
        color.set_green(120);
        color.set_blue(57);
    } else {
        scene.mutable_checker()->set_cell_texels(32);
    }
    if (auto written = write_scene_folder(folder, scene, nullptr, 0); !written) return written.error();
    return Made::written;
}

}  // namespace

const std::vector<Sample>& all_samples() {
    using enum Sample::Source;
    constexpr std::string_view gallery = "Photograph from LibreOffice's gallery, as packaged by Debian";
    static const std::vector<Sample> samples{
        {"pebbles", "Pebbles", "Painted by Tessera", painting},
        {"coffee", "Coffee beans", gallery, photograph},
        {"stones", "Stones", gallery, photograph},
        {"maple-leaves", "Maple leaves", gallery, photograph},
        {"leaf", "Leaves", gallery, photograph},
        {"constant", "One colour", "", constant},
        {"checker", "Checkerboard", "", checker},
    };
    return samples;
}

const Sample* find_sample(std::string_view name) {
    const auto& samples = all_samples();
    const auto found = std::ranges::find(samples, name, &Sample::name);
    return found == samples.end() ? nullptr : &*found;
}

fs::path photo_of(const Sample& sample, const fs::path& photos) {
    return photos / (std::string{sample.name} + ".jpg");
}

Result<Made> make_sample(const Sample& sample, const fs::path& folder, const fs::path& photos, bool force,
                         Progress& progress) {
    const fs::path target = folder / sample.name;
    if (!force && holds_valid_scene(target)) return Made::kept;
    proto::Scene scene = described(sample.title, sample.attribution);
    if (sample.source == Sample::Source::photograph)
        return make_of_photo(photo_of(sample, photos), std::move(scene), target, progress);
    if (sample.source == Sample::Source::painting)
        return make_of_painting(std::move(scene), target, progress);
    return make_pattern(std::move(scene), sample.source, target);
}

Result<PhotoScene> make_photo_scene(const fs::path& photo, const fs::path& folder, bool force,
                                    Progress& progress) {
    const auto exemplar = read_rgb_image(photo);
    if (!exemplar) return exemplar.error();
    const std::string name = scene_id_of(photo);
    std::string id = id_of_picture(*exemplar, folder, name);
    if (!id.empty() && !force) {
        if (const auto scene = load_scene(folder / id); !scene)
            return Error{scene.error().code,
                         scene.error().detail + "; mend it, or make it again: tessera scene --force"};
        return PhotoScene{id, Made::kept};
    }
    const auto asset = prepare(*exemplar, photo.string(), progress);
    if (!asset) return asset.error();
    // Only now, since a name may have been taken during the minutes of preparation
    if (id.empty()) id = free_id(folder, name);
    if (id.empty())
        return Error{ErrorCode::invalid_input, (folder / name).string() + ": is there, and so are " +
                                                   std::to_string(most_of_one_name) +
                                                   " of that name; rename the photograph"};
    const auto made = write_content_exchange_scene(*asset, described(id, ""), folder / id, progress);
    if (!made) return made.error();
    return PhotoScene{id, *made};
}

}  // namespace tessera
