// The kernels in vectors of eight. Compiled with -mavx2; called only where the processor supports it.

#define PLIANT_LANE_WIDTH 8
#define PLIANT_KERNEL_TABLE kAvx2Kernels
#define PLIANT_KERNEL_NAME "avx2"
#include "matching/kernels/kernel_source.h"
