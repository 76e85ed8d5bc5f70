#pragma once

#include <memory>
#include <string>
#include <utility>

#include "server/http/server.h"
#include "server/texture/constant_texture.h"
#include "tests/end_to_end/server/raw_client.h"
#include "tests/unit/server/pages/test_textures.h"

namespace tessera::test {

inline ServerOptions quick_options() {
    ServerOptions options;
    options.port = 0;
    options.io_threads = 2;
    options.pages.threads = 2;
    return options;
}

/// A server on a free port of 127.0.0.1 with three scenes: `gated` (its evaluations wait for the test),
/// `board` and `grey`.
struct RunningServer {
    explicit RunningServer(const ServerOptions& options = quick_options(), bool publish_now = true)
        : server{Server::start(options).value()} {
        if (publish_now) publish();
    }

    void publish(const std::string& fingerprint = "0123456789abcdef") {
        auto catalog = std::make_shared<Catalog>();
        const auto add = [&](ScenePtr scene) { catalog->scenes.emplace(scene->id, scene); };
        add(make_scene("gated", gated, fingerprint));
        add(make_scene("board", make_checker_texture(37, {220, 40, 40, 255}, {255, 255, 255, 128}),
                       "b0a4db0a4db0a4d0"));
        add(make_scene("grey", make_constant_texture({100, 150, 200, 255}), "9999999999999999"));
        server->publish(std::move(catalog), WebFiles::plain());
    }

    RawClient client() const { return RawClient{server->port()}; }

    std::shared_ptr<GatedTexture> gated = std::make_shared<GatedTexture>();
    std::unique_ptr<Server> server;
};

inline const std::string gated_page = "/scenes/gated/20/5/7.png";

}  // namespace tessera::test
