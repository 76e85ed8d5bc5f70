#include "server/http/descriptions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "proto/page.pb.h"

#include "shared/page/page_format.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

proto::OpeningView message_of(const OpeningView& view) {
    proto::OpeningView message;
    message.set_x(view.x);
    message.set_y(view.y);
    message.set_level(view.level);
    return message;
}

/// The view's middle on the square world of web maps (EPSG:3857), and the zoom whose texels are nearest to
/// its level.
void set_center(const OpeningView& view, Extent extent, proto::TileJson& tiles) {
    constexpr double pi = std::numbers::pi;
    const auto side = static_cast<double>(extent.side_texels());
    const double level = std::clamp(std::round(view.level), 0.0, static_cast<double>(extent.n));
    tiles.add_center(static_cast<double>(view.x) / side * 360 - 180);
    tiles.add_center(std::atan(std::sinh(pi * (1 - 2 * static_cast<double>(view.y) / side))) * 180 / pi);
    tiles.add_center(extent.n - level);
}

}  // namespace

std::string describe_scenes(const Catalog& catalog) {
    proto::SceneList list;
    for (const auto& [id, scene] : catalog.scenes) {
        proto::SceneSummary& summary = *list.add_scenes();
        summary.set_id(id);
        summary.set_title(scene->title);
        summary.set_attribution(scene->attribution);
        summary.set_tilejson("/scenes/" + id);
        summary.set_texture(std::string{scene->texture->kind()});
        summary.set_extent_log2_pages(scene->extent.n);
        if (scene->view) *summary.mutable_view() = message_of(*scene->view);
    }
    for (const Catalog::Problem& problem : catalog.broken) {
        proto::BrokenScene& broken = *list.add_broken();
        broken.set_id(problem.id);
        broken.set_problem(problem.message);
    }
    return write_json(list);
}

std::string describe_tiles(const Scene& scene, std::string_view origin) {
    const std::string base = std::string{origin} + "/scenes/" + scene.id;
    proto::TileJson tiles;
    tiles.set_tilejson("3.0.0");
    tiles.set_name(scene.title);
    tiles.set_attribution(scene.attribution);
    tiles.set_scheme("xyz");
    tiles.add_tiles(base + "/{z}/{x}/{y}.png");
    tiles.set_minzoom(0);
    tiles.set_maxzoom(scene.extent.n);
    for (const double degrees : {-180.0, -85.05112877980659, 180.0, 85.05112877980659})
        tiles.add_bounds(degrees);
    const std::int64_t middle = scene.extent.side_texels() / 2;
    set_center(scene.view.value_or(OpeningView{middle, middle}), scene.extent, tiles);

    proto::TextureInfo& info = *tiles.mutable_tessera();
    info.set_id(scene.id);
    info.set_extent_log2_pages(scene.extent.n);
    info.set_page_side(page_side_texels);
    info.set_max_gutter(max_gutter_texels);
    info.set_revision(scene.revision);
    info.set_fingerprint(scene.fingerprint);
    for (const PageFormat format : page_formats) info.add_formats(std::string{extension(format)});
    info.set_page_url("/scenes/" + scene.id + "/r" + std::to_string(scene.revision) + "-" +
                      scene.fingerprint + "/{z}/{x}/{y}");
    info.set_texture(std::string{scene.texture->kind()});
    info.add_channels(std::string{name_of(ChannelSet::albedo)});
    for (const Channels& channels : scene.channels) info.add_channels(std::string{name_of(channels.set)});
    info.set_slices(static_cast<std::uint32_t>(scene.slices));
    info.set_stream("/scenes/" + scene.id + "/stream");
    if (scene.view) *info.mutable_view() = message_of(*scene.view);
    info.set_animated(scene.animated);
    if (scene.animated) {
        info.set_steps_per_second(scene.steps_per_second);
        info.set_loop_steps(scene.loop_steps);
    }
    return write_json(tiles);
}

}  // namespace tessera
