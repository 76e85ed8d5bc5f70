#pragma once

#include <cstddef>
#include <string>

namespace tessera {

/// What times depend on: processor, instruction set, how many threads drew pictures (times are one thread's).
std::string machine_words(std::size_t threads);

}  // namespace tessera
