#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "server/access/access.h"
#include "server/http/server_options.h"
#include "server/http/web_files.h"
#include "server/scene/scene.h"
#include "shared/result/result.h"

namespace tessera {

/// Everything that is read from the disk before it is served.
struct LoadedSite {
    std::shared_ptr<const Catalog> catalog;  ///< At least one scene.
    std::shared_ptr<const WebFiles> web;
    std::shared_ptr<const Access> access;
};

/// Reads the tokens, the web page and the scenes, and logs what it found. Looks at `stop` between scenes;
/// `tell` hears of each, as of load_catalog().
/// Never throws. Errors: invalid_input, io_failure, which also stands for a lack of memory, cancelled; the
/// message names the option.
Result<LoadedSite> load_site(const ServerOptions& options, const std::stop_token& stop,
                             const std::function<void(const LoadedScene&)>& tell = {});

/// `message` with the paths below `folder` made relative to it, since /scenes shows messages to everybody.
/// `folder` is canonical.
std::string without_folder(std::string message, const std::filesystem::path& folder,
                           const std::string& in_its_place = {});

}  // namespace tessera
