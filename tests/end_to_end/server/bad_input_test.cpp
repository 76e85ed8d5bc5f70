// Everything a client can get wrong, with the status it deserves; and that the server goes on.
#include <random>

#include <gtest/gtest.h>

#include "tests/end_to_end/server/running_server.h"

namespace tessera {
namespace {

using test::RawClient;
using test::Reply;
using test::RunningServer;

struct Wrong {
    const char* what;
    std::string request;
    int status;
};

std::string line(const std::string& request_line, const std::string& fields = "Host: test\r\n") {
    return request_line + " HTTP/1.1\r\n" + fields + "\r\n";
}

std::vector<Wrong> wrong_requests() {
    std::string many_fields = "Host: test\r\n";
    for (int i = 0; i < 120; ++i) many_fields += "X-" + std::to_string(i) + ": 1\r\n";
    const std::string host = "Host: test\r\n";
    return {
        // Addresses
        {"unknown scene", line("GET /scenes/none/0/0/0.png"), 404},
        {"unknown scene's tiles", line("GET /scenes/none"), 404},
        {"unknown file", line("GET /favicon.gif"), 404},
        {"z beyond the extent", line("GET /scenes/grey/21/0/0.png"), 404},
        {"x beyond the level", line("GET /scenes/grey/3/8/0.png"), 404},
        {"negative y", line("GET /scenes/grey/3/0/-1.png"), 404},
        {"a number beyond 64 bits", line("GET /scenes/grey/3/99999999999999999999/0.png"), 404},
        {"letters for z", line("GET /scenes/grey/a/0/0.png"), 400},
        {"a fraction", line("GET /scenes/grey/1/0.5/0.png"), 400},
        {"an exponent", line("GET /scenes/grey/1/1e0/0.png"), 400},
        {"leading zeros", line("GET /scenes/grey/1/00/0.png"), 400},
        {"a plus", line("GET /scenes/grey/1/+1/0.png"), 400},
        {"an empty number", line("GET /scenes/grey/1//0.png"), 400},
        {"unknown format", line("GET /scenes/grey/1/0/0.gif"), 400},
        {"no format", line("GET /scenes/grey/1/0/0"), 400},
        {"upper-case format", line("GET /scenes/grey/1/0/0.PNG"), 400},
        {"malformed pin", line("GET /scenes/grey/r0/1/0/0.png"), 400},
        {"short fingerprint", line("GET /scenes/grey/r0-99/1/0/0.png"), 400},
        {"wrong fingerprint", line("GET /scenes/grey/r0-0000000000000000/1/0/0.png"), 404},
        {"revision not reached", line("GET /scenes/grey/r1-9999999999999999/1/0/0.png"), 404},
        {"gutter too wide", line("GET /scenes/grey/1/0/0.png?gutter=17"), 400},
        {"gutter negative", line("GET /scenes/grey/1/0/0.png?gutter=-1"), 400},
        {"gutter empty", line("GET /scenes/grey/1/0/0.png?gutter="), 400},
        {"gutter twice", line("GET /scenes/grey/1/0/0.png?gutter=1&gutter=1"), 400},
        {"unknown parameter", line("GET /scenes/grey/1/0/0.png?size=1"), 400},
        {"unknown accuracy", line("GET /scenes/grey/1/0/0.png?accuracy=best"), 400},
        {"parameters on the list", line("GET /scenes?gutter=1"), 400},
        {"dots", line("GET /../etc/passwd"), 400},
        {"encoded dots", line("GET /%2e%2e/etc/passwd"), 400},
        {"encoded slash", line("GET /..%2fetc%2fpasswd"), 400},
        {"encoded backslash", line("GET /..%5cetc"), 400},
        {"encoded NUL", line("GET /index.html%00.png"), 400},
        {"overlong dots", line("GET /%c0%ae%c0%ae/etc"), 400},
        {"dots encoded twice", line("GET /%252e%252e/etc"), 404},
        {"half an escape", line("GET /scenes/%4"), 400},
        {"no escape", line("GET /scenes/%zz"), 400},
        {"a fragment", line("GET /scenes#top"), 400},
        {"a space in the address", line("GET /a b"), 400},
        {"a byte beyond ASCII", line("GET /sc\xc3\xa9nes"), 400},
        {"no slash", line("GET scenes"), 400},
        {"another scheme", line("GET ftp://test/scenes"), 400},
        {"a target of 3 KiB", line("GET /" + std::string(3000, 'a')), 414},
        {"a target of 60 KiB", "GET /" + std::string(60'000, 'a'), 414},
        // Methods
        {"POST", line("POST /scenes"), 405},
        {"DELETE", line("DELETE /scenes/grey"), 405},
        {"TRACE", line("TRACE /scenes"), 405},
        {"CONNECT", line("CONNECT test:80"), 405},
        {"unknown method", line("BREW /scenes"), 501},
        {"lower-case method", line("get /scenes"), 501},
        // Headers
        {"no Host", line("GET /scenes", ""), 400},
        {"two Hosts", line("GET /scenes", host + host), 400},
        {"empty Host", line("GET /scenes", "Host: \r\n"), 400},
        {"Host with a path", line("GET /scenes", "Host: test/x\r\n"), 400},
        {"Host with a quote", line("GET /scenes", "Host: te\"st\r\n"), 400},
        {"a header of 20 KiB", line("GET /scenes", host + "X: " + std::string(20'000, 'x') + "\r\n"), 431},
        {"a header that never ends", "GET /scenes HTTP/1.1\r\nX: " + std::string(20'000, 'x'), 431},
        {"120 fields", line("GET /scenes", many_fields), 431},
        {"a folded field", line("GET /scenes", host + "X: a\r\n b\r\n"), 400},
        {"a field without colon", line("GET /scenes", host + "Nonsense\r\n"), 400},
        {"a space before the colon", line("GET /scenes", host + "X : a\r\n"), 400},
        {"a bare LF", "GET /scenes HTTP/1.1\nHost: test\r\n\r\n", 400},
        {"LFs alone", "GET /scenes HTTP/1.1\nHost: test\n\n", 400},
        {"an empty line of LF", "\nGET /scenes HTTP/1.1\r\nHost: test\r\n\r\n", 400},
        {"an LF at last", "GET /scenes HTTP/1.1\r\nHost: test\r\n\n", 400},
        {"a line and no more", "GET /scenes\n", 400},
        {"a bare CR", line("GET /scenes", host + "X: a\rb\r\n"), 400},
        {"NUL in a field", line("GET /scenes", host + std::string{"X: a\0b\r\n", 8}), 400},
        {"an expectation", line("GET /scenes", host + "Expect: 100-continue\r\n"), 417},
        // Framing
        {"a body", line("GET /scenes", host + "Content-Length: 5\r\n") + "hello", 413},
        {"a chunked body", line("GET /scenes", host + "Transfer-Encoding: chunked\r\n") + "0\r\n\r\n", 413},
        {"a posted body", line("POST /scenes", host + "Content-Length: 5\r\n") + "hello", 405},
        {"both framings", line("GET /scenes", host + "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n"),
         400},
        {"two lengths", line("GET /scenes", host + "Content-Length: 0\r\nContent-Length: 0\r\n"), 400},
        {"a list of lengths", line("GET /scenes", host + "Content-Length: 0, 0\r\n"), 400},
        {"a negative length", line("GET /scenes", host + "Content-Length: -1\r\n"), 400},
        {"a signed length", line("GET /scenes", host + "Content-Length: +0\r\n"), 400},
        {"an endless length", line("GET /scenes", host + "Content-Length: " + std::string(30, '9') + "\r\n"),
         400},
        {"an unknown coding", line("GET /scenes", host + "Transfer-Encoding: gzip\r\n"), 400},
        {"chunked not last", line("GET /scenes", host + "Transfer-Encoding: chunked, gzip\r\n"), 400},
        {"chunked in HTTP/1.0", "GET /scenes HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n", 400},
        // Versions and nonsense
        {"HTTP/2.0", "GET /scenes HTTP/2.0\r\nHost: test\r\n\r\n", 400},
        {"HTTP/1.2", "GET /scenes HTTP/1.2\r\nHost: test\r\n\r\n", 400},
        {"no version", "GET /scenes\r\n\r\n", 400},
        {"TLS",
         std::string{"\x16\x03\x01\x00\xa5\x01\x00\x00\xa1\x03\x03"} + std::string(200, 'x') + "\r\n\r\n",
         400},
        {"nonsense", "hello, world\r\n\r\n", 400},
    };
}

TEST(BadInput, GetsTheStatusItDeservesAndTheServerGoesOn) {
    RunningServer running;
    for (const Wrong& wrong : wrong_requests()) {
        RawClient client = running.client();
        client.send(wrong.request);
        const auto reply = client.receive();
        ASSERT_TRUE(reply.has_value()) << wrong.what;
        EXPECT_EQ(reply->status, wrong.status) << wrong.what << ": " << reply->body;
        EXPECT_EQ((*reply)["cache-control"], "no-store") << wrong.what;
        EXPECT_EQ((*reply)["etag"], "") << wrong.what;
        EXPECT_FALSE(reply->body.empty()) << wrong.what;
        EXPECT_EQ((*reply)["allow"], wrong.status == 405 ? "GET, HEAD, OPTIONS" : "") << wrong.what;

        // Either this connection goes on with the next request, or it is closed: it never guesses
        if ((*reply)["connection"] == "keep-alive") {
            EXPECT_EQ(client.get("/healthz").value().status, 200) << wrong.what;
        } else {
            EXPECT_TRUE(client.is_closed()) << wrong.what;
        }
    }
    EXPECT_EQ(running.client().get("/scenes/grey/0/0/0.png").value().status, 200);
}

TEST(BadInput, HonestRequestsOfUnusualFormAreAnswered) {
    RunningServer running;
    for (const std::string& request :
         {line("GET http://other:80/scenes", "Host: test\r\n"), line("GET HTTP://other/scenes"),
          line("GET /%73cenes"), "\r\n\r\n" + line("GET /scenes"), line("GET /scenes", "hOsT:test\r\n"),
          line("GET /scenes", "Host: [::1]:80\r\nContent-Length: 0\r\n"), line("GET /scenes?"),
          std::string{"GET /scenes HTTP/1.0\r\n\r\n"},
          line("GET /scenes/grey/0/0/0.png?accuracy=exact&gutter=0")}) {
        RawClient client = running.client();
        client.send(request);
        const auto reply = client.receive();
        ASSERT_TRUE(reply.has_value()) << request;
        EXPECT_EQ(reply->status, 200) << request << reply->body;
    }
}

/// Requests with bytes changed, dropped, doubled and cut, from one seed.
std::string mutated(std::string text, std::mt19937_64& random) {
    const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
    for (std::size_t changes = 1 + below(6); changes > 0 && !text.empty(); --changes) {
        const std::size_t at = below(text.size());
        switch (below(6)) {
            case 0:
                text[at] = static_cast<char>(random());
                break;
            case 1:
                text.erase(at, 1 + below(8));
                break;
            case 2:
                text.insert(at, text.substr(below(text.size()), below(40)));
                break;
            case 3:
                text[at] = "\r\n\t :/?%&=-,;\"\0*"[below(16)];
                break;
            case 4:
                text.insert(at, std::string(below(3) == 0 ? 9000 : below(300), "a0%/\n"[below(5)]));
                break;
            default:
                text.resize(at);
        }
    }
    return text;
}

TEST(BadInput, ThousandsOfMangledRequestsNeitherCrashNorHangTheServer) {
    ServerOptions options = test::quick_options();
    options.session.head_time = std::chrono::milliseconds{200};
    options.session.idle_time = std::chrono::milliseconds{200};
    RunningServer running{options};
    running.gated->open();
    const std::vector<std::string> honest{
        line("GET /scenes/board/18/1/2.png?gutter=4&accuracy=fast",
             "Host: test\r\nIf-None-Match: \"a\", W/\"b\"\r\n"),
        line("GET /scenes/board/r0-b0a4db0a4db0a4d0/18/1/2.rgba",
             "Host: t\r\nAccept-Encoding: zstd;q=1, gzip\r\n"),
        line("HEAD /scenes/grey/3/1/2.webp", "Host: test:80\r\nPriority: u=2, i\r\nConnection: close\r\n"),
        line("OPTIONS *") + line("GET /scenes/gated") + line("GET /metrics"),
        line("POST /scenes", "Host: test\r\nContent-Length: 3\r\nTransfer-Encoding: chunked\r\n") + "abc"};
    for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937_64 random{seed};
        RawClient client = running.client();
        ASSERT_TRUE(client.connected());
        client.send(mutated(honest[seed % honest.size()], random));
        client.close_sending();
        for (int answers = 0; answers < 20; ++answers) {
            const auto reply = client.receive(true);  // bodies are skipped with the connection
            if (!reply) break;
            ASSERT_GE(reply->status, 200);
            ASSERT_NE(reply->status, 500);
        }
    }
    EXPECT_EQ(running.client().get("/healthz").value().status, 200);
    EXPECT_TRUE(test::eventually([&] { return running.server->metrics().connections.Value() <= 1; }));
}

}  // namespace
}  // namespace tessera
