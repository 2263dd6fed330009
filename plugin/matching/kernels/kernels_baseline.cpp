// The kernels in vectors of four: SSE2 on x86-64, NEON on ARM.

#define PLIANT_LANE_WIDTH 4
#define PLIANT_KERNEL_TABLE kBaselineKernels
#define PLIANT_KERNEL_NAME "baseline"
#include "matching/kernels/kernel_source.h"
