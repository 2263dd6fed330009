// The kernels in vectors of sixteen. Compiled with -mavx512f and related flags; called only where the processor supports them.

#define PLIANT_LANE_WIDTH 16
#define PLIANT_KERNEL_TABLE kAvx512Kernels
#define PLIANT_KERNEL_NAME "avx512"
#include "matching/kernels/kernel_source.h"
