#pragma once

// std::vector aligned to cache lines, for arrays that kernels load 16 lanes at a time.

#include "matching/constants.h"

#include <algorithm>
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
	LineAllocator( const LineAllocator<U>& )
	{}

	T* allocate( std::size_t n ) { return static_cast<T*>( ::operator new( n * sizeof( T ), std::align_val_t( kAlignment ) ) ); }
	void deallocate( T* p, std::size_t ) { ::operator delete( p, std::align_val_t( kAlignment ) ); }

	template <class U>
	bool operator==( const LineAllocator<U>& ) const
	{
		return true;
	}
};

template <class T>
using AlignedArray = std::vector<T, LineAllocator<T>>;

/// Reserves `reserved` entries and touches the memory of the first `touched` of them now, so that no page fault occurs at their first use.
template <class T, class A>
void reserveScratch( std::vector<T, A>& array, std::size_t reserved, std::size_t touched )
{
	const std::size_t size = array.size();
	array.reserve( std::max( reserved, touched ) );
	if ( touched > size )
	{
		array.resize( touched );
		array.resize( size );
	}
}

} // namespace pliant
