#include "lattice/inside_distance.h"

#include <algorithm>
#include <array>
#include <limits>

namespace pliant {

namespace {

constexpr std::uint32_t kUnreached = std::numeric_limits<std::uint32_t>::max();

std::uint32_t linkTenths( const Lattice& lattice, std::uint32_t a, std::uint32_t b )
{
	// Two parts of one lattice position are never linked: the difference has one to three axes.
	const auto &p = lattice.coordinate[a], &q = lattice.coordinate[b];
	return kLinkTenths[int( p.x() != q.x() ) + int( p.y() != q.y() ) + int( p.z() != q.z() )];
}

} // namespace

// Moore's search from all surface cells at once, with a ring of buckets as in adapt/bucket_moore.h: no tentative distance is further ahead
// than the longest link. What is linked to the surface asks it, and not the other way round: most of a cut body's cells are surface, and no way
// by a second link is as short as one link.
std::vector<std::uint32_t> floodInside( const Lattice& lattice )
{
	std::vector<std::uint32_t> depth( std::size_t( lattice.cellCount() ), kUnreached );
	std::array<std::vector<std::uint32_t>, kLinkTenths[3] + 1> buckets;
	std::size_t waiting = 0;
	for ( std::uint32_t cell = 0; cell < std::uint32_t( lattice.cellCount() ); ++cell )
	{
		if ( lattice.isSurface[cell] )
		{
			depth[cell] = 0;
			continue;
		}
		for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
		{
			if ( lattice.isSurface[lattice.linkTo[k]] )
			{
				depth[cell] = std::min( depth[cell], linkTenths( lattice, cell, lattice.linkTo[k] ) );
			}
		}
		if ( depth[cell] != kUnreached )
		{
			buckets[depth[cell] % buckets.size()].push_back( cell );
			++waiting;
		}
	}
	std::vector<std::uint32_t> front;
	for ( std::uint32_t reached = 0; waiting > 0; ++reached )
	{
		front.clear();
		front.swap( buckets[reached % buckets.size()] );
		waiting -= front.size();
		for ( const std::uint32_t cell : front )
		{
			if ( depth[cell] != reached )
			{
				continue; // found again by a shorter way
			}
			for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
			{
				const std::uint32_t to = lattice.linkTo[k];
				if ( depth[to] <= reached + kLinkTenths[1] )
				{
					continue; // no link is shorter
				}
				if ( const std::uint32_t distance = reached + linkTenths( lattice, cell, to ); distance < depth[to] )
				{
					depth[to] = distance;
					buckets[distance % buckets.size()].push_back( to );
					++waiting;
				}
			}
		}
	}
	return depth;
}

Vec3 outwardOf( const Lattice& lattice, const std::vector<std::uint32_t>& depth, std::uint32_t cell )
{
	Vec3 out = Vec3::Zero();
	for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
	{
		const std::uint32_t to = lattice.linkTo[k];
		const Vec3 step = ( lattice.coordinate[to] - lattice.coordinate[cell] ).cast<float>();
		const float fall = ( float( depth[cell] ) - float( depth[to] ) ) / float( kLinkTenths[1] );
		out += fall / step.squaredNorm() * step - step.normalized();
	}
	return out;
}

} // namespace pliant
