#define KERNEL_SET kernels_avx2
#define KERNEL_NAME "avx2"
#include "server/texture/kernels_body.inc"  // NOLINT(bugprone-suspicious-include): compiled once for each set
