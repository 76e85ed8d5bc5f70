#include <algorithm>
#include <charconv>

#include "proto/sprite.pb.h"

#include "server/http/routes.h"
#include "server/scene/sprite_views.h"
#include "server/sprites/sprite_images.h"
#include "shared/wire/json.h"
#include "shared/wire/sprite_message.h"

namespace tessera {

namespace http = boost::beast::http;

namespace {

constexpr std::size_t most_listed = 4096;
constexpr std::size_t most_lifted = 64;
constexpr std::int64_t farthest_texel = std::int64_t{1} << 48;  // beyond every extent
constexpr std::string_view lifted_prefix = "without-";

template <class Integer>
std::optional<Integer> integer(std::string_view text) {
    Integer value{};
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// x0, y0, x1 and y1, each once, in any order.
std::optional<TexelBox> box_of_query(std::string_view query) {
    TexelBox box{};
    unsigned seen = 0;
    while (!query.empty()) {
        const std::size_t end = std::min(query.find('&'), query.size());
        const std::string_view item = query.substr(0, end);
        query.remove_prefix(std::min(end + 1, query.size()));
        constexpr std::string_view names[] = {"x0=", "y0=", "x1=", "y1="};
        std::int64_t* const values[] = {&box.x0, &box.y0, &box.x1, &box.y1};
        std::size_t which = 0;
        while (which < 4 && !item.starts_with(names[which])) ++which;
        if (which == 4 || (seen & 1U << which) != 0) return std::nullopt;
        const auto value = integer<std::int64_t>(item.substr(3));
        if (!value || *value < -farthest_texel || *value > farthest_texel) return std::nullopt;
        *values[which] = *value;
        seen |= 1U << which;
    }
    if (seen != 15 || box.x0 >= box.x1 || box.y0 >= box.y1) return std::nullopt;
    return box;
}

/// "without-12,15"
std::optional<std::vector<SpriteId>> lifted_ids(std::string_view segment) {
    segment.remove_prefix(lifted_prefix.size());
    std::vector<SpriteId> ids;
    for (bool more = true; more;) {
        const std::size_t end = segment.find(',');
        more = end != std::string_view::npos;
        const auto id = integer<SpriteId>(segment.substr(0, end));
        if (!id || ids.size() == most_lifted) return std::nullopt;
        ids.push_back(*id);
        if (more) segment.remove_prefix(end + 1);
    }
    return ids;
}

/// A site of one scene, as it is to be shown once.
Site site_of(ScenePtr scene) {
    auto catalog = std::make_shared<Catalog>();
    catalog->scenes.emplace(scene->id, std::move(scene));
    Site site;
    site.catalog = std::move(catalog);
    return site;
}

Refusal without_sprites(const Scene& scene) {
    return {404, "scene \"" + scene.id + "\" has no sprites", false};
}

}  // namespace

bool Routes::is_sprite_address(const std::vector<std::string>& segments) noexcept {
    if (segments.front() != "scenes") return false;
    return (segments.size() == 3 && segments[2] == "sprites") ||
           (segments.size() == 4 && segments[2] == "patterns") ||
           (segments.size() == 6 && segments[2].starts_with(lifted_prefix));
}

Routes::Outcome Routes::sprites(const RequestHead& request, const ScenePtr& scene,
                                std::vector<std::string> segments) {
    if (!scene->sprite_images) return refusal_answer(without_sprites(*scene));
    if (segments.size() == 3) return sprite_list(request, *scene);
    if (segments.size() == 4) {
        const std::string_view name = segments[3];
        const auto pattern =
            name.ends_with(".png") ? integer<std::int32_t>(name.substr(0, name.size() - 4)) : std::nullopt;
        if (!pattern || *pattern < 0 || *pattern >= scene->sprite_images->count())
            return refusal_answer({404,
                                   "patterns of this scene's sprites are 0.png to " +
                                       std::to_string(scene->sprite_images->count() - 1) + ".png",
                                   false});
        return page(request, site_of(pattern_scene(*scene, *pattern)),
                    {"scenes", scene->id, "0", "0", "0.png"});
    }
    const auto lifted = lifted_ids(segments[2]);
    if (!lifted)
        return refusal_answer(
            {400,
             "a page without some sprites is /scenes/{id}/without-{sprite},{sprite}/…, with "
             "at most " +
                 std::to_string(most_lifted) + " ids",
             false});
    segments.erase(segments.begin() + 2);
    const auto address = page_address(segments);
    if (!address) return refusal_answer(address.error());
    const std::uint8_t n = scene->extent.n;
    const std::uint64_t side = address->z <= n ? std::uint64_t{1} << address->z : 0;
    // What lies outside is refused as any such page is
    if (address->x >= side || address->y >= side) return page(request, site_of(scene), segments);
    const PageKey key{static_cast<std::uint8_t>(n - address->z), static_cast<std::uint32_t>(address->x),
                      static_cast<std::uint32_t>(address->y)};
    return page(request, site_of(scene_without(scene, *lifted, key)), segments);
}

Answer Routes::sprite_list(const RequestHead& request, const Scene& scene) {
    const auto box = box_of_query(request.query);
    if (!box)
        return refusal_answer(
            {400,
             "sprites are listed for a box of texels: ?x0=0&y0=0&x1=1024&y1=1024, integers, "
             "each once, x0 below x1 and y0 below y1",
             false});
    std::vector<Sprite> met = scene.sprites.some_meeting(*box, most_listed + 1);
    proto::SpriteList list;
    list.set_revision(scene.revision);
    list.set_more(met.size() > most_listed);
    if (list.more()) met.pop_back();
    for (const Sprite& sprite : met) write_sprite(sprite, *list.add_sprites());
    return text_answer(200, "application/json", write_brief_json(list), "Cache-Control: no-store\r\n");
}

}  // namespace tessera
