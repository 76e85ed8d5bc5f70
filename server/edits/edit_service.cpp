#include "server/edits/edit_service.h"

#include <chrono>
#include <filesystem>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "server/journal/open_journal.h"

namespace tessera {

namespace {

/// Where our files are is nobody's business: "/srv/journal.db: the disk is full" without what stands first.
std::string without_file(const std::string& detail) {
    const std::size_t end = detail.starts_with('/') ? detail.find(": ") : std::string::npos;
    return end == std::string::npos ? detail : detail.substr(end + 2);
}

}  // namespace

Result<std::shared_ptr<LiveScene>> EditService::open(const ScenePtr& scene, Progress& progress) const {
    JournalOptions journal_options;
    journal_options.scene = scene->id;
    journal_options.horizon = options_.horizon;
    std::unique_ptr<Journal> journal;
    if (options_.folder.empty()) {
        journal = memory_journal(std::move(journal_options));
    } else {
        auto opened = open_journal(options_.folder / scene->id, std::move(journal_options), progress);
        if (!opened) return opened.error();
        journal = std::move(*opened);
    }
    auto live = LiveScene::open(scene, std::move(journal), progress);
    if (!live) return live.error();
    return std::shared_ptr<LiveScene>{std::move(*live)};
}

/// Whether edits of the scene may have been acknowledged here. A file of no bytes is what a kill in the first
/// moment leaves; where nobody may look there may be one.
bool EditService::may_have_journal(const std::string& scene) const {
    if (options_.folder.empty()) return false;
    std::error_code failure;
    const auto bytes = std::filesystem::file_size(options_.folder / scene / "journal.db", failure);
    if (failure)
        return failure != std::errc::no_such_file_or_directory && failure != std::errc::not_a_directory;
    return bytes > 0;
}

void EditService::adopt(Catalog& catalog, Progress& progress) {
    std::vector<Catalog::Problem> hidden;
    for (const auto& [id, scene] : catalog.scenes) {
        std::shared_ptr<LiveScene> live;
        {
            // Where files take no edits any more the journal waits until they do again
            const std::lock_guard lock{mutex_};
            const auto known = scenes_.find(id);
            const bool takes_edits = scene->ground || scene->document;
            if (known != scenes_.end() && !takes_edits) resting_.insert(id);
            if (!takes_edits) continue;
            if (known != scenes_.end()) live = known->second;
        }
        if (live) {
            live->rebase(scene);
            const std::lock_guard lock{mutex_};
            resting_.erase(id);
        } else {
            const bool had_journal = may_have_journal(id);
            auto opened = open(scene, progress);
            const std::lock_guard lock{mutex_};
            if (!opened && had_journal) {
                spdlog::error("scene {} is not shown, since its edits cannot be read: {}", id,
                              opened.error().detail);
                hidden.push_back(
                    {id,
                     "not shown, since without its edits it would be another scene; its journal: " +
                         without_file(opened.error().detail),
                     true});
                continue;
            }
            if (!opened) {
                spdlog::error("scene {} takes no edits: {}", id, opened.error().detail);
                troubled_.insert(id);
                continue;
            }
            live = std::move(*opened);
            scenes_[id] = live;
            troubled_.erase(id);
            spdlog::info("scene {} takes edits, at revision {}", id, live->now()->revision);
        }
        catalog.edited[id] = live;
    }
    for (Catalog::Problem& problem : hidden) {
        catalog.scenes.erase(problem.id);
        catalog.broken.push_back(std::move(problem));
    }
}

void EditService::close() {
    std::map<std::string, std::shared_ptr<LiveScene>, std::less<>> scenes;
    {
        const std::lock_guard lock{mutex_};
        scenes = scenes_;
    }
    for (const auto& [id, live] : scenes) live->close();
}

void EditService::edit(std::string_view scene, proto::Edit edit, LiveScene::Handler then) {
    const auto arrived = std::chrono::steady_clock::now();
    LiveScene::Handler handler = [this, arrived, then = std::move(then)](EditOutcome outcome) {
        if (auto* refusal = std::get_if<EditRefusal>(&outcome))
            refusal->detail = without_file(refusal->detail);
        metrics_.count(outcome, std::chrono::steady_clock::now() - arrived);
        then(std::move(outcome));
    };
    if (const auto live = find(scene)) return live->edit(std::move(edit), std::move(handler));
    const bool in_trouble = [&] {
        const std::lock_guard lock{mutex_};
        return troubled_.contains(scene);
    }();
    handler(in_trouble
                ? EditRefusal{EditRefusal::Why::unavailable,
                              "the scene's journal cannot be opened; the server's log says why", 0}
                : EditRefusal{
                      EditRefusal::Why::wrong,
                      "the scene takes no edits; give its scene.json \"sprites\", or its blocks \"editable\"",
                      0});
}

void EditService::update_gauges() {
    const std::lock_guard updating{updating_};
    std::map<std::string, std::shared_ptr<LiveScene>, std::less<>> scenes;
    {
        const std::lock_guard lock{mutex_};
        scenes = scenes_;
    }
    for (const auto& [id, live] : scenes)
        if (const auto journal = live->journal_status())
            metrics_.update(id, *journal, live->now()->sprites.size());
}

std::shared_ptr<LiveScene> EditService::find(std::string_view scene) const {
    const std::lock_guard lock{mutex_};
    const auto found = scenes_.find(scene);
    return found == scenes_.end() || resting_.contains(scene) ? nullptr : found->second;
}

}  // namespace tessera
