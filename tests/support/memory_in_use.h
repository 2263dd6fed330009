#pragma once

#include <cstddef>

#ifdef __GLIBC__
	#include <malloc.h>
#endif

namespace pliant::test {

/// Returns all memory in use, bytes; 0 where it is unknown.
inline std::size_t memoryInUse()
{
#ifdef __GLIBC__
	const struct mallinfo2 now = mallinfo2();
	return now.uordblks + now.hblkhd;
#else
	return 0;
#endif
}

} // namespace pliant::test
