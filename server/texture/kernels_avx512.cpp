#if defined(__GNUC__) && !defined(__clang__)
// GCC 12 warns of its own intrinsics (its bug 105593)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#define KERNEL_SET kernels_avx512
#define KERNEL_NAME "avx512"
#include "server/texture/kernels_body.inc"  // NOLINT(bugprone-suspicious-include): compiled once for each set
