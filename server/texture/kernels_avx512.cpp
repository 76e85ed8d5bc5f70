#define KERNEL_SET kernels_avx512
#define KERNEL_NAME "avx512"
#include "server/texture/kernels_body.inc"  // NOLINT(bugprone-suspicious-include): compiled once for each set
