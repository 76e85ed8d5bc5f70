// Edits whose answers are lost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/client/link/stream_listener.h"

namespace tessera {
namespace {

namespace asio = boost::asio;
using std::chrono::milliseconds;
using test::Listening;
using test::SmallStreamServer;
using test::StreamPeer;

proto::ServerMessage accepted(const proto::Edit& edit, std::uint64_t revision) {
    proto::ServerMessage message;
    message.mutable_edit_done()->set_id(edit.id());
    message.mutable_edit_done()->set_session(3);
    message.mutable_edit_done()->mutable_answer()->set_revision(revision);
    return message;
}

proto::ServerMessage refused(const proto::Edit& edit, proto::EditRefused::Why why) {
    proto::ServerMessage message;
    message.mutable_edit_refused()->set_id(edit.id());
    message.mutable_edit_refused()->set_why(why);
    return message;
}

/// Makes one edit, and the fate it has with this server.
struct OneEdit {
    explicit OneEdit(SmallStreamServer::Script script, StreamSettings settings = Listening::quick())
        : server{std::move(script)}, listening{server.address(), std::move(settings)} {
        proto::Edit edit;
        edit.add_changes()->mutable_remove_sprite()->set_id(8);
        id = listening.client->edit(edit, [this](EditFate told) { fates.push_back(std::move(told)); });
    }
    bool ends() {
        return listening.run_until([&] { return !fates.empty(); });
    }
    proto::EditRefused::Why why() const { return std::get<proto::EditRefused>(fates.at(0)).why(); }

    SmallStreamServer server;
    Listening listening;
    std::string id;
    std::vector<EditFate> fates;
};

TEST(StreamEdits, AnAcceptedEditSaysItsRevision) {
    OneEdit one{[](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        const auto message = co_await peer.hear(proto::ClientMessage::kEdit);
        co_await peer.say(accepted(message->edit(), 8));
        co_await peer.say(accepted(message->edit(), 8));  // once too often
        co_await peer.stay();
    }};
    ASSERT_TRUE(one.ends());
    EXPECT_EQ(std::get<proto::EditAnswer>(one.fates[0]).revision(), 8u);
    EXPECT_EQ(one.listening.client->newest_revision(), 8u);
    one.listening.run_for(milliseconds{50});
    EXPECT_EQ(one.fates.size(), 1u);
}

TEST(StreamEdits, AnEditWhoseAnswerWasLostIsSentAgainAsItWas) {
    std::vector<std::string> sent;
    OneEdit one{[&](StreamPeer& peer, int n) -> asio::awaitable<void> {
        const std::function<void(proto::ServerHello&)> change = [n](proto::ServerHello& hello) {
            hello.set_revision(std::uint64_t{7} + static_cast<unsigned>(n));
        };
        co_await peer.greet(change);
        const auto message = co_await peer.hear(proto::ClientMessage::kEdit);
        sent.push_back(message->edit().SerializeAsString());
        if (n < 2) co_return;
        co_await peer.say(accepted(message->edit(), 8));
        co_await peer.stay();
    }};
    ASSERT_TRUE(one.ends());
    ASSERT_EQ(sent.size(), 3u);
    EXPECT_EQ(sent[0], sent[1]) << "the same id and known_revision";
    EXPECT_EQ(sent[1], sent[2]);
    EXPECT_EQ(one.listening.client->statistics().edits_sent_again, 2u);
}

TEST(StreamEdits, OfAnotherHistoryNobodyKnowsWhetherItIsIn) {
    int edits = 0;
    OneEdit one{[&](StreamPeer& peer, int n) -> asio::awaitable<void> {
        const std::function<void(proto::ServerHello&)> change = [n](proto::ServerHello& hello) {
            hello.set_lineage(std::to_string(n));
        };
        co_await peer.greet(change);
        if (n == 0) co_await peer.hear(proto::ClientMessage::kEdit);
        if (n == 0) co_return;
        while (const auto message = co_await peer.hear(proto::ClientMessage::kEdit)) ++edits;
    }};
    ASSERT_TRUE(one.ends());
    EXPECT_EQ(one.why(), proto::EditRefused::unknown);
    one.listening.run_for(milliseconds{50});
    EXPECT_EQ(edits, 0) << "there it could come in a second time";
}

TEST(StreamEdits, AnUnknownOutcomeIsAskedForUntilItIsKnown) {
    OneEdit one{[](StreamPeer& peer, int) -> asio::awaitable<void> {
        co_await peer.greet();
        for (int i = 0; i < 2; ++i) {
            const auto message = co_await peer.hear(proto::ClientMessage::kEdit);
            co_await peer.say(refused(message->edit(), proto::EditRefused::unknown));
        }
        const auto message = co_await peer.hear(proto::ClientMessage::kEdit);
        // It was in; what refuses retries for passing reasons leaves that open, too
        co_await peer.say(refused(message->edit(), proto::EditRefused::overloaded));
        const auto again = co_await peer.hear(proto::ClientMessage::kEdit);
        co_await peer.say(accepted(again->edit(), 8));
        co_await peer.stay();
    }};
    ASSERT_TRUE(one.ends());
    EXPECT_EQ(std::get<proto::EditAnswer>(one.fates[0]).revision(), 8u);
}

TEST(StreamEdits, ARefusalEndsAnEditThatCannotBeIn) {
    for (const auto why : {proto::EditRefused::wrong, proto::EditRefused::conflict,
                           proto::EditRefused::overloaded, proto::EditRefused::forbidden}) {
        OneEdit one{[why](StreamPeer& peer, int) -> asio::awaitable<void> {
            co_await peer.greet();
            const auto message = co_await peer.hear(proto::ClientMessage::kEdit);
            co_await peer.say(refused(message->edit(), why));
            co_await peer.stay();
        }};
        ASSERT_TRUE(one.ends());
        EXPECT_EQ(one.why(), why);
    }
}

TEST(StreamEdits, PatienceEndsWithWhatIsKnown) {
    StreamSettings settings = Listening::quick();
    settings.edit_patience = milliseconds{150};
    OneEdit sent{[](StreamPeer& peer, int) -> asio::awaitable<void> {
                     co_await peer.greet();
                     co_await peer.stay();
                 },
                 settings};
    ASSERT_TRUE(sent.ends());
    EXPECT_EQ(sent.why(), proto::EditRefused::unknown);
    OneEdit unsent{[](StreamPeer&, int) -> asio::awaitable<void> { co_return; }, settings};
    ASSERT_TRUE(unsent.ends());
    EXPECT_EQ(unsent.why(), proto::EditRefused::unavailable);
}

TEST(StreamEdits, EditsKeepTheirOrderAndTheirNumberIsBounded) {
    std::vector<std::string> order;
    SmallStreamServer server{[&](StreamPeer& peer, int n) -> asio::awaitable<void> {
        co_await peer.greet();
        while (const auto message = co_await peer.hear(proto::ClientMessage::kEdit)) {
            if (n == 0 && message->edit().author() == "3") co_return;
            order.push_back(message->edit().author());
            co_await peer.say(accepted(message->edit(), 8 + order.size()));
        }
    }};
    StreamSettings settings = Listening::quick();
    settings.max_edits = 10;
    Listening listening{server.address(), settings};
    std::vector<std::uint64_t> revisions;
    for (int i = 0; i < 12; ++i) {
        proto::Edit edit;
        edit.set_author(std::to_string(i));
        const std::string id = listening.client->edit(edit, [&](const EditFate& fate) {
            revisions.push_back(std::get<proto::EditAnswer>(fate).revision());
        });
        EXPECT_EQ(id.empty(), i >= 10);
    }
    proto::Edit huge;
    huge.set_author(std::string(300'000, 'x'));
    ASSERT_TRUE(listening.run_until([&] { return revisions.size() == 10; }));
    bool is_refused = false;
    listening.client->edit(huge, [&](const EditFate& fate) {
        is_refused = std::get<proto::EditRefused>(fate).why() == proto::EditRefused::wrong;
    });
    EXPECT_TRUE(listening.run_until([&] { return is_refused; }));
    std::vector<std::string> unique = order;
    unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
    EXPECT_EQ(unique, (std::vector<std::string>{"0", "1", "2", "3", "4", "5", "6", "7", "8", "9"}));
}

}  // namespace
}  // namespace tessera
