#include "server/prepare/photo_options.h"

#include <string>

#include <CLI/CLI.hpp>

#include "server/scene/asset_file.h"

namespace tessera {

CLI::Option* add_method_option(CLI::App& command, ExchangeMethod& method) {
    using enum ExchangeMethod;
    const auto all = {content_exchange, interchange, wang};
    std::vector<std::string> names;
    for (const ExchangeMethod one : all) names.emplace_back(method_name(one));
    return command
        .add_option_function<std::string>(
            "--method",
            [&method, all = std::vector(all)](const std::string& name) {
                for (const ExchangeMethod one : all)
                    if (method_name(one) == name) method = one;
            },
            "How the plane is covered: patches of a map that exchange their contents, patches of any shape "
            "on a "
            "repeating tile, or corner-coloured tiles")
        ->check(CLI::IsMember(names))
        ->default_str(names.front());
}

void add_megapixels_option(CLI::App& command, std::int64_t& megapixels) {
    command
        .add_option("--max-megapixels", megapixels,
                    "Larger images are refused, since preparing takes some 40 bytes of memory for each texel")
        ->check(CLI::Range(1, 128))
        ->capture_default_str();
}

ImageLimits photo_limits(std::int64_t megapixels) {
    return {.max_texels = megapixels << 20,
            .max_side = 32768,
            .max_file_bytes = std::int64_t{1} << 29,
            .how_to_raise = ", or allow more with --max-megapixels (at most 128)"};
}

}  // namespace tessera
