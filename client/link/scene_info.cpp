#include "client/link/scene_info.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <thread>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>

#include "proto/page.pb.h"

#include "client/link/http_connection.h"
#include "client/link/page_url.h"
#include "shared/wire/json.h"

namespace tessera {

namespace asio = boost::asio;

Result<SceneInfo> parse_scene_info(std::string_view json, std::string_view where) {
    proto::TileJson tile_json;
    if (const auto read = read_json_leniently(json, where, tile_json); !read) return read.error();
    const auto refuse = [&](const std::string& problem) {
        return Error{ErrorCode::invalid_input, std::string{where} + ": " + problem};
    };
    if (!tile_json.has_tessera()) return refuse("the field 'tessera' is missing; is this a Tessera server?");
    const proto::TextureInfo& texture = tile_json.tessera();
    if (texture.page_side() != static_cast<std::uint32_t>(page_side_texels))
        return refuse("tessera.page_side is " + std::to_string(texture.page_side()) +
                      ", this client shows pages of " + std::to_string(page_side_texels) + " texels");
    if (texture.extent_log2_pages() > max_level)
        return refuse("tessera.extent_log2_pages is " + std::to_string(texture.extent_log2_pages()) +
                      ", more than " + std::to_string(max_level));
    SceneInfo info;
    info.id = texture.id();
    info.title = tile_json.name();
    info.attribution = tile_json.attribution();
    info.extent.n = static_cast<std::uint8_t>(texture.extent_log2_pages());
    info.max_gutter = static_cast<std::int32_t>(
        std::min(texture.max_gutter(), static_cast<std::uint32_t>(max_gutter_texels)));
    info.revision = texture.revision();
    info.fingerprint = texture.fingerprint();
    info.formats.assign(texture.formats().begin(), texture.formats().end());
    info.channels.assign(texture.channels().begin(), texture.channels().end());
    if (info.channels.empty()) info.channels.emplace_back(name_of(ChannelSet::albedo));
    info.texture = texture.texture();
    info.animated = texture.animated();
    if (const proto::OpeningView& view = texture.view(); texture.has_view())
        info.view = {std::clamp<std::int64_t>(view.x(), 0, info.extent.side_texels() - 1),
                     std::clamp<std::int64_t>(view.y(), 0, info.extent.side_texels() - 1),
                     std::isfinite(view.level())
                         ? std::clamp(view.level(), min_view_level, static_cast<double>(info.extent.n))
                         : 1};
    return info;
}

Result<void> check_channels(const SceneInfo& scene, ChannelSet channels) {
    std::string there_are;
    for (const std::string& name : scene.channels) {
        if (name == name_of(channels)) return {};
        there_are += (there_are.empty() ? "" : ", ") + name;
    }
    return Error{ErrorCode::invalid_input, "--channels: scene " + scene.id + " has no \"" +
                                               std::string{name_of(channels)} + "\"; it has " + there_are};
}

Result<void> check_step(const SceneInfo& scene, Step step) {
    if (step == 0 || scene.animated) return {};
    return Error{ErrorCode::invalid_input, "--step: nothing moves in scene " + scene.id + "; leave it out"};
}

namespace {

/// " Its scenes: a, b." or what went wrong with asking.
asio::awaitable<std::string> list_of_scenes(HttpConnection& connection) {
    const Result<HttpReply> reply = co_await connection.get("/scenes");
    if (!reply || reply->status != 200) co_return std::string{};
    proto::SceneList list;
    if (!read_json_leniently(reply->body, "/scenes", list)) co_return std::string{};
    if (list.scenes().empty()) co_return std::string{"; it has none"};
    std::string text = "; it has ";
    constexpr int most = 20;
    for (int i = 0; i < std::min(list.scenes_size(), most); ++i)
        text += (i > 0 ? ", " : "") + list.scenes(i).id();
    if (list.scenes_size() > most) text += ", …";
    co_return text;
}

}  // namespace

asio::awaitable<Result<SceneInfo>> read_scene_info(HttpConnection& connection, std::string_view scene_id) {
    const std::string target = scene_target(scene_id);
    const std::string where = connection.server().url() + target;
    Result<HttpReply> reply = co_await connection.get(target);
    if (!reply) co_return std::move(reply.error());
    if (reply->status == 404) {
        const std::string others = co_await list_of_scenes(connection);
        co_return Error{ErrorCode::no_such_scene, where + ": the server has no scene of that name" + others};
    }
    if (reply->status == 503 || reply->status == 429)
        co_return Error{ErrorCode::overloaded, where + ": the server is busy; try again"};
    if (reply->status != 200)
        co_return Error{ErrorCode::io_failure, where + ": status " + std::to_string(reply->status)};
    co_return parse_scene_info(reply->body, where);
}

Result<SceneInfo> read_scene_info(const ServerAddress& server, std::string_view scene_id,
                                  std::chrono::milliseconds timeout) {
    asio::io_context context{1};
    HttpLimits limits;
    limits.connect_timeout = timeout;
    limits.request_timeout = timeout;
    HttpConnection connection{context.get_executor(), server, limits};
    std::optional<Result<SceneInfo>> answer;
    asio::co_spawn(context, read_scene_info(connection, scene_id),
                   [&](const std::exception_ptr& failure, Result<SceneInfo> info) {
                       if (failure) std::rethrow_exception(failure);
                       answer.emplace(std::move(info));
                   });
    context.run();
    return std::move(*answer);
}

Result<SceneInfo> await_scene_info(const ServerAddress& server, std::string_view scene_id,
                                   std::chrono::milliseconds patience, const std::function<void()>& waits) {
    constexpr std::chrono::milliseconds pause{500};
    const auto end = std::chrono::steady_clock::now() + patience;
    for (bool is_first = true;; is_first = false) {
        Result<SceneInfo> info = read_scene_info(server, scene_id);
        if (info || info.error().code != ErrorCode::overloaded ||
            std::chrono::steady_clock::now() + pause > end)
            return info;
        if (is_first) waits();
        std::this_thread::sleep_for(pause);
    }
}

}  // namespace tessera
