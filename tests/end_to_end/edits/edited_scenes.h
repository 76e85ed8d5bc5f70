#pragma once

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "proto/edit.pb.h"

#include "server/scene/png_file.h"
#include "shared/math/hash.h"
#include "shared/wire/json.h"
#include "tests/end_to_end/server/program.h"
#include "tests/end_to_end/server/raw_client.h"
#include "tests/support/made_edits.h"
#include "tests/support/temporary_folder.h"

namespace tessera::test {

inline const std::string json_type = "Content-Type: application/json\r\n";

/// A test with a folder of two scenes: `sprites`, four patterns over a checker, and `board`, which takes no
/// edits.
class EditedScenes : public testing::Test {
  protected:
    void SetUp() override {
        std::vector<std::uint8_t> texels;
        for (std::int64_t i = 0; i < 16 * 64 * 4; ++i)
            texels.push_back(static_cast<std::uint8_t>(hash(4, 4, i, 0)));
        write("sprites/patterns.png", to_png(16, 64, PngColor::rgba, 8, texels));
        write("sprites/scene.json", std::string{R"({"checker": {"cell_texels": 8}, "extent_log2_pages": 6,
            "sprites": {"patterns": {"image": "patterns.png", "side_texels": 16}}})"});
        write("board/scene.json", std::string{R"({"checker": {"cell_texels": 8}})"});
    }
    template <class Bytes>
    void write(const std::string& name, const Bytes& bytes) const {
        const std::filesystem::path file = folder.path / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream{file, std::ios::binary}.write(reinterpret_cast<const char*>(bytes.data()),
                                                    static_cast<std::streamsize>(bytes.size()));
    }
    Program serve(const std::vector<std::string>& more = {"--keep-no-edits"}) const {
        std::vector<std::string> words{"serve", "--scenes", folder.path.string(), "--listen", "127.0.0.1:0"};
        words.insert(words.end(), more.begin(), more.end());
        return Program{words};
    }
    tests::TemporaryFolder folder;
};

inline std::string post(const std::string& scene, const std::string& body,
                        const std::string& fields = json_type) {
    return "POST /scenes/" + scene +
           "/edits HTTP/1.1\r\nHost: localhost:7070\r\nContent-Length: " + std::to_string(body.size()) +
           "\r\n" + fields + "\r\n" + body;
}

inline std::optional<Reply> send(RawClient& client, const proto::Edit& edit) {
    if (!client.send(post("sprites", write_brief_json(edit)))) return std::nullopt;
    return client.receive();
}

inline proto::EditAnswer answer_in(const Reply& reply) {
    EXPECT_EQ(reply.status, 200) << reply.body;
    proto::EditAnswer answer;
    EXPECT_TRUE(read_json(reply.body, "answer", answer));
    return answer;
}

}  // namespace tessera::test
