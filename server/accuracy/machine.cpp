#include "server/accuracy/machine.h"

#include <fstream>
#include <thread>

namespace tessera {

std::string machine_words(std::size_t threads) {
    std::string processor = "unknown processor";
    std::ifstream file{"/proc/cpuinfo"};
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name") && line.find(": ") != std::string::npos) {
            processor = line.substr(line.find(": ") + 2);
            break;
        }
#if defined(__x86_64__)
    const char* const set = __builtin_cpu_supports("avx512f") != 0 ? "AVX-512"
                            : __builtin_cpu_supports("avx2") != 0  ? "AVX2"
                                                                   : "SSE2";
#else
    const char* const set = "scalar";
#endif
    return processor + ", " + set + ", " + std::to_string(std::thread::hardware_concurrency()) +
           " processors; pictures on " + std::to_string(threads) + " threads, times on one";
}

}  // namespace tessera
