#include "server/history/edit_log.h"

#include <string>

#include <google/protobuf/util/json_util.h>

#include "proto/log.pb.h"

#include "server/history/edit_words.h"
#include "server/journal/journal_wait.h"

namespace tessera {

namespace {

std::string json_line(const Edit& edit, const proto::Edit& message) {
    proto::LoggedEdit line;
    line.set_revision(edit.revision);
    std::string time = text_of(edit.accepted) + "Z";
    time[time.find(' ')] = 'T';
    line.set_time(time);
    line.set_id(to_string(edit.id));
    line.set_author(message.author());
    line.set_what(words_for(message));
    *line.mutable_changes() = message.changes();
    google::protobuf::util::JsonPrintOptions options;
    options.preserve_proto_field_names = true;
    std::string text;
    // Fails only for messages with invalid embedded types, which ours do not have
    (void)google::protobuf::util::MessageToJsonString(line, &text, options);
    return text;
}

std::string text_line(const Edit& edit, const proto::Edit& message) {
    const std::string author = message.author().empty() ? "-" : harmless(message.author());
    return std::to_string(edit.revision) + "  " + text_of(edit.accepted) + "  " + author + "  " +
           words_for(message);
}

}  // namespace

Result<Revision> write_log(Journal& journal, const LogOptions& options, std::FILE* out, Progress& progress) {
    const JournalStatus status = journal.status();
    Revision from = status.oldest;
    if (options.from) {
        from = *options.from;
        if (from < status.oldest)
            return Error{
                ErrorCode::invalid_input,
                "--from " + std::to_string(from) +
                    ": is beyond the journal's horizon; the oldest edit that it remembers is revision " +
                    std::to_string(status.oldest)};
    } else if (options.limit != 0 && status.head + 1 - status.oldest > options.limit) {
        from = status.head + 1 - options.limit;
    }
    if (from > status.head) return Revision{0};
    const Revision through =
        options.limit == 0 || status.head - from < options.limit ? status.head : from + options.limit - 1;
    bool written = true;
    const auto ended = for_each_edit(journal, from, through, [&](const Edit& edit) {
        proto::Edit message;
        if (!message.ParseFromString(edit.bytes)) message.Clear();
        const std::string line = options.json ? json_line(edit, message) : text_line(edit, message);
        written = std::fprintf(out, "%s\n", line.c_str()) >= 0;
        return written && !progress.stop().stop_requested();
    });
    if (progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
    if (!written || std::fflush(out) != 0) return Error{ErrorCode::io_failure, "the log cannot be written"};
    if (ended)
        return Error{ErrorCode::io_failure, "the journal ends before revision " + std::to_string(through)};
    return from - status.oldest;
}

}  // namespace tessera
