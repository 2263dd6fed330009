#include "archive/archive.h"

#include <algorithm>

namespace pliant {

namespace {

// Odd numbers with bits in no order: a product with one of them mixes all lower bits into the higher ones.
constexpr std::uint64_t kMix[8] = { 0x9e3779b97f4a7c15u, 0xc2b2ae3d27d4eb4fu, 0x165667b19e3779f9u, 0xd6e8feb86659fd93u, 0x85ebca77c2b2ae63u,
	0x27d4eb2f165667c5u, 0xff51afd7ed558ccdu, 0xc4ceb9fe1a85ec53u };
constexpr std::size_t kLanes = 4; // independent of one another, so that a processor works on all at once

std::uint64_t wordAt( const std::byte* data )
{
	std::uint64_t word = 0;
	std::memcpy( &word, data, sizeof( word ) );
	return word;
}

std::uint64_t mixed( std::uint64_t lane, std::uint64_t word, std::uint64_t factor )
{
	return std::rotl( ( lane ^ word ) * factor, 29 );
}

/// Four words for one product, which takes longer than the rest.
std::uint64_t mixedFour( std::uint64_t lane, const std::byte* words, std::uint64_t factor )
{
	lane ^= wordAt( words );
	lane = std::rotl( lane, 37 ) + wordAt( words + sizeof( lane ) );
	lane = std::rotl( lane, 23 ) ^ wordAt( words + 2 * sizeof( lane ) );
	return mixed( std::rotl( lane, 37 ) + wordAt( words + 3 * sizeof( lane ) ), 0, factor );
}

} // namespace

void Archive::grow( std::size_t size )
{
	const std::size_t before = written();
	m_to->resize( std::max( before + size, 2 * m_to->size() ) );
	m_at = m_to->data() + before;
	m_limit = m_to->data() + m_to->size();
}

std::size_t Archive::open()
{
	std::uint64_t length = 0;
	raw( &length, sizeof( length ) );
	return written();
}

void Archive::close( std::size_t opened )
{
	const std::uint64_t length = written() - opened;
	std::memcpy( m_to->data() + opened - sizeof( length ), &length, sizeof( length ) );
}

Archive Archive::part()
{
	std::uint64_t length = 0;
	value( length );
	require( length <= left(), "A part is longer than the data." );
	Archive inner( m_from, isSound() ? std::size_t( length ) : 0 );
	inner.m_problem = m_problem;
	inner.m_isTrusted = m_isTrusted;
	m_from += isSound() ? std::ptrdiff_t( length ) : 0;
	return inner;
}

const std::byte* Archive::take( std::size_t size )
{
	if ( !isSound() )
	{
		return nullptr;
	}
	if ( size > std::size_t( m_end - m_from ) )
	{
		refuse( "The data ends too early." );
		return nullptr;
	}
	const std::byte* const first = m_from;
	m_from += size;
	return first;
}

// A word changes its lane bijectively: each step can be undone, so that no difference is lost.
std::uint64_t hashOf( const std::byte* data, std::size_t size, std::uint64_t seed )
{
	std::uint64_t lane[kLanes];
	for ( std::size_t k = 0; k < kLanes; ++k )
	{
		lane[k] = seed ^ kMix[kLanes + k];
	}
	constexpr std::size_t kWords = 4 * sizeof( std::uint64_t ); // bytes that a lane takes at a time
	std::size_t at = 0;
	for ( ; at + kLanes * kWords <= size; at += kLanes * kWords )
	{
		for ( std::size_t k = 0; k < kLanes; ++k )
		{
			lane[k] = mixedFour( lane[k], data + at + k * kWords, kMix[k] );
		}
	}
	std::uint64_t hash = std::uint64_t( size ) * kMix[0];
	for ( std::size_t k = 0; k < kLanes; ++k )
	{
		hash = mixed( hash, lane[k], kMix[k] );
	}
	for ( ; at < size; ++at )
	{
		hash = mixed( hash, std::uint64_t( data[at] ), kMix[1] );
	}
	return ( hash ^ hash >> 32 ) * kMix[2];
}

} // namespace pliant
