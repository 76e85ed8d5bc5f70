#include "server/blocks/kernels.h"

#include <string_view>

#include "server/texture/kernels.h"

namespace tessera {

namespace block_kernels_x86_64 {
extern const BlockKernels table;
}
#ifdef __x86_64__
namespace block_kernels_avx2 {
extern const BlockKernels table;
}
namespace block_kernels_avx512 {
extern const BlockKernels table;
}
#endif

const BlockKernels* block_kernels_of(const char* name) noexcept {
    const std::string_view asked{name};
    const KernelList list = available_kernels();
    for (std::size_t i = 0; i < list.count; ++i) {
        if (asked != list.items[i]->name) continue;
#ifdef __x86_64__
        if (asked == "avx2") return &block_kernels_avx2::table;
        if (asked == "avx512") return &block_kernels_avx512::table;
#endif
        return &block_kernels_x86_64::table;
    }
    return nullptr;
}

const BlockKernels& block_kernels() noexcept {
    static const BlockKernels& chosen = *block_kernels_of(kernels().name);
    return chosen;
}

}  // namespace tessera
