#pragma once

#include <string>

#include "proto/edit.pb.h"

#include "shared/result/result.h"

namespace tessera {

/// A running server, asked from a command: waits for each answer, at most half a minute.
class ServerClient {
  public:
    /// `address`: "http://127.0.0.1:7070". `token`: empty, where none is needed. Error: invalid_input, for
    /// what is no such address.
    static Result<ServerClient> of(const std::string& address, std::string token);

    /// The fingerprint of a scene, as its description says. Errors: io_failure, where there is no answer;
    /// invalid_input, in the server's words.
    Result<std::string> fingerprint(const std::string& scene) const;

    /// Sends an edit, with its id, again where the answer was lost. Errors as of fingerprint().
    Result<proto::EditAnswer> edit(const std::string& scene, const proto::Edit& edit) const;

  private:
    struct Reply {
        unsigned status = 0;
        std::string body;
    };
    ServerClient(std::string host, std::string port, std::string token)
        : host_{std::move(host)}, port_{std::move(port)}, token_{std::move(token)} {}
    Result<Reply> ask(bool post, const std::string& target, const std::string& body) const;
    std::string address() const;

    std::string host_, port_, token_;
};

}  // namespace tessera
