#include "server/scenes/sample_scenes.h"

#include <algorithm>
#include <optional>

#include "proto/scene.pb.h"

#include "server/scene/asset_file.h"
#include "server/scene/scene.h"
#include "server/scenes/moving_scenes.h"
#include "server/scenes/paint_pebbles.h"
#include "server/scenes/painted_folder.h"
#include "server/scenes/pattern_scenes.h"
#include "server/scenes/scene_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::int32_t painting_side = 1024;
constexpr std::uint64_t painting_seed = 1;
constexpr int most_of_one_name = 99;

/// The photograph's own name, where it is a text that Protobuf takes, with what the id adds to it.
std::string title_of(const fs::path& photo, const std::string& id) {
    const std::string name = photo.stem().string(), plain = scene_id_of(photo);
    proto::Scene scene, read;
    scene.set_title(name);
    const bool is_text =
        std::ranges::none_of(name, [](char c) { return static_cast<unsigned char>(c) < 0x20; }) &&
        read.ParseFromString(scene.SerializeAsString());
    return is_text && id.starts_with(plain) ? name + id.substr(plain.size()) : id;
}

proto::Scene described(std::string_view title, std::string_view attribution) {
    proto::Scene scene;
    scene.set_title(std::string{title});
    scene.set_attribution(std::string{attribution});
    return scene;
}

/// What a scene is made of.
struct Picture {
    Rgb8Image exemplar;
    std::vector<AlignedImage> aligned;
};

Picture paint(Progress& progress) {
    progress.advance("painting", 0);
    PaintedSurface painted = paint_pebble_surface(painting_side, painting_seed, progress.stop());
    progress.advance("painting", 1);
    return {std::move(painted.color),
            {{"normal", std::move(painted.normal)},
             {"roughness", std::move(painted.roughness)},
             {"height", std::move(painted.height)}}};
}

Result<Picture> read_picture(const fs::path& photo, const ImageLimits& limits) {
    auto exemplar = read_rgb_image(photo, limits);
    if (!exemplar) return exemplar.error();
    return Picture{std::move(*exemplar), {}};
}

proto::Exchange& exchange_of(proto::Scene& scene, ExchangeMethod method) {
    switch (method) {
        case ExchangeMethod::interchange:
            return *scene.mutable_interchange();
        case ExchangeMethod::wang:
            return *scene.mutable_wang();
        case ExchangeMethod::content_exchange:
            break;
    }
    return *scene.mutable_content_exchange();
}

/// `before`: the scene's folder if only its asset is to be renewed, as it was asked for then. `where` names
/// the exemplar in messages.
Result<RecordedAsset> prepare(Picture picture, const std::string& where, PrepareOptions options,
                              const fs::path* before, Progress& progress) {
    std::optional<ExchangeAsset> judged;
    if (before != nullptr)
        if (auto earlier = read_earlier(*before / asset_folder_name, picture.exemplar)) {
            if (earlier->is_judged()) judged = std::move(earlier->asset);
            options = std::move(earlier->options);
            if (picture.aligned.empty()) picture.aligned = std::move(earlier->aligned);
        }
    auto prepared =
        prepare_recorded(picture.exemplar, picture.aligned, options, judged ? &*judged : nullptr, progress);
    if (!prepared) return Error{prepared.error().code, where + ": " + prepared.error().detail};
    return prepared;
}

/// Writes the scene; or, where one is to be kept, nothing but its asset.
Result<void> write(const RecordedAsset& made, proto::Scene scene, const fs::path& folder, bool keep_scene,
                   Progress& progress) {
    progress.advance("writing", 0);
    Result<void> written;
    if (keep_scene) {
        written = write_exchange_asset(folder / asset_folder_name, made.asset, made.preparation);
    } else {
        proto::Exchange& exchange = exchange_of(scene, made.asset.method);
        exchange.set_asset(asset_folder_name);
        exchange.set_seed(made.preparation.seed);
        written = write_scene_folder(folder, scene, &made);
    }
    progress.advance("writing", 1);
    if (!written) return written;
    // What a server would refuse is said by who made it, not by who serves it
    if (const auto loaded = load_scene(folder); !loaded) return loaded.error();
    return {};
}

/// Whether the folder holds a scene whose asset this version would prepare otherwise.
bool is_outdated(const fs::path& folder) {
    const auto made = preparation_of(folder);
    return made && made->version != prepare_version;
}

/// The scene in `folder` that was made of this very picture by this method, among those that its name leads
/// to; else empty.
std::string id_of_picture(const Rgb8Image& picture, ExchangeMethod method, const fs::path& folder,
                          const std::string& name) {
    for (int number = 1; number <= most_of_one_name; ++number)
        if (const std::string id = numbered_id(name, number);
            find_sample(id) == nullptr && was_made_of(folder / id, picture, method))
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
    if (auto written = write_scene_folder(folder, scene, nullptr); !written) return written.error();
    return Made::written;
}

/// The pebbles' asset: that of the sample beside it, if it is there as this version prepares it; else made.
Result<void> add_pebbles(const fs::path& inside, const fs::path& sample, Progress& progress) {
    if (holds_valid_scene(sample) && !is_outdated(sample) && preparation_of(sample)) {
        std::error_code failure;
        fs::copy(sample / asset_folder_name, inside / asset_folder_name, fs::copy_options::recursive,
                 failure);
        if (!failure) return {};
        fs::remove_all(inside / asset_folder_name, failure);
    }
    const auto made = prepare(paint(progress), "pebbles", {}, nullptr, progress);
    if (!made) return made.error();
    return write_exchange_asset(inside / asset_folder_name, made->asset, made->preparation);
}

Result<Made> make_painted(const Sample& sample, const fs::path& folder, bool force, Progress& progress) {
    const fs::path target = folder / sample.name;
    if (!force && standing_of(target) == Standing::current) return Made::kept;
    progress.advance("painting", 0);
    PaintedScene painted = sample.source == Sample::Source::moving ? paint_moving_scene(sample.name)
                                                                   : paint_pattern_scene(sample.name);
    progress.advance("painting", 1);
    painted.scene.MergeFrom(described(sample.title, sample.attribution));
    if (sample.view) {
        proto::OpeningView& view = *painted.scene.mutable_view();
        view.set_x(sample.view->x);
        view.set_y(sample.view->y);
        view.set_level(sample.view->level);
    }
    const auto written = write_painted_folder(target, painted, [&](const fs::path& inside) {
        return add_pebbles(inside, folder / "pebbles", progress);
    });
    if (!written) return written.error();
    return Made::written;
}

}  // namespace

const std::vector<Sample>& all_samples() {
    using enum Sample::Source;
    constexpr std::string_view gallery = "Photograph from LibreOffice's gallery, as packaged by Debian";
    constexpr std::string_view painted = "Painted by Tessera";
    constexpr auto no_image = ExchangeMethod::content_exchange;
    static const std::vector<Sample> samples{
        {"pebbles", "Pebbles", painted, painting},
        {"pebbles-interchange", "Pebbles, interchangeable patches", painted, painting,
         ExchangeMethod::interchange},
        {"pebbles-wang", "Pebbles, corner-coloured tiles", painted, painting, ExchangeMethod::wang},
        {"coffee", "Coffee beans", gallery, photograph},
        {"stones", "Stones", gallery, photograph},
        {"maple-leaves", "Maple leaves", gallery, photograph},
        {"leaf", "Leaves", gallery, photograph},
        {"tiles", "Meadow: sixteen tiles in no order", painted, patterns},
        {"meadow-sand", "Meadow and sand, with borders", painted, patterns, no_image,
         OpeningView{134218328, 134217428, 1}},
        {"leaves", "Red leaves on moss", painted, patterns, no_image, OpeningView{134217728, 134217728, 0}},
        {"autumn", "A lawn in autumn", painted, patterns},
        {"terrain", "Land: sand, forest, rock and snow", painted, patterns, no_image,
         OpeningView{815000000, 597688320, 18.5}},
        {"petals", "Cherry petals on pebbles", painted, patterns, no_image,
         OpeningView{134217728, 134217728, 0}},
        {"grove", "A grove in slices", painted, patterns, no_image, OpeningView{134217728, 134217728, 0}},
        {"message-board", "A message board of 12288 × 1536 LEDs", painted, moving, no_image,
         OpeningView{131072, 131072, 6}},
        {"fireflies", "Fireflies over pebbles", painted, moving},
        {"windfall", "Leaves on pebbles, to be moved by hand", painted, moving},
        {"flower-field", "Flowers that open near three balls", painted, moving, no_image,
         OpeningView{131072, 131072, 2}},
        {"road", "Footprints and signs on a road", painted, moving},
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
    if (sample.source == Sample::Source::patterns || sample.source == Sample::Source::moving)
        return make_painted(sample, folder, force, progress);
    const fs::path target = folder / sample.name;
    const bool keep_scene = !force && holds_valid_scene(target);
    if (keep_scene && !is_outdated(target)) return Made::kept;
    proto::Scene scene = described(sample.title, sample.attribution);
    if (sample.source == Sample::Source::constant || sample.source == Sample::Source::checker)
        return make_pattern(std::move(scene), sample.source, target);

    // What is outdated is better than nothing
    const fs::path photo = photo_of(sample, photos);
    const bool is_painted = sample.source == Sample::Source::painting;
    if (std::error_code failure; keep_scene && !is_painted && !fs::exists(photo, failure)) return Made::kept;
    Result<Picture> picture =
        is_painted ? Result<Picture>{paint(progress)} : read_picture(photo, ImageLimits{});
    if (!picture) return picture.error();
    PrepareOptions options;
    options.method = sample.method;
    const auto made = prepare(std::move(*picture), is_painted ? std::string{sample.name} : photo.string(),
                              options, keep_scene ? &target : nullptr, progress);
    if (!made) return made.error();
    if (auto done = write(*made, std::move(scene), target, keep_scene, progress); !done) return done.error();
    return Made::written;
}

Result<PhotoScene> make_photo_scene(const fs::path& photo, const fs::path& folder,
                                    const PhotoSceneOptions& options, Progress& progress) {
    auto picture = read_picture(photo, options.limits);
    if (!picture) return picture.error();
    const std::string name = scene_id_of(photo, options.prepare.method);
    std::string id = id_of_picture(picture->exemplar, options.prepare.method, folder, name);
    const fs::path there = folder / id;
    const bool keep_scene = !id.empty() && !options.force;
    if (keep_scene) {
        if (const auto scene = load_scene(there); !scene)
            return Error{scene.error().code,
                         scene.error().detail + "; mend it, or make it again: tessera scene --force"};
        if (!is_outdated(there)) return PhotoScene{id, Made::kept};
    }
    const auto made = prepare(std::move(*picture), photo.string(), options.prepare,
                              keep_scene ? &there : nullptr, progress);
    if (!made) return made.error();
    // Only now, since a name may have been taken during the minutes of preparation
    if (id.empty()) id = free_id(folder, name);
    if (id.empty())
        return Error{ErrorCode::invalid_input, (folder / name).string() + ": is there, and so are " +
                                                   std::to_string(most_of_one_name) +
                                                   " of that name; rename the photograph"};
    if (auto done = write(*made, described(title_of(photo, id), ""), folder / id, keep_scene, progress);
        !done)
        return done.error();
    return PhotoScene{id, Made::written};
}

}  // namespace tessera
