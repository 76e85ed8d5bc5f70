#include "client/edit/edit_json.h"

#include <cstdio>
#include <memory>

#include <google/protobuf/util/json_util.h>

#include "shared/wire/json.h"

namespace tessera {

std::string json_line(const google::protobuf::Message& message) {
    google::protobuf::util::JsonPrintOptions options;
    options.preserve_proto_field_names = true;
    std::string text;
    // Fails only for messages with invalid embedded types, which ours do not have
    (void)google::protobuf::util::MessageToJsonString(message, &text, options);
    return text;
}

proto::ServerMessage told_fate(const std::string& id, const proto::EditAnswer& answer) {
    proto::ServerMessage told;
    told.mutable_edit_done()->set_id(id);
    *told.mutable_edit_done()->mutable_answer() = answer;
    return told;
}

proto::ServerMessage told_fate(const proto::EditRefused& refusal) {
    proto::ServerMessage told;
    *told.mutable_edit_refused() = refusal;
    return told;
}

Result<proto::Edit> edit_in(std::string_view json, std::string_view where) {
    proto::Edit edit;
    if (const auto read = read_json(json, where, edit); !read) return read.error();
    if (edit.changes().empty())
        return Error{ErrorCode::invalid_input, std::string{where} +
                                                   ": the edit has no changes, as in "
                                                   R"({"changes": [{"remove_sprite": {"id": 7}}]})"};
    return edit;
}

Result<proto::Edit> undo_in(std::string_view lines, std::string_view where) {
    // The last edit's line is the one to undo
    while (!lines.empty()) {
        const std::size_t cut = lines.find_last_of('\n');
        const std::string_view line = cut == std::string_view::npos ? lines : lines.substr(cut + 1);
        lines = cut == std::string_view::npos ? std::string_view{} : lines.substr(0, cut);
        if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
        proto::ServerMessage told;
        if (const auto read = read_json(line, where, told); !read) return read.error();
        if (!told.has_edit_done()) continue;
        if (!told.edit_done().answer().has_inverse())
            return Error{ErrorCode::invalid_input,
                         std::string{where} +
                             ": the last answer has no inverse; retries and edits of others "
                             "are answered without"};
        proto::Edit undo = told.edit_done().answer().inverse();
        undo.clear_id();
        undo.clear_known_revision();
        return undo;
    }
    return Error{ErrorCode::invalid_input,
                 std::string{where} + ": no answer of an edit, as tessera-edit --json prints them"};
}

Result<std::string> text_of(const std::string& file, std::size_t most) {
    struct Close {
        void operator()(std::FILE* opened) const {
            if (opened != stdin) std::fclose(opened);
        }
    };
    const std::unique_ptr<std::FILE, Close> in{file == "-" ? stdin : std::fopen(file.c_str(), "rb")};
    if (!in) return Error{ErrorCode::io_failure, file + ": cannot be read"};
    std::string text(most + 1, '\0');
    text.resize(std::fread(text.data(), 1, text.size(), in.get()));
    if (std::ferror(in.get()) != 0) return Error{ErrorCode::io_failure, file + ": cannot be read"};
    if (text.size() > most)
        return Error{ErrorCode::invalid_input, file + ": more than " + std::to_string(most) + " bytes"};
    return text;
}

}  // namespace tessera
