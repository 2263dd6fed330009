#pragma once

// Snapshots in tests: worlds that are saved, restored and compared.

#include "pliant/io/snapshot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

namespace pliant::test {

using Bytes = std::vector<std::byte>;

inline Bytes savedWorld( const SoftBodyHost& world, bool withTemplates = false )
{
	Bytes bytes;
	SaveSettings settings;
	settings.withTemplates = withTemplates;
	const Status status = saveWorld( world, bytes, settings );
	EXPECT_TRUE( status.ok() ) << status.sentence;
	return bytes;
}

/// The same snapshot as another process would have written it: nothing in it is taken on trust.
inline Bytes foreign( Bytes bytes )
{
	constexpr std::size_t kOrigin = 32; // Header::origin in snapshot_format.cpp
	bytes[kOrigin] ^= std::byte( 1 );
	return bytes;
}

/// The first byte that differs, of those that both have; the shorter size if there is none.
inline std::size_t firstDifference( const Bytes& a, const Bytes& b )
{
	constexpr std::size_t kHeader = 40;
	std::size_t at = std::min( kHeader, std::min( a.size(), b.size() ) );
	while ( at < std::min( a.size(), b.size() ) && a[at] == b[at] )
	{
		++at;
	}
	return at;
}

} // namespace pliant::test
