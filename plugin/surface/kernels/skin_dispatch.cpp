// Selects the skin's kernel table for this processor. Compiled for the baseline only.

#include "matching/kernels/kernels.h"
#include "surface/kernels/skin_kernels.h"

namespace pliant {

extern const SkinKernels kSkinBaseline;
#if defined( PLIANT_X86_KERNELS )
extern const SkinKernels kSkinAvx2;
#endif

const SkinKernels& plainSkinKernels()
{
	return kSkinBaseline;
}

const SkinKernels& bestSkinKernels()
{
#if defined( PLIANT_X86_KERNELS )
	return findKernels( KernelTarget::Avx2 ) ? kSkinAvx2 : kSkinBaseline;
#else
	return kSkinBaseline;
#endif
}

} // namespace pliant
