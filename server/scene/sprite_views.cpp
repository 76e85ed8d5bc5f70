#include "server/scene/sprite_views.h"

#include <algorithm>
#include <bit>
#include <cstdio>

#include "server/sprites/sprite_images.h"
#include "server/sprites/sprite_texture.h"
#include "server/texture/constant_texture.h"
#include "shared/math/hash.h"

namespace tessera {

namespace {

/// Of a page, among which the lifted ones are looked for.
constexpr std::size_t most_sprites = 4096;

std::string fingerprint_with(const std::string& base, std::uint64_t what) {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx",
                  static_cast<unsigned long long>(mix(stream(base) ^ mix(what))));
    return digits;
}

/// With its gutter, and what a texel more could see.
TexelBox box_around(PageKey page) {
    const std::int64_t texel = std::int64_t{1} << page.level, side = page_side_texels * texel,
                       margin = (max_gutter_texels + 1) * texel;
    return {page.x * side - margin, page.y * side - margin, (page.x + 1) * side + margin,
            (page.y + 1) * side + margin};
}

}  // namespace

ScenePtr scene_without(const ScenePtr& scene, const std::vector<SpriteId>& lifted, PageKey page) {
    const std::vector<Sprite> met = scene->sprites.some_meeting(box_around(page), most_sprites + 1);
    if (met.size() > most_sprites) return scene;
    PositioningMap left = scene->sprites;
    std::uint64_t what = stream("sprites that are lifted");
    for (const Sprite& sprite : met) {
        if (std::find(lifted.begin(), lifted.end(), sprite.id) == lifted.end()) continue;
        left.remove(sprite);
        what += mix(sprite.id);  // in whatever order
    }
    if (left.size() == scene->sprites.size()) return scene;
    auto view = std::make_shared<Scene>(*scene);
    view->fingerprint = fingerprint_with(scene->fingerprint, what);
    view->texture = make_sprite_texture(scene->ground, scene->sprite_images, left);
    view->sprites = std::move(left);
    return view;
}

ScenePtr pattern_scene(const Scene& scene, std::int32_t pattern) {
    const std::int32_t side = scene.sprite_images->side();
    Sprite sprite;
    sprite.id = 1;
    sprite.pattern = pattern;
    sprite.x = sprite.y = std::int64_t{side} * sprite_units / 2;
    sprite.side_texels = static_cast<std::uint16_t>(side);
    PositioningMap sprites;
    if (!sprites.place(sprite)) return nullptr;  // a pattern of the set always fits
    auto view = std::make_shared<Scene>();
    view->id = scene.id;
    view->title = scene.title;
    const auto pages = static_cast<unsigned>(std::max(1, side / page_side_texels));
    view->extent.n = static_cast<std::uint8_t>(std::bit_width(pages) - 1);
    view->fingerprint =
        fingerprint_with(scene.fingerprint, stream("pattern") + static_cast<std::uint64_t>(pattern));
    view->slices = scene.slices;
    view->ground = make_constant_texture({0, 0, 0, 0});
    view->sprite_images = scene.sprite_images;
    view->texture = make_sprite_texture(view->ground, view->sprite_images, sprites);
    view->sprites = std::move(sprites);
    return view;
}

}  // namespace tessera
