#define BLOCK_KERNEL_SET block_kernels_x86_64
#include "server/blocks/kernels_body.inc"  // NOLINT(bugprone-suspicious-include): compiled once for each set
