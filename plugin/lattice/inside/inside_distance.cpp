#include "lattice/inside/inside_distance.h"

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

namespace {

/// Moore's search, with a ring of buckets as in adapt/octree/bucket_moore.h: no tentative distance is ahead by more than the longest link.
class Flood
{
public:
	Flood( const Lattice& lattice, std::vector<std::uint32_t>& depth ) : m_lattice( lattice ), m_depth( depth ) {}

	/// Adds a cell at its current depth.
	void add( std::uint32_t cell )
	{
		m_buckets[m_depth[cell] % m_buckets.size()].push_back( cell );
		++m_waiting;
	}

	void run()
	{
		std::vector<std::uint32_t> front;
		for ( std::uint32_t reached = 0; m_waiting > 0; ++reached )
		{
			front.clear();
			front.swap( m_buckets[reached % m_buckets.size()] );
			m_waiting -= front.size();
			for ( const std::uint32_t cell : front )
			{
				if ( m_depth[cell] == reached ) // otherwise a shorter path has reached it
				{
					spread( cell );
				}
			}
		}
	}

private:
	void spread( std::uint32_t cell )
	{
		const std::uint32_t reached = m_depth[cell];
		for ( std::uint32_t k = m_lattice.linkStart[cell]; k < m_lattice.linkStart[cell + 1]; ++k )
		{
			const std::uint32_t to = m_lattice.linkTo[k];
			if ( m_depth[to] <= reached + kLinkTenths[1] )
			{
				continue; // no link is shorter
			}
			if ( const std::uint32_t distance = reached + linkTenths( m_lattice, cell, to ); distance < m_depth[to] )
			{
				m_depth[to] = distance;
				add( to );
			}
		}
	}

	const Lattice& m_lattice;
	std::vector<std::uint32_t>& m_depth;
	std::array<std::vector<std::uint32_t>, kLinkTenths[3] + 1> m_buckets;
	std::size_t m_waiting = 0;
};

} // namespace

// Floods from all surface cells at once. Inner cells next to the surface read it, rather than surface cells spreading: most cells of a cut
// body are surface, and no path of two links is as short as one link.
std::vector<std::uint32_t> floodInside( const Lattice& lattice )
{
	std::vector<std::uint32_t> depth( std::size_t( lattice.cellCount() ), kUnreached );
	Flood flood( lattice, depth );
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
			flood.add( cell );
		}
	}
	flood.run();
	return depth;
}

bool updateInside( const Lattice& lattice, const std::vector<std::uint32_t>& touched, std::vector<std::uint32_t>& depth )
{
	if ( touched.empty() ||
		std::any_of( touched.begin(), touched.end(), [&lattice]( std::uint32_t cell ) { return lattice.isSurface[cell] == 0; } ) )
	{
		return false;
	}
	Flood flood( lattice, depth );
	for ( const std::uint32_t cell : touched )
	{
		depth[cell] = 0;
		flood.add( cell );
	}
	flood.run();
	return true;
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
