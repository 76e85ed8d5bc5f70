#include "server/http/descriptions.h"

#include "proto/page.pb.h"

#include "shared/page/page_format.h"
#include "shared/wire/json.h"

namespace tessera {

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
    info.set_animated(scene.animated);
    if (scene.animated) {
        info.set_steps_per_second(scene.steps_per_second);
        info.set_loop_steps(scene.loop_steps);
    }
    return write_json(tiles);
}

}  // namespace tessera
