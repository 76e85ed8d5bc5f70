#include <unistd.h>

#include "proto/asset.pb.h"

#include "server/files/whole_file.h"
#include "server/scene/asset_check.h"
#include "server/scene/asset_file.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

Error invalid(const fs::path& file, const std::string& what) {
    return {ErrorCode::invalid_input, file.string() + ": " + what};
}

const char* word_of(ExchangeAsset::Standing standing) {
    switch (standing) {
        case ExchangeAsset::Standing::pinned:
            return "pinned";
        case ExchangeAsset::Standing::dropped:
            return "dropped";
        case ExchangeAsset::Standing::chosen:
            break;
    }
    return "";
}

/// The file is there whole, as it was or as it is to be, at every moment.
Result<void> replace_file(const fs::path& file, const std::string& text) {
    fs::path made = file.parent_path() / ("." + file.filename().string());
    made += ".partial-" + std::to_string(::getpid());
    Result<void> done =
        write_whole_file(made, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    std::error_code failure;
    if (done) fs::rename(made, file, failure);
    if (failure) done = Error{ErrorCode::io_failure, file.string() + ": " + failure.message()};
    if (!done) {
        fs::remove(made, failure);
        return done;
    }
    return sync_folder(file.parent_path());
}

}  // namespace

Result<void> apply_standings(ExchangeAsset& asset, const fs::path& folder,
                             const std::vector<StandingChange>& changes) {
    const fs::path json = folder / "asset.json";
    for (const StandingChange& change : changes) {
        if (change.patch >= asset.patches.size())
            return invalid(json, "has no patch " + std::to_string(change.patch) + "; patches are 0 to " +
                                     std::to_string(asset.patches.size() - 1));
        auto& contents = asset.patches[change.patch].contents;
        if (!change.content) {
            for (auto& content : contents) content.standing = change.standing;
            continue;
        }
        const std::uint64_t number = *change.content;
        if (number == 0)
            return invalid(json, "content 0 of patch " + std::to_string(change.patch) +
                                     " is the tile's own, which is always there; name another");
        if (number > contents.size())
            return invalid(json, "patch " + std::to_string(change.patch) + " has no content " +
                                     std::to_string(number) + "; it has " + std::to_string(contents.size()) +
                                     ", counted from 1");
        contents[number - 1].standing = change.standing;
    }
    return check_exchange_asset(asset,
                                {.json = json, .exemplar = {}, .tile = {}, .patches = {}, .shapes = {}});
}

Result<void> change_standings(const fs::path& folder, const std::vector<StandingChange>& changes) {
    const fs::path json = folder / "asset.json";
    auto asset = read_exchange_asset(folder);
    if (!asset) return asset.error();
    if (auto applied = apply_standings(*asset, folder, changes); !applied) return applied;

    // The file keeps all else that a person wrote there
    const auto text = read_whole_file(json, max_asset_json_bytes);
    if (!text) return text.error();
    proto::ExchangeAsset message;
    if (auto read = read_json(*text, json.string(), message); !read) return read;
    const Error changed = invalid(json, "changed while it was read; try again");
    if (message.patches_info_size() != std::ssize(asset->patches)) return changed;
    for (std::size_t p = 0; p < asset->patches.size(); ++p) {
        const auto& contents = asset->patches[p].contents;
        auto& listed = *message.mutable_patches_info(static_cast<int>(p))->mutable_contents();
        if (listed.size() != std::ssize(contents)) return changed;
        for (std::size_t c = 0; c < contents.size(); ++c)
            listed[static_cast<int>(c)].set_standing(word_of(contents[c].standing));
    }
    return replace_file(json, write_json(message));
}

}  // namespace tessera
