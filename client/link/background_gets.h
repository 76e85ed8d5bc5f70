#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "client/link/http_connection.h"

namespace tessera {

/// Things that are asked for by HTTP one after the other, on a thread of its own, for callers that must not
/// wait. Every call is safe from any thread, and none waits.
class BackgroundGets {
  public:
    explicit BackgroundGets(ServerAddress server, HttpLimits limits = {});
    ~BackgroundGets();  ///< Closes the connection, forgets what is under way, joins the thread.
    BackgroundGets(const BackgroundGets&) = delete;
    BackgroundGets& operator=(const BackgroundGets&) = delete;

    /// False: 64 are out that have not been taken yet.
    bool ask(std::string target);

    struct Got {
        std::string target;
        Result<HttpReply> reply;
    };
    /// What has come, or failed, in the order in which it was asked for.
    std::vector<Got> take(std::size_t most = static_cast<std::size_t>(-1));

  private:
    class Worker;
    std::unique_ptr<Worker> worker_;
};

}  // namespace tessera
