#include "tests/property/stability/subjects.h"

#include <iterator>

#include "server/texture/constant_texture.h"
#include "server/texture/exchange.h"
#include "server/texture/material.h"
#include "tests/property/stability/pattern_subjects.h"
#include "tests/support/synthetic_asset.h"
#include "tests/support/synthetic_channels.h"

namespace tessera::tests {
namespace {

void add_exchanges(std::vector<Subject>& all, int code) {
    const SyntheticAssetOptions plain{.constant_code = code};
    const ExchangeAsset exchange = make_synthetic_asset(plain);
    const ExchangeAsset many_patches = make_synthetic_asset(
        {.tile_side = 128, .patches = 100, .contents = 3, .blend_texels = 6, .constant_code = code});
    const ExchangeAsset interchange =
        make_synthetic_interchange({.patches = 200, .blend_texels = 4, .constant_code = code});
    const auto add = [&](const std::string& name, const ExchangeAsset& asset, const ExchangeOptions& options,
                         std::int32_t side = 40) {
        all.push_back({name, make_exchange_texture(asset, options), side});
    };
    add("content_exchange_100_patches", many_patches, {.seed = 3, .types = 256});
    add("content_exchange_unblended", exchange, {.seed = 3, .types = 256, .blended = false});
    add("content_exchange_small_tile",
        make_synthetic_asset({.tile_side = 16, .patches = 4, .blend_texels = 2, .constant_code = code}),
        {.seed = 9, .types = 64});
    // Their exact texels are enumerated tile by tile
    add("content_exchange_independent", exchange, {.seed = 5, .choice = Choice::independent}, 8);
    add("content_exchange_independent_unblended", exchange,
        {.seed = 5, .choice = Choice::independent, .blended = false}, 8);
    add("interchange", interchange, {.seed = 3, .types = 128});
    add("interchange_unblended", interchange, {.types = 64, .blended = false});
    add("interchange_kolar", interchange, {.seed = 2, .choice = Choice::kolar}, 6);
    add("wang", make_synthetic_wang({.tile_side = 32, .blend_texels = 0, .constant_code = code}),
        {.seed = 4, .types = 128});
}

void add_channels(std::vector<Subject>& all) {
    ExchangeAsset asset = make_synthetic_asset({});
    add_bumps(asset, 50);
    add_grey_noise(asset, "roughness", 80, 150);
    add_grey_noise(asset, "height", 0, 255);
    const auto albedo = make_exchange_texture(asset, {.seed = 2026, .types = 64});
    for (const Channels& channels : make_channels(albedo, asset))
        all.push_back({"channel_" + std::string{name_of(channels.set)}, channels.texture});
}

}  // namespace

std::vector<Subject> subjects() {
    std::vector<Subject> all{
        {"constant", make_constant_texture({200, 31, 7, 255})},
        {"constant_translucent", make_constant_texture({255, 128, 1, 77})},
        {"checker", make_checker_texture(1, {255, 255, 255, 255}, {0, 0, 0, 255})},
        {"checker_odd", make_checker_texture(7, {250, 10, 90, 255}, {3, 200, 60, 120})},
        {"checker_large",
         make_checker_texture(std::int64_t{1} << 20, {9, 99, 199, 255}, {240, 130, 20, 255})},
    };
    add_exchanges(all, -1);
    add_channels(all);
    auto patterns = pattern_subjects(-1);
    std::move(patterns.begin(), patterns.end(), std::back_inserter(all));
    return all;
}

std::vector<Subject> constant_subjects(std::uint8_t code) {
    std::vector<Subject> all;
    add_exchanges(all, code);
    auto patterns = pattern_subjects(code);
    std::move(patterns.begin(), patterns.end(), std::back_inserter(all));
    return all;
}

}  // namespace tessera::tests
