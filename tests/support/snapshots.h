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

/// The data that two worlds in equal states have in common.
inline Bytes stateOf( const SoftBodyHost& world )
{
	Bytes bytes;
	SaveSettings settings;
	settings.withTemplates = false;
	settings.forComparison = true;
	const Status status = saveWorld( world, bytes, settings );
	EXPECT_TRUE( status.ok() ) << status.sentence;
	return bytes;
}

/// The same snapshot as if another process had written it: all of it is validated.
inline Bytes foreign( Bytes bytes )
{
	constexpr std::size_t kOrigin = 32; // Header::origin in snapshot_format.cpp
	bytes[kOrigin] ^= std::byte( 1 );
	return bytes;
}

inline testing::AssertionResult areEqual( const Bytes& a, const Bytes& b )
{
	const auto different = std::mismatch( a.begin(), a.begin() + std::ptrdiff_t( std::min( a.size(), b.size() ) ), b.begin() );
	return a == b ? testing::AssertionSuccess()
				  : testing::AssertionFailure()
			<< "of " << a.size() << " and " << b.size() << " bytes, the first different one is " << different.first - a.begin();
}

} // namespace pliant::test
