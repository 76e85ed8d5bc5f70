#include "tests/end_to_end/view/scene_server.h"

#include <fstream>
#include <stdexcept>

#include <unistd.h>

#include "server/scene/asset_file.h"
#include "tests/support/synthetic_asset.h"

namespace tessera::testing {

namespace fs = std::filesystem;

SceneServer::SceneServer()
    : folder_{fs::temp_directory_path() / ("tessera_view_" + std::to_string(getpid()))} {
    fs::remove_all(folder_);
    const auto scene = [&](const std::string& id, const char* json) {
        fs::create_directories(folder_ / "scenes" / id);
        std::ofstream{folder_ / "scenes" / id / "scene.json"} << json;
    };
    scene("board", R"({"checker": {"cell_texels": 37}})");
    scene("grey", R"({"title": "Grey", "constant": {"color": {"red": 90, "green": 120, "blue": 150}}})");
    scene("noise",
          R"({"extent_log2_pages": 30, "content_exchange": {"asset": "asset", "seed": 5, "types": 256}})");
    const auto asset = folder_ / "scenes" / "noise" / "asset";
    fs::create_directories(asset);
    if (!write_exchange_asset(asset, tests::make_synthetic_asset({}), {}))
        throw std::runtime_error{"cannot write the asset"};
    program_ = std::make_unique<Program>(std::vector<std::string>{
        TESSERA_PROGRAM, "serve", "--scenes", (folder_ / "scenes").string(), "--listen", "127.0.0.1:0"});
    const std::string line = program_->first_line();
    const std::string prefix = "tessera: listening on ";
    if (!line.starts_with(prefix)) throw std::runtime_error{"the server does not start: " + line};
    url_ = line.substr(prefix.size());
}

SceneServer::~SceneServer() {
    program_.reset();
    fs::remove_all(folder_);
}

}  // namespace tessera::testing
