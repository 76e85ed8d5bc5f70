#include "server/history/commands.h"

#include <cstdio>
#include <cstdlib>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "server/edits/live_scene.h"
#include "server/history/edit_log.h"
#include "server/history/export.h"
#include "server/history/journal_copy.h"
#include "server/history/places.h"
#include "server/history/server_client.h"
#include "server/history/undo.h"
#include "server/journal/open_journal.h"
#include "server/progress/interrupt.h"
#include "server/progress/terminal_progress.h"
#include "shared/revisions/edit_id.h"

namespace tessera {

namespace {

struct Arguments {
    std::string scene, scenes, edits;
    std::optional<Revision> from, undo_to, at;
    std::uint64_t limit = LogOptions{}.limit;
    bool json = false, quiet = false;
    std::string server, output;
    std::string author;
};

/// Nothing but a progress's word to stop.
class Quiet final : public Progress {
  public:
    explicit Quiet(std::stop_token stop) : stop_{std::move(stop)} {}
    void advance(std::string_view, double) override {}
    void note(const std::string&) override {}
    std::stop_token stop() const override { return stop_; }

  private:
    const std::stop_token stop_;
};

Result<void> run_log(const Arguments& arguments) {
    const auto places = find_scene(arguments.scene, arguments.scenes, arguments.edits);
    if (!places) return places.error();
    const Interrupt interrupt;
    Quiet progress{interrupt.token()};
    const auto copy = JournalCopy::take(places->journal, places->id, progress);
    if (!copy) return copy.error();
    const auto older =
        write_log(copy->journal(), {arguments.from, arguments.limit, arguments.json}, stdout, progress);
    if (!older) return older.error();
    if (*older > 0 && !arguments.from)
        std::fprintf(stderr, "tessera log: %llu older edits are left out; --limit 0 lists all\n",
                     static_cast<unsigned long long>(*older));
    return {};
}

/// Over the server's door, as everybody else's edits.
Result<Revision> undo_at_server(const ScenePlaces& places, Undo undo, const std::string& address) {
    const char* const token = std::getenv("TESSERA_TOKEN");
    const auto server = ServerClient::of(address, token == nullptr ? "" : token);
    if (!server) return server.error();
    const auto fingerprint = server->fingerprint(places.id);
    if (!fingerprint) return fingerprint.error();
    if (*fingerprint != undo.fingerprint)
        return Error{ErrorCode::invalid_input,
                     "--server " + address + ": serves another scene of that name, with the fingerprint " +
                         *fingerprint + " instead of " + undo.fingerprint +
                         "; name its scene and its edits, or have it reload them"};
    Revision revision = undo.head;
    for (proto::Edit& edit : undo.edits) {
        edit.set_id(to_string(random_edit_id()));
        edit.set_known_revision(revision);
        const auto answer = server->edit(places.id, edit);
        if (!answer)
            return Error{answer.error().code, answer.error().detail + " (the scene has got to revision " +
                                                  std::to_string(revision) + ")"};
        revision = answer->revision();
    }
    return revision;
}

Result<Revision> undo_here(const ScenePtr& scene, std::unique_ptr<Journal> journal, Undo undo,
                           Progress& progress) {
    auto live = LiveScene::open(scene, std::move(journal), progress);
    if (!live) return live.error();
    Revision revision = undo.head;
    for (proto::Edit& edit : undo.edits) {
        edit.set_id(to_string(random_edit_id()));
        edit.set_known_revision(revision);
        std::promise<EditOutcome> promise;
        (*live)->edit(std::move(edit), [&](EditOutcome how) { promise.set_value(std::move(how)); });
        const EditOutcome outcome = promise.get_future().get();
        if (const auto* refusal = std::get_if<EditRefusal>(&outcome))
            return Error{ErrorCode::io_failure, refusal->detail};
        revision = std::get<proto::EditAnswer>(outcome).revision();
    }
    return revision;
}

Result<Undo> plan(const ScenePtr& scene, Journal& journal, const Arguments& arguments, Progress& progress) {
    auto undo = plan_undo(scene, journal, *arguments.undo_to, progress);
    if (!undo) return Error{undo.error().code, "--undo-to: " + undo.error().detail};
    for (proto::Edit& edit : undo->edits) edit.set_author(arguments.author);
    return undo;
}

Result<void> run_undo(const Arguments& arguments) {
    const auto places = find_scene(arguments.scene, arguments.scenes, arguments.edits);
    if (!places) return places.error();
    const Interrupt interrupt;
    TerminalProgress progress{"tessera log",
                              {{"checking the journal", 0.5}, {"replaying edits", 0.5}},
                              arguments.quiet,
                              interrupt.token()};
    const auto scene = load_scene(places->scene);
    if (!scene) return scene.error();
    Result<Revision> done = Revision{0};
    std::size_t edits = 0;
    if (!arguments.server.empty()) {
        const auto copy = JournalCopy::take(places->journal, places->id, progress);
        if (!copy) return copy.error();
        auto undo = plan(*scene, copy->journal(), arguments, progress);
        if (!undo) return undo.error();
        edits = undo->edits.size();
        done = undo_at_server(*places, std::move(*undo), arguments.server);
    } else {
        std::error_code failure;
        if (!std::filesystem::exists(places->journal / "journal.db", failure))
            return Error{ErrorCode::io_failure,
                         places->journal.string() +
                             ": holds no journal of edits: the scene was never served, or takes none"};
        JournalOptions options;
        options.scene = places->id;
        auto journal = open_journal(places->journal, options, progress);
        if (!journal)
            return Error{
                journal.error().code,
                journal.error().detail + "; while a server runs, ask it with --server http://HOST:PORT"};
        auto undo = plan(*scene, **journal, arguments, progress);
        if (!undo) return undo.error();
        edits = undo->edits.size();
        done = undo_here(*scene, std::move(*journal), std::move(*undo), progress);
    }
    if (!done) return done.error();
    if (arguments.quiet) return {};
    if (edits == 0)
        progress.note("the scene is as it was after revision " + std::to_string(*arguments.undo_to) +
                      "; there is nothing to undo");
    else
        progress.note("the scene is as it was after revision " + std::to_string(*arguments.undo_to) +
                      ", by " + (edits == 1 ? "one edit" : std::to_string(edits) + " edits") +
                      ": it is at revision " + std::to_string(*done));
    return {};
}

Result<void> run_export(const Arguments& arguments) {
    const auto places = find_scene(arguments.scene, arguments.scenes, arguments.edits);
    if (!places) return places.error();
    const Interrupt interrupt;
    TerminalProgress progress{"tessera export",
                              {{"checking the journal", 0.3},
                               {"replaying edits", 0.2},
                               {"copying assets", 0.2},
                               {"writing the scene file", 0.1},
                               {"checking", 0.2}},
                              arguments.quiet,
                              interrupt.token()};
    const auto copy = JournalCopy::take(places->journal, places->id, progress);
    if (!copy) return copy.error();
    const Revision revision = arguments.at.value_or(copy->journal().status().head);
    if (auto done = export_scene(places->scene, copy->journal(), revision, arguments.output, progress); !done)
        return done;
    progress.note(arguments.output + ": the scene at revision " + std::to_string(revision));
    return {};
}

void report(const char* command, const Result<void>& result, int& exit_code) {
    exit_code = result ? 0 : 1;
    if (!result) std::fprintf(stderr, "tessera %s: %s\n", command, result.error().detail.c_str());
}

void add_places(CLI::App& command, Arguments& arguments) {
    command.add_option("SCENE", arguments.scene, "Folder of a scene, or its name with --scenes")->required();
    command.add_option("--scenes", arguments.scenes, "The folder of scenes that is served");
    command.add_option("--edits", arguments.edits,
                       "Where its server keeps edits (default: .edits in the folder of scenes)");
    command.add_flag("-q,--quiet", arguments.quiet, "Say nothing but errors");
}

}  // namespace

void add_history_commands(CLI::App& app, int& exit_code) {
    const auto arguments = std::make_shared<Arguments>();

    CLI::App& log = *app.add_subcommand(
        "log", "Lists the edits of a scene, while it is served or not; or undoes the last ones");
    add_places(log, *arguments);
    auto* const json =
        log.add_flag("--json", arguments->json, "A JSON object for each edit, with its changes");
    auto* const from =
        log.add_option("--from", arguments->from, "The first revision (default: of the newest)");
    auto* const limit = log.add_option("--limit", arguments->limit, "So many edits at most; 0 lists all")
                            ->capture_default_str();
    auto* const undo_to =
        log.add_option("--undo-to", arguments->undo_to,
                       "Bring the scene back to how it was after this revision, by a new edit")
            ->excludes(json)
            ->excludes(from)
            ->excludes(limit);
    log.add_option(
           "--server", arguments->server,
           "The server that has the scene, as http://HOST:PORT; TESSERA_TOKEN holds a token, if it asks one")
        ->needs(undo_to);
    log.add_option("--author", arguments->author, "Whose edit it is")->needs(undo_to);
    log.callback([arguments, &exit_code] {
        report("log", arguments->undo_to ? run_undo(*arguments) : run_log(*arguments), exit_code);
    });

    CLI::App& write =
        *app.add_subcommand("export", "Writes a scene as edits left it as a scene folder of its own");
    add_places(write, *arguments);
    write.add_option("-o,--output", arguments->output, "The new folder; must not be there")->required();
    write.add_option("--at", arguments->at, "How it was after this revision (default: now)");
    write.callback([arguments, &exit_code] { report("export", run_export(*arguments), exit_code); });
}

}  // namespace tessera
