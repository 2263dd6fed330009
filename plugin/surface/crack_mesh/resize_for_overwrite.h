#pragma once

// Resizing of vectors whose entries are all overwritten.

#include <cstddef>
#include <vector>

namespace pliant {

/// Resizes to `count` entries of unspecified value. Growing does not copy old entries, and reserves an eighth more.
template <class T>
void resizeForOverwrite( std::vector<T>& list, std::size_t count )
{
	if ( count > list.capacity() )
	{
		std::vector<T>().swap( list );
		list.reserve( count + count / 8 );
	}
	list.resize( count );
}

} // namespace pliant
