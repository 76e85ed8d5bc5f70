#include "server/scene/fingerprint.h"

#include <algorithm>
#include <fstream>
#include <string_view>
#include <vector>

#include "server/scene/digest.h"
#include "shared/page/page_format.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

/// Part of every fingerprint: raise it whenever any page of any scene changes by a bit.
constexpr std::string_view evaluator_version = "8";

}  // namespace

Result<std::string> fingerprint_of(const fs::path& folder, const std::string& scene_text) {
    std::vector<fs::path> files;
    std::error_code failure;
    for (fs::recursive_directory_iterator entry{folder, failure}, end; !failure && entry != end;
         entry.increment(failure)) {
        // The journal of a scene that is served alone lies inside it, and changes with every edit
        if (entry->path().filename().string().starts_with('.'))
            entry.disable_recursion_pending();
        else if (std::error_code odd; entry->is_regular_file(odd))
            files.push_back(entry->path());
    }
    if (failure) return Error{ErrorCode::io_failure, folder.string() + ": " + failure.message()};
    std::sort(files.begin(), files.end());

    Digest digest;
    const std::string versions = std::string{evaluator_version} + '/' + std::to_string(encoder_version);
    digest.add(versions.data(), versions.size());
    const auto add_header = [&](const std::string& name, std::uintmax_t bytes) {
        const std::string header = name + '\0' + std::to_string(bytes) + '\0';
        digest.add(header.data(), header.size());
    };
    add_header("scene.json", scene_text.size());
    digest.add(scene_text.data(), scene_text.size());
    std::vector<char> block(1 << 16);
    for (const fs::path& path : files) {
        const std::string name = path.lexically_relative(folder).generic_string();
        if (name == "scene.json") continue;
        add_header(name, fs::file_size(path, failure));
        std::ifstream in{path, std::ios::binary};
        while (in.read(block.data(), std::ssize(block)) || in.gcount() > 0)
            digest.add(block.data(), static_cast<std::size_t>(in.gcount()));
        if (in.bad()) return Error{ErrorCode::io_failure, path.string() + ": cannot be read"};
    }
    return digest.hex();
}

}  // namespace tessera
