// The skin's kernels for every processor.

#define PLIANT_SKIN_TABLE kSkinBaseline
#define PLIANT_SKIN_NAME "baseline"
#include "surface/kernels/skin_kernel_source.h"
