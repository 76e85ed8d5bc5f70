#pragma once

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace tessera::test {

struct Reply {
    int status = 0;
    std::map<std::string, std::string> fields;  ///< Names in lower case; "set-twice" if one came twice.
    std::string body;

    std::string operator[](const std::string& name) const {
        const auto found = fields.find(name);
        return found == fields.end() ? std::string{} : found->second;
    }
};

/// A client that sends exactly the bytes it is given. Every wait ends after ten seconds.
class RawClient {
  public:
    /// A socket that is not connected yet.
    explicit RawClient() : socket_{::socket(AF_INET, SOCK_STREAM, 0)} {
        const timeval limit{10, 0};
        setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
        setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    }
    explicit RawClient(std::uint16_t port, int receive_buffer = 0) : RawClient{} {
        if (receive_buffer != 0)
            setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
        connect(port);
    }
    void connect(std::uint16_t port) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
    }
    ~RawClient() { close(); }
    RawClient(RawClient&& other) noexcept
        : socket_{std::exchange(other.socket_, -1)},
          connected_{other.connected_},
          input_{std::move(other.input_)} {}
    RawClient& operator=(RawClient&&) = delete;

    bool connected() const { return connected_; }
    void close() {
        if (socket_ >= 0) ::close(std::exchange(socket_, -1));
    }
    void close_sending() { ::shutdown(socket_, SHUT_WR); }
    void shut_down() { ::shutdown(socket_, SHUT_RDWR); }

    bool send(std::string_view bytes) {
        while (!bytes.empty()) {
            const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
            if (count <= 0) return false;
            bytes.remove_prefix(static_cast<std::size_t>(count));
        }
        return true;
    }

    /// The next answer; nothing if the connection ends first, or after the time limit. An answer to HEAD has
    /// no body, whatever its Content-Length.
    std::optional<Reply> receive(bool to_head = false) {
        std::size_t end = 0;
        while ((end = input_.find("\r\n\r\n")) == std::string::npos)
            if (!read_more()) return std::nullopt;
        Reply reply;
        std::string_view head{input_.data(), end + 2};
        if (!head.starts_with("HTTP/1.1 ")) return std::nullopt;
        reply.status = std::atoi(head.data() + 9);
        head.remove_prefix(head.find("\r\n") + 2);
        while (!head.empty()) {
            const std::size_t line_end = head.find("\r\n");
            const std::size_t colon = head.find(": ");
            if (colon == std::string_view::npos || colon > line_end) return std::nullopt;
            std::string name{head.substr(0, colon)};
            std::transform(name.begin(), name.end(), name.begin(),
                           [](unsigned char c) { return std::tolower(c); });
            if (!reply.fields.emplace(name, head.substr(colon + 2, line_end - colon - 2)).second)
                reply.fields["set-twice"] = name;
            head.remove_prefix(line_end + 2);
        }
        input_.erase(0, end + 4);
        const bool bodiless = to_head || reply.status == 204 || reply.status == 304;
        const std::size_t length = bodiless ? 0 : std::strtoull(reply["content-length"].c_str(), nullptr, 10);
        while (input_.size() < length)
            if (!read_more()) return std::nullopt;
        reply.body = input_.substr(0, length);
        input_.erase(0, length);
        return reply;
    }

    /// Whether the server closes the connection within the time limit.
    bool is_closed() {
        while (read_more()) {
        }
        return !timed_out_;
    }

    /// One request with a Host and these further fields, and its answer.
    std::optional<Reply> get(const std::string& target, const std::string& fields = {},
                             const std::string& method = "GET") {
        if (!send(method + " " + target + " HTTP/1.1\r\nHost: test\r\n" + fields + "\r\n"))
            return std::nullopt;
        return receive(method == "HEAD");
    }

  private:
    bool read_more() {
        char block[65536];
        const ssize_t count = ::recv(socket_, block, sizeof block, 0);
        timed_out_ = count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
        if (count <= 0) return false;
        input_.append(block, static_cast<std::size_t>(count));
        return true;
    }

    int socket_ = -1;
    bool connected_ = false;
    bool timed_out_ = false;
    std::string input_;
};

}  // namespace tessera::test
