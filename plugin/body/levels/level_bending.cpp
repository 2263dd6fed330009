// Refines thin parts that bend: the deformation of a node does not show it where the part is one node thick, and shows too little of it
// where it is a few (fracture/face_stretch.h).

#include "body/constants.h"
#include "body/levels/levels.h"
#include "fracture/constants.h"
#include "fracture/thin_cells.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pliant {

namespace {

/// Finds the pairs of a node's neighbours that lie on opposite sides of it along the part, the nearest first, in different directions.
template <class Bend>
void findPairs( const NodeState& nodes, const ThinCell& thin, float outside, const std::vector<std::uint32_t>& around, Bend& bend )
{
	struct Candidate
	{
		float square;
		std::uint32_t a, b;
		Vec3 direction;
	};
	std::vector<Candidate> found;
	const Vec3 middle = nodes.x0.get( int( bend.node ) );
	for ( std::size_t k = 0; k < around.size(); ++k )
	{
		for ( std::size_t l = k + 1; l < around.size(); ++l )
		{
			const Vec3 a = nodes.x0.get( int( around[k] ) ) - middle, b = nodes.x0.get( int( around[l] ) ) - middle;
			const float square = ( b - a ).squaredNorm();
			const Vec3 direction = ( b - a ) / std::sqrt( square );
			const float across = std::max( std::fabs( direction.dot( thin.normal[0] ) ), std::fabs( direction.dot( thin.normal[1] ) ) );
			if ( ( a + b ).squaredNorm() < kPairAsymmetry * kPairAsymmetry * square && across < kPairAcross )
			{
				found.push_back( { square, around[k], around[l], direction } );
			}
		}
	}
	std::sort( found.begin(), found.end(), []( const Candidate& one, const Candidate& other ) {
		return one.square != other.square ? one.square < other.square : one.a != other.a ? one.a < other.a : one.b < other.b;
	} );
	std::vector<Vec3> taken;
	for ( const Candidate& candidate : found )
	{
		const auto isNear = [&]( const Vec3& direction ) { return std::fabs( direction.dot( candidate.direction ) ) > kPairsApart; };
		if ( taken.size() < std::size( bend.pair ) && std::none_of( taken.begin(), taken.end(), isNear ) )
		{
			const float rest = ( nodes.x0.get( int( candidate.a ) ) + nodes.x0.get( int( candidate.b ) ) - 2.0f * middle ).squaredNorm();
			bend.pair[taken.size()] = { candidate.a, candidate.b, rest, 4.0f * outside / candidate.square };
			taken.push_back( candidate.direction );
		}
	}
	bend.pairs = int( taken.size() );
}

/// How far the part's face lies outside of what a node's deformation is measured of, m: its links have their middle half a node below it. 0
/// where the node is not at a face. `offset`: of the node from a cell of it.
float outsideOf( const ThinCell& cell, const Vec3& offset, float size )
{
	float most = 0.0f;
	for ( int k = 0; k < cell.normals; ++k )
	{
		const float height = std::fabs( cell.height[k] + cell.normal[k].dot( offset ) );
		most = cell.half[k] - height < kAtFace * size ? std::max( most, cell.half[k] - height + std::min( height, 0.5f * size ) ) : most;
	}
	return most;
}

} // namespace

void Levels::findBends( const NodeState& nodes, const std::vector<ThinCell>& thin )
{
	if ( m_bends.isKnown && m_bends.version == m_version && m_bends.thinCells == thin.size() )
	{
		return;
	}
	m_bends.isKnown = true;
	m_bends.version = m_version;
	m_bends.thinCells = thin.size();
	m_bends.node.clear();
	std::vector<std::uint8_t> isDone( m_cut.node.size(), 0 );
	std::vector<std::uint32_t> around;
	for ( const ThinCell& cell : thin )
	{
		const std::uint32_t node = m_cut.slotOfCell[cell.cell];
		if ( isDone[node] != 0 )
		{
			continue;
		}
		isDone[node] = 1;
		around.assign( matrix().member.begin() + matrix().start[node], matrix().member.begin() + matrix().start[node + 1] );
		around.erase( std::remove( around.begin(), around.end(), node ), around.end() );
		Bends::Node bend;
		bend.node = node;
		const float size = m_lattice->cellSize * float( 1 << levelOf( int( node ) ) );
		findPairs( nodes, cell, outsideOf( cell, nodes.x0.get( int( node ) ) - m_lattice->restCentre[cell.cell], size ), around, bend );
		if ( bend.pairs > 0 && bend.pair[0].scale > 0.0f )
		{
			m_bends.node.push_back( bend );
		}
	}
}

// As FaceStretch::roughBending, at the part's outer face.
void Levels::addBending( const NodeState& nodes )
{
	for ( const Bends::Node& bend : m_bends.node )
	{
		const Vec3 middle = 2.0f * nodes.x.get( int( bend.node ) );
		float most = 0.0f;
		for ( int k = 0; k < bend.pairs; ++k )
		{
			const ThinCell::Pair& pair = bend.pair[k];
			most = std::max( most, pair.bendingSquare( nodes.x.get( int( pair.a ) ) + nodes.x.get( int( pair.b ) ) - middle ) );
		}
		m_load[bend.node] += std::sqrt( most ) / m_refineStretch;
	}
}

} // namespace pliant
