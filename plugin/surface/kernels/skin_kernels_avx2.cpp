// The skin's kernels in AVX2 encoding: the same operations in fewer instructions. Compiled with -mavx2; called only on processors that have
// it.

#define PLIANT_SKIN_TABLE kSkinAvx2
#define PLIANT_SKIN_NAME "avx2"
#include "surface/kernels/skin_kernel_source.h"
