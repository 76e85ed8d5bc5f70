#include "client/link/page_url.h"

namespace tessera {

std::string percent_encoded(std::string_view text) {
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string encoded;
    for (const char c : text) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                           c == '-' || c == '.' || c == '_' || c == '~';
        if (plain) {
            encoded += c;
        } else {
            const auto byte = static_cast<unsigned char>(c);
            encoded += '%';
            encoded += digits[byte >> 4];
            encoded += digits[byte & 15];
        }
    }
    return encoded;
}

std::string scene_target(std::string_view scene_id) { return "/scenes/" + percent_encoded(scene_id); }

std::string page_target(std::string_view scene_id, Extent extent, PageKey page, const FetchOptions& options) {
    std::string target = scene_target(scene_id);
    for (std::size_t i = 0; i < options.without.size(); ++i)
        target += (i == 0 ? "/without-" : ",") + std::to_string(options.without[i]);
    for (const std::uint32_t part : {std::uint32_t{extent.zoom(page.level)}, page.x, page.y}) {
        target += '/';
        target += std::to_string(part);
    }
    target += '.';
    target += extension(options.format);
    char separator = '?';
    const auto add = [&](std::string_view name, std::string_view value) {
        target += separator;
        target.append(name).append(1, '=').append(value);
        separator = '&';
    };
    if (options.gutter != 0) add("gutter", std::to_string(options.gutter));
    if (options.accuracy != Accuracy::high) add("accuracy", name_of(options.accuracy));
    if (options.channels != ChannelSet::albedo) add("channels", name_of(options.channels));
    if (options.step != 0) add("step", std::to_string(options.step));
    return target;
}

}  // namespace tessera
