#pragma once

// A block of soft material for tests of the core, without mesh and world.

#include "body/body.h"
#include "lattice/pieces.h"
#include "support/block_lattice.h"

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

namespace pliant::test {

inline std::unique_ptr<Body> makeBlock( int nx, int ny, int nz, float cellSize, const Material& material = {} )
{
	auto lattice = std::make_shared<Lattice>( makeBlockLattice( nx, ny, nz, cellSize ) );
	Result<std::unique_ptr<Body>> made = Body::create( std::move( lattice ), material, {} );
	return std::move( made.value );
}

/// Returns the links of a block between its cells 3 and 4 along x, in its lowest `most` layers.
inline std::vector<CellLink> linksAtFour( const Lattice& lattice, int most )
{
	std::vector<CellLink> links;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		const bool isHere = lattice.coordinate[i].x() == 3 && lattice.coordinate[i].y() < most;
		for ( std::uint32_t k = lattice.linkStart[i]; isHere && k < lattice.linkStart[i + 1]; ++k )
		{
			if ( const std::uint32_t j = lattice.linkTo[k]; lattice.coordinate[j].x() == 4 )
			{
				links.push_back( CellLink{ std::min( i, j ), std::max( i, j ) } );
			}
		}
	}
	std::sort( links.begin(), links.end() );
	return links;
}

/// Returns nodes at rest, without a body.
inline NodeState restNodes( const Lattice& lattice, float density = 1000.0f )
{
	NodeState nodes;
	nodes.count = lattice.cellCount();
	nodes.padded = ( nodes.count + kLanes - 1 ) / kLanes * kLanes;
	nodes.x.resize( nodes.padded );
	nodes.v.resize( nodes.padded );
	nodes.x0.resize( nodes.padded );
	nodes.mass.assign( nodes.padded, 0.0f );
	nodes.freedom.assign( nodes.padded, 0.0f );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x0.set( i, lattice.restCentre[i] );
		nodes.x.set( i, lattice.restCentre[i] );
		nodes.mass[i] = density * lattice.fill[i] * lattice.cellSize * lattice.cellSize * lattice.cellSize;
		nodes.freedom[i] = 1.0f;
	}
	return nodes;
}

/// Seeded random numbers that are the same on every machine (the standard's distributions are not).
class Seeded
{
public:
	explicit Seeded( unsigned seed ) : m_engine( seed ) {}
	float uniform( float low, float high ) { return low + ( high - low ) * float( m_engine() >> 8 ) * ( 1.0f / 16777216.0f ); }
	Vec3 inBox( float half )
	{
		const float x = uniform( -half, half ), y = uniform( -half, half ), z = uniform( -half, half );
		return { x, y, z };
	}

private:
	std::mt19937 m_engine;
};

/// Returns the root mean square distance of the nodes from the best rigid placement of their rest shape, m.
inline double shapeError( const Body& body )
{
	const Placement fit = body.bestFit();
	double sum = 0.0;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		const Vec3d wanted = fit.rotation * body.nodes().x0.get( i ).cast<double>() + fit.position;
		sum += ( wanted - body.nodes().worldPosition( i ) ).squaredNorm();
	}
	return std::sqrt( sum / body.nodeCount() );
}

/// Performs a whole substep without contacts.
inline BodyHealth substep( Body& body, float h, float alpha, const Vec3& gravity = Vec3::Zero(), TaskRunner* runner = nullptr )
{
	body.accelerateTowardGoals( h, alpha, runner );
	body.applyForces( h, gravity );
	return body.integrate( h );
}

} // namespace pliant::test
