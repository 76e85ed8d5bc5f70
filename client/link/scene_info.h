#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "client/link/server_address.h"
#include "shared/motion/validity.h"
#include "shared/page/channel_set.h"
#include "shared/page/opening_view.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

class HttpConnection;

/// What a client must know of a scene before it can ask for pages.
struct SceneInfo {
    std::string id;
    std::string title;
    std::string attribution;
    Extent extent;
    std::optional<OpeningView> view;   ///< What a visitor is to see first, where the scene says it.
    std::int32_t max_gutter = 0;       ///< The widest gutter the server gives, at most max_gutter_texels.
    std::uint64_t revision = 0;        ///< Accepted edits so far.
    std::string fingerprint;           ///< Changes with scene, assets and the evaluator's version.
    std::vector<std::string> formats;  ///< Endings of pages, as in "png".
    std::vector<std::string>
        channels;           ///< Channel sets, as in "albedo"; a server that names none has that one.
    std::string texture;    ///< The kind of texture, as in "checker".
    bool animated = false;  ///< Whether pages depend on the step.
};

/// Reads a scene's TileJSON; `where` names its source in errors. Fields that we do not know are skipped; a
/// page side or an extent that we cannot show is `invalid_input`.
Result<SceneInfo> parse_scene_info(std::string_view json, std::string_view where);

/// Whether the scene has the channel set. Error: invalid_input, with those it has.
Result<void> check_channels(const SceneInfo& scene, ChannelSet channels);

/// Whether a step can be asked for; 0 always can. Error: invalid_input.
Result<void> check_step(const SceneInfo& scene, Step step);

/// Asks the server for a scene. An unknown scene is `no_such_scene`, and the detail lists the scenes there
/// are.
boost::asio::awaitable<Result<SceneInfo>> read_scene_info(HttpConnection& connection,
                                                          std::string_view scene_id);

/// The same on a connection of its own, waiting for the answer, for at most `timeout` each for connecting and
/// for answering.
Result<SceneInfo> read_scene_info(const ServerAddress& server, std::string_view scene_id,
                                  std::chrono::milliseconds timeout = std::chrono::seconds{10});

/// The same, and again every half second for at most `patience` while the server is busy, as it is while it
/// loads its scenes; `waits` is called before the first wait.
Result<SceneInfo> await_scene_info(const ServerAddress& server, std::string_view scene_id,
                                   std::chrono::milliseconds patience, const std::function<void()>& waits);

}  // namespace tessera
