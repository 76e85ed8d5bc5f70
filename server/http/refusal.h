#pragma once

#include <string>

namespace tessera {

/// A request that is answered with an error status.
struct Refusal {
    unsigned status = 400;
    std::string why;     ///< One line for whoever wrote the client: what is wrong and how to mend it.
    bool close = false;  ///< Where this request ends is unsure: nothing after it may be read.
};

}  // namespace tessera
