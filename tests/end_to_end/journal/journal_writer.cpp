// journal_writer FOLDER ACCEPTED: appends edits to the journal in FOLDER without end, several at a time, and
// writes each accepted one's revision and id to the file ACCEPTED, where a kill cannot take them back. Takes
// a snapshot now and then, so that old edits are forgotten and kills meet snapshots too.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include <fcntl.h>
#include <unistd.h>

#include "server/journal/journal_wait.h"
#include "server/journal/open_journal.h"

namespace tessera {
namespace {

struct Line {
    Revision revision = 0;
    EditId id;
};

/// The edit's content can be told from its id.
std::string content_of(const EditId& id) {
    return std::string(id.bytes[0] * std::size_t{3}, static_cast<char>(id.bytes[1])) + to_string(id);
}

void append_for_ever(Journal& journal, int file) {
    const EditId id = random_edit_id();
    journal.append({id, content_of(id), journal.status().head, {}},
                   [&journal, file, id](const AppendOutcome& outcome) {
                       const auto* const accepted = std::get_if<Accepted>(&outcome);
                       if (accepted == nullptr) {
                           std::fprintf(stderr, "not accepted: outcome %zu\n", outcome.index());
                           std::_Exit(3);
                       }
                       const Line line{accepted->revision, id};
                       if (::write(file, &line, sizeof line) != sizeof line) std::_Exit(4);
                       append_for_ever(journal, file);
                   });
}

int run(const char* folder, const char* accepted) {
    const int file = ::open(accepted, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644);
    JournalOptions options;
    options.scene = "killed";
    options.horizon.revisions = 100;
    SilentProgress progress;
    auto journal = open_journal(folder, options, progress);
    if (file < 0 || !journal) {
        std::fprintf(stderr, "%s\n", journal ? "no file for accepted edits" : journal.error().detail.c_str());
        return 2;
    }
    std::puts("ready");
    std::fflush(stdout);
    for (int i = 0; i < 8; ++i) append_for_ever(**journal, file);
    for (;;) {
        std::this_thread::sleep_for(std::chrono::milliseconds{5});
        const JournalStatus status = (*journal)->status();
        if (status.head > status.snapshot + 50)
            static_cast<void>(keep_snapshot_and_wait(
                **journal, {status.head, std::string(100'000, 'x') + std::to_string(status.head)}));
    }
}

}  // namespace
}  // namespace tessera

int main(int count, char** words) {
    if (count != 3) return 1;
    return tessera::run(words[1], words[2]);
}
