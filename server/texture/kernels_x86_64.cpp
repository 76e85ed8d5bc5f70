#define KERNEL_SET kernels_x86_64
#define KERNEL_NAME "x86-64"
#include "server/texture/kernels_body.inc"  // NOLINT(bugprone-suspicious-include): compiled once for each set
