#pragma once

// std::vector on cache-line borders, for arrays that kernels load 16 lanes at a time.

#include "matching/constants.h"

#include <cstdlib>
#include <new>
#include <vector>

namespace pliant {

template <class T>
struct LineAllocator
{
	using value_type = T;

	LineAllocator() = default;
	template <class U>
	LineAllocator( const LineAllocator<U>& ) {}

	T* allocate( std::size_t n ) { return static_cast<T*>( ::operator new( n * sizeof( T ), std::align_val_t( kAlignment ) ) ); }
	void deallocate( T* p, std::size_t ) { ::operator delete( p, std::align_val_t( kAlignment ) ); }

	template <class U>
	bool operator==( const LineAllocator<U>& ) const { return true; }
};

template <class T>
using AlignedArray = std::vector<T, LineAllocator<T>>;

} // namespace pliant
