#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/http/server.h"
#include "server/progress/progress.h"
#include "tests/end_to_end/server/raw_client.h"
#include "tests/end_to_end/stream/stream_client.h"
#include "tests/unit/server/edits/made_scene.h"
#include "tests/unit/server/pages/test_textures.h"

namespace tessera::test {

/// Grey that changes every ten steps.
class SlowlyMovingTexture final : public Texture {
  public:
    using Texture::evaluate;
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget&, LinearImage& out) const override {
        const std::int64_t ten = region.step >= 0 ? region.step / 10 : -((9 - region.step) / 10);
        out = LinearImage{region.width, region.height};
        for (std::size_t i = 0; i < out.values.size(); ++i)
            out.values[i] =
                i % 4 == 3 ? 1.0F : static_cast<float>((i / 4 + static_cast<std::size_t>(ten)) % 5) / 5;
        Evaluation did;
        did.method = "moving";
        did.validity = {ten * 10, ten * 10 + 10};
        return did;
    }
    std::string_view kind() const noexcept override { return "moving"; }
    std::string description() const override { return "moving"; }
    std::size_t memory_bytes() const noexcept override { return 0; }
};

inline ServerOptions stream_options() {
    ServerOptions options;
    options.port = 0;
    options.io_threads = 2;
    options.pages.threads = 2;
    return options;
}

/// A server on a free port of 127.0.0.1: `made`, which takes edits that last as long as it does, `gated`
/// (its evaluations wait for the test), `grey`, which is one colour, and `moving`.
struct LiveServer {
    explicit LiveServer(const ServerOptions& options = stream_options())
        : server{Server::start(options).value()} {
        publish();
    }

    void publish(const std::string& fingerprint = "0123456789abcdef", bool with_made = true,
                 std::shared_ptr<const Access> access = std::make_shared<const Access>()) {
        auto catalog = std::make_shared<Catalog>();
        const auto add = [&](ScenePtr scene) { catalog->scenes.emplace(scene->id, scene); };
        auto made = std::make_shared<Scene>(*made_scene());
        made->title = "Sprites of the tests";
        made->fingerprint = fingerprint;
        if (with_made) add(made);
        add(make_scene("gated", gated));
        add(make_scene("grey", make_constant_texture({100, 150, 200, 255}), "9999999999999999"));
        auto moving = std::make_shared<Scene>(*make_scene("moving", std::make_shared<SlowlyMovingTexture>()));
        moving->animated = true;
        moving->steps_per_second = 4;
        moving->loop_steps = 100;
        add(moving);
        for (const ScenePtr& scene : more) add(scene);
        SilentProgress progress;
        server->edits().adopt(*catalog, progress);
        server->publish(std::move(catalog), WebFiles::plain(), std::move(access));
    }

    StreamClient stream(const std::string& scene = "made") const {
        return StreamClient{server->port(), scene};
    }
    RawClient http() const { return RawClient{server->port()}; }
    ScenePtr now() { return server->edits().find("made")->now(); }

    std::vector<ScenePtr> more;  ///< That are published, too.
    std::shared_ptr<GatedTexture> gated = std::make_shared<GatedTexture>();
    std::unique_ptr<Server> server;
};

inline proto::ClientMessage message_of(const proto::Edit& edit) {
    proto::ClientMessage message;
    *message.mutable_edit() = edit;
    return message;
}

}  // namespace tessera::test
