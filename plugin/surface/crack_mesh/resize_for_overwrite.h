#pragma once

// Room for what is written anew from end to end.

#include <cstddef>
#include <vector>

namespace pliant {

/// `count` entries, of whatever values: what was there is not carried along where the memory has to grow, and it grows by an eighth more.
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
