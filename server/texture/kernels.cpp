#include "server/texture/kernels.h"

#include <array>
#include <cstdlib>
#include <string_view>

#include "shared/math/srgb.h"

namespace tessera {

namespace kernels_x86_64 {
extern const Kernels table;
}
#ifdef __x86_64__
namespace kernels_avx2 {
extern const Kernels table;
}
namespace kernels_avx512 {
extern const Kernels table;
}
#endif

KernelList available_kernels() noexcept {
    KernelList list;
    list.items[list.count++] = &kernels_x86_64::table;
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) list.items[list.count++] = &kernels_avx2::table;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
        list.items[list.count++] = &kernels_avx512::table;
#endif
    return list;
}

const std::uint16_t* last_steps_of_codes() noexcept {
    static const auto table = [] {
        std::array<std::uint16_t, 256> last{};
        for (std::size_t step = 0; step < steps_to_srgb().size(); ++step)
            last[steps_to_srgb()[step]] = static_cast<std::uint16_t>(step);
        return last;
    }();
    return table.data();
}

const Kernels& kernels() noexcept {
    static const Kernels* const chosen = [] {
        const KernelList list = available_kernels();
        const char* asked = std::getenv("TESSERA_KERNELS");
        for (std::size_t i = 0; asked != nullptr && i < list.count; ++i)
            if (std::string_view{asked} == list.items[i]->name) return list.items[i];
        return list.items[list.count - 1];
    }();
    return *chosen;
}

}  // namespace tessera
