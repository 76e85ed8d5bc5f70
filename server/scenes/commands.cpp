#include "server/scenes/commands.h"

#include <cerrno>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "server/files/whole_file.h"
#include "server/pages/page_encoder.h"
#include "server/prepare/photo_options.h"
#include "server/progress/interrupt.h"
#include "server/progress/terminal_progress.h"
#include "server/scene/scene.h"
#include "server/scenes/pattern_pictures.h"
#include "server/scenes/sample_scenes.h"
#include "server/scenes/scene_folder.h"

namespace tessera {
namespace {

struct Arguments {
    std::string photo;
    std::string folder;
    std::string photos;
    std::vector<std::string> only;
    PhotoSceneOptions scene;
    std::int64_t max_megapixels = default_megapixels;
    std::string picture;
    std::int32_t cell = 200;
    bool force = false;
    bool quiet = false;
};

/// Painting and writing round a method's own stages.
std::vector<TerminalProgress::Share> shares_of(ExchangeMethod method) {
    std::vector<TerminalProgress::Share> shares{{"painting", 0.1}};
    for (const auto& [stage, part] : prepare_shares(method)) shares.push_back({stage, 0.85 * part});
    shares.push_back({"writing", 0.05});
    return shares;
}

/// Runs `work` under a progress bar; its error, if any, is said.
template <typename T>
Result<T> run(const char* command, const std::string& what, ExchangeMethod method, const Arguments& arguments,
              const Interrupt& interrupt, const std::function<Result<T>(Progress&)>& work) {
    auto made = [&] {
        TerminalProgress progress{"tessera " + std::string{command} + ": " + what, shares_of(method),
                                  arguments.quiet, interrupt.token()};
        return work(progress);
    }();
    if (!made) std::fprintf(stderr, "tessera %s: %s\n", command, made.error().detail.c_str());
    return made;
}

void say_made(const char* command, const std::string& id, Made made, const Arguments& arguments,
              const std::string& more = {}) {
    if (!arguments.quiet)
        std::fprintf(stderr, "tessera %s: %s/%s: %s%s\n", command, arguments.folder.c_str(), id.c_str(),
                     made == Made::kept ? "is there already" : "done", more.c_str());
}

/// Before minutes of preparation, since it is cheap to ask.
bool can_be_written(const char* command, const std::string& folder) {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (!failure && access(folder.c_str(), W_OK) != 0) failure.assign(errno, std::generic_category());
    if (failure)
        std::fprintf(stderr, "tessera %s: %s: %s; choose a folder that can be written with -o\n", command,
                     folder.c_str(), failure.message().c_str());
    return !failure;
}

/// The samples asked for, or those that can be made; null after an error.
std::unique_ptr<std::vector<Sample>> choose(const Arguments& arguments) {
    auto chosen = std::make_unique<std::vector<Sample>>();
    for (const std::string& name : arguments.only) {
        const Sample* sample = find_sample(name);
        if (sample == nullptr) {
            std::string names;
            for (const Sample& known : all_samples()) names += " " + std::string{known.name};
            std::fprintf(stderr, "tessera samples: --only %s: no such sample; there are%s\n", name.c_str(),
                         names.c_str());
            return nullptr;
        }
        chosen->push_back(*sample);
    }
    if (!chosen->empty()) return chosen;
    for (const Sample& sample : all_samples())
        if (sample.source != Sample::Source::photograph ||
            std::filesystem::exists(photo_of(sample, arguments.photos)))
            chosen->push_back(sample);
    return chosen;
}

int run_samples(const Arguments& arguments) {
    const Interrupt interrupt;
    const auto chosen = choose(arguments);
    if (chosen == nullptr || !can_be_written("samples", arguments.folder)) return 1;
    // One bad photograph does not stop the others
    bool good = true;
    for (const Sample& sample : *chosen) {
        if (interrupt.token().stop_requested()) return 1;
        const std::string name{sample.name};
        const auto made =
            run<Made>("samples", name, sample.method, arguments, interrupt, [&](Progress& progress) {
                return make_sample(sample, arguments.folder, arguments.photos, arguments.force, progress);
            });
        if (made) say_made("samples", name, *made, arguments);
        good &= made.has_value();
    }
    return good ? 0 : 1;
}

Result<void> draw_picture(const Arguments& arguments, std::stop_token stop) {
    std::vector<ScenePtr> scenes;
    std::vector<const Texture*> textures;
    for (const View& view : pattern_views()) {
        if (scenes.empty() || scenes.back()->id != view.scene) {
            auto scene = load_scene(std::filesystem::path{arguments.folder} / view.scene);
            if (!scene)
                return Error{scene.error().code,
                             scene.error().detail + "; make it with tessera samples -o " + arguments.folder};
            scenes.push_back(std::move(*scene));
        }
        textures.push_back(scenes.back()->texture.get());
    }
    const auto sheet = draw_pattern_views(textures, arguments.cell, stop);
    if (!sheet) return sheet.error();
    const std::string ending = std::filesystem::path{arguments.picture}.extension().string();
    const auto format = page_format(std::string_view{ending}.substr(ending.empty() ? 0 : 1));
    if (!format)
        return Error{ErrorCode::invalid_input, arguments.picture + ": end it in .jpg, .png or .webp"};
    const auto bytes = encode_page(*sheet, *format);
    if (!bytes) return bytes.error();
    return write_whole_file(arguments.picture, *bytes);
}

int run_picture(const Arguments& arguments) {
    const Interrupt interrupt;
    const auto drawn = draw_picture(arguments, interrupt.token());
    if (!drawn) std::fprintf(stderr, "tessera pattern-picture: %s\n", drawn.error().detail.c_str());
    return drawn ? 0 : 1;
}

int run_scene(Arguments arguments) {
    const Interrupt interrupt;
    if (!can_be_written("scene", arguments.folder)) return 1;
    PhotoSceneOptions& options = arguments.scene;
    options.limits = photo_limits(arguments.max_megapixels);
    options.force = arguments.force;
    const std::string name = scene_id_of(arguments.photo, options.prepare.method);
    const auto scene =
        run<PhotoScene>("scene", name, options.prepare.method, arguments, interrupt, [&](Progress& progress) {
            return make_photo_scene(arguments.photo, arguments.folder, options, progress);
        });
    if (!scene) return 1;
    const char* whose =
        find_sample(name) == nullptr ? " was not made of this picture" : " is a sample's name";
    say_made("scene", scene->id, scene->made, arguments, scene->id == name ? "" : "; " + name + whose);
    std::printf("%s\n", scene->id.c_str());
    return 0;
}

}  // namespace

void add_scenes_command(CLI::App& app, int& exit_code) {
    const auto arguments = std::make_shared<Arguments>();
    const auto add_common = [&arguments](CLI::App& command) {
        command.add_option("-o,--output", arguments->folder, "Folder of scenes to put it into")->required();
        command.add_flag("--force", arguments->force, "Make again what is there already");
        command.add_flag("-q,--quiet", arguments->quiet, "No progress, only errors");
    };

    CLI::App& samples = *app.add_subcommand("samples", "Makes the folder of sample scenes");
    add_common(samples);
    samples.add_option("--photos", arguments->photos,
                       "Folder with coffee.jpg, stones.jpg, maple-leaves.jpg, leaf.jpg (fetch_photos.sh); "
                       "those that are missing are left out");
    samples.add_option("--only", arguments->only, "Make only the sample of this name; may be repeated");
    samples.callback([arguments, &exit_code] { exit_code = run_samples(*arguments); });

    CLI::App& picture =
        *app.add_subcommand("pattern-picture", "Draws the samples of pattern blocks, each at three levels");
    picture.add_option("SCENES", arguments->folder, "Folder that tessera samples made")->required();
    picture.add_option("-o,--output", arguments->picture, "Picture to write: .jpg, .png or .webp")
        ->required();
    picture.add_option("--side", arguments->cell, "Of each view, in texels")->check(CLI::Range(32, 1024));
    picture.callback([arguments, &exit_code] { exit_code = run_picture(*arguments); });

    CLI::App& scene = *app.add_subcommand(
        "scene",
        "Makes a scene of a photograph, named after the file, with a number behind it if another picture "
        "has that name; prints the scene's id");
    scene.add_option("PHOTO", arguments->photo, "PNG, JPEG, WebP or TIFF")->required();
    add_method_option(scene, arguments->scene.prepare.method);
    add_megapixels_option(scene, arguments->max_megapixels);
    add_common(scene);
    scene.callback([arguments, &exit_code] { exit_code = run_scene(*arguments); });
}

}  // namespace tessera
