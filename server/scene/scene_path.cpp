#include "server/scene/scene_path.h"

#include <algorithm>
#include <system_error>

namespace tessera {

namespace fs = std::filesystem;

Result<fs::path> path_inside(const fs::path& folder, const std::string& field, const std::string& name,
                             const std::string& what) {
    if (name.empty())
        return Error{
            ErrorCode::invalid_input,
            field + ": is missing; name " + (what == "asset" ? "a folder" : "a file") + " beside scene.json"};
    // A NUL would end the name for the system, and not for us
    const bool odd = name.find('\0') != std::string::npos;
    std::error_code failure;
    const fs::path root = odd ? fs::path{} : fs::weakly_canonical(folder, failure);
    const fs::path target = odd || failure ? fs::path{} : fs::weakly_canonical(folder / name, failure);
    const auto [root_end, rest] = std::mismatch(root.begin(), root.end(), target.begin(), target.end());
    if (odd || failure || fs::path{name}.is_absolute() || root_end != root.end())
        return Error{ErrorCode::invalid_input, field + ": \"" + (odd ? std::string{"\\0"} : name) +
                                                   "\" leaves the scene's folder; copy the " + what +
                                                   " into it"};
    return target;
}

}  // namespace tessera
