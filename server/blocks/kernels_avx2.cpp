#define BLOCK_KERNEL_SET block_kernels_avx2
#include "server/blocks/kernels_body.inc"  // NOLINT(bugprone-suspicious-include): compiled once for each set
