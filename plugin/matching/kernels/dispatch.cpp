// Selects the kernel table for this processor. Compiled for the baseline only.

#include "matching/kernels/kernels.h"

#include <initializer_list>

namespace pliant {

extern const Kernels kBaselineKernels;
#if defined( PLIANT_X86_KERNELS )
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;
#endif

const Kernels* findKernels( KernelTarget target )
{
#if defined( PLIANT_X86_KERNELS )
	if ( target == KernelTarget::Avx512 )
	{
		const bool has = __builtin_cpu_supports( "avx512f" ) && __builtin_cpu_supports( "avx512vl" ) &&
			__builtin_cpu_supports( "avx512dq" );
		return has ? &kAvx512Kernels : nullptr;
	}
	if ( target == KernelTarget::Avx2 )
	{
		return __builtin_cpu_supports( "avx2" ) ? &kAvx2Kernels : nullptr;
	}
#endif
	return target == KernelTarget::Baseline ? &kBaselineKernels : nullptr;
}

const Kernels& bestKernels()
{
	for ( KernelTarget target : { KernelTarget::Avx512, KernelTarget::Avx2 } )
	{
		if ( const Kernels* found = findKernels( target ) )
		{
			return *found;
		}
	}
	return kBaselineKernels;
}

} // namespace pliant
