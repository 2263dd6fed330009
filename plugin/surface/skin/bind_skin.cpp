// Computes which nodes move a vertex. Steinemann et al. 2008, section 7; trilinear embedding: Rivers and James 2007, section 4.

#include "surface/constants.h"
#include "surface/skin/cell_finder.h"
#include "surface/skin/skinning.h"

#include "lattice/union_find.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace pliant {

namespace {

constexpr std::uint32_t kNoGroup = std::numeric_limits<std::uint32_t>::max();

/// ( 1 - r^2 / R^2 )^2 within R, with zero slope at R, so that weights change smoothly over the material.
double nearbyWeight( const Vec3d& fromMiddle )
{
	const double rest = 1.0 - fromMiddle.squaredNorm() / ( kSkinSupport * kSkinSupport );
	return rest > 0.0 ? rest * rest : 0.0;
}

/// The cell's weight in the cube of eight cell centres that contains the point.
double trilinearWeight( const Vec3d& fromMiddle )
{
	return ( 1.0 - fromMiddle.array().abs() ).max( 0.0 ).prod();
}

/// Coincident vertices, treated as one.
struct WeldedPoint
{
	Vec3d position = Vec3d::Zero(); ///< mesh coordinates, m
	Vec3d outward = Vec3d::Zero();  ///< area-weighted normal of the rest mesh, unit, or zero
	std::uint32_t first = 0;        ///< range in the table of node weights
	std::uint32_t last = 0;
};

struct NodeWeight
{
	std::uint32_t node;
	double weight;
};

Vec3d meshVertex( const MeshView& mesh, std::size_t i )
{
	const float* p = mesh.positions + i * mesh.positionStride;
	return { p[0], p[1], p[2] };
}

void numberGroups( const MeshView& mesh, const std::vector<std::uint32_t>& weldedVertex, SkinBinding& binding )
{
	std::vector<std::uint32_t> number( mesh.vertexCount, kNoGroup );
	binding.normalGroup.resize( mesh.vertexCount );
	for ( std::size_t i = 0; i < mesh.vertexCount; ++i )
	{
		std::uint32_t& group = number[weldedVertex.empty() ? i : weldedVertex[i]];
		if ( group == kNoGroup )
		{
			group = std::uint32_t( binding.normalGroups++ );
		}
		binding.normalGroup[i] = group;
	}
}

std::vector<WeldedPoint> makePoints( const MeshView& mesh, const SkinBinding& binding )
{
	std::vector<WeldedPoint> points( binding.normalGroups );
	for ( std::size_t i = mesh.vertexCount; i-- > 0; ) // the first vertex of a group gives its position
	{
		points[binding.normalGroup[i]].position = meshVertex( mesh, i );
	}
	for ( std::size_t t = 0; t < mesh.triangleCount; ++t )
	{
		const std::uint32_t* corner = mesh.indices + 3 * t;
		const Vec3d a = meshVertex( mesh, corner[0] ), b = meshVertex( mesh, corner[1] ), c = meshVertex( mesh, corner[2] );
		const Vec3d area = ( b - a ).cross( c - a );
		for ( int k = 0; k < 3; ++k )
		{
			points[binding.normalGroup[corner[k]]].outward += area;
		}
	}
	for ( WeldedPoint& point : points )
	{
		// Scaled by the largest component first: the square of a tiny triangle's area would underflow.
		const double largest = point.outward.cwiseAbs().maxCoeff();
		if ( largest > 0.0 )
		{
			point.outward = ( point.outward / largest ).normalized();
		}
	}
	return points;
}

class Binder
{
public:
	Binder( const Lattice& lattice, Skinning kind ) :
		m_lattice( lattice ), m_kind( kind ), m_finder( lattice ), m_mark( lattice.restCentre.size(), 0 )
	{}

	/// Returns 1 where the nearest material lies behind the surface, -1 where it lies in front, 0 where it is undetermined.
	int sideOfMaterial( const WeldedPoint& point )
	{
		m_finder.cellsAround( m_finder.positionOf( point.position ), m_around );
		if ( m_around.empty() )
		{
			return 0;
		}
		const double front = m_finder.inFront( m_finder.owner( point.position, Vec3d::Zero(), m_around ), point.position, point.outward );
		return front < 0.0 ? 1 : front > 0.0 ? -1 : 0;
	}

	/// Appends the point's node weights, which sum to 1.
	void bind( const WeldedPoint& point, bool isInsideOut, std::vector<NodeWeight>& nodeWeights )
	{
		m_finder.cellsAround( m_finder.positionOf( point.position ), m_around );
		const Vec3d outward = isInsideOut ? Vec3d( -point.outward ) : point.outward;
		const std::uint32_t owner = std::uint32_t( m_finder.owner( point.position, outward, m_around ) );
		const std::size_t first = nodeWeights.size();
		double sum = 0.0;
		markLinks( owner );
		for ( const std::uint32_t cell : m_around )
		{
			const Vec3d away = m_finder.fromMiddle( int( cell ), point.position );
			const double weight = m_kind == Skinning::Trilinear ? trilinearWeight( away ) : nearbyWeight( away );
			if ( weight > 0.0 && isWithinTwoLinks( cell ) )
			{
				nodeWeights.push_back( NodeWeight{ cell, weight } );
			}
		}
		keepHeaviest( first, nodeWeights );
		for ( std::size_t k = first; k < nodeWeights.size(); ++k )
		{
			sum += nodeWeights[k].weight;
		}
		if ( nodeWeights.size() == first ) // out of reach of every cell
		{
			nodeWeights.push_back( NodeWeight{ owner, 1.0 } );
			return;
		}
		for ( std::size_t k = first; k < nodeWeights.size(); ++k )
		{
			nodeWeights[k].weight /= sum;
		}
	}

private:
	/// Of the entries from `first` on, keeps the kMostCarriers heaviest, by ascending node: thin parts may have several cells at one place.
	static void keepHeaviest( std::size_t first, std::vector<NodeWeight>& entries )
	{
		if ( entries.size() - first > kMostCarriers )
		{
			const auto begin = entries.begin() + std::ptrdiff_t( first );
			std::stable_sort( begin, entries.end(), []( const NodeWeight& a, const NodeWeight& b ) { return a.weight > b.weight; } );
			entries.resize( first + kMostCarriers );
			std::sort( begin, entries.end(), []( const NodeWeight& a, const NodeWeight& b ) { return a.node < b.node; } );
		}
	}

	/// Marks a cell and those one link away.
	void markLinks( std::uint32_t owner )
	{
		++m_round;
		m_mark[owner] = m_round;
		for ( std::uint32_t k = m_lattice.linkStart[owner]; k < m_lattice.linkStart[owner + 1]; ++k )
		{
			m_mark[m_lattice.linkTo[k]] = m_round;
		}
	}

	/// Two links reach all of the 27 cells around, wherever among them the owner is, as long as the material between is connected; cells
	/// across a gap are further away.
	bool isWithinTwoLinks( std::uint32_t cell ) const
	{
		if ( m_mark[cell] == m_round )
		{
			return true;
		}
		const auto first = m_lattice.linkTo.begin() + m_lattice.linkStart[cell],
				   last = m_lattice.linkTo.begin() + m_lattice.linkStart[cell + 1];
		return std::any_of( first, last, [this]( std::uint32_t other ) { return m_mark[other] == m_round; } );
	}

	const Lattice& m_lattice;
	Skinning m_kind;
	CellFinder m_finder;
	std::vector<std::uint32_t> m_mark; ///< equals m_round for cells marked for the current point
	std::uint32_t m_round = 0;
	std::vector<std::uint32_t> m_around;
};

/// Finds connected parts whose triangles face inwards, by a vote of their vertices: input meshes may have any orientation.
std::vector<std::uint8_t> findInsideOut(
	const MeshView& mesh, const SkinBinding& binding, const std::vector<WeldedPoint>& points, Binder& binder )
{
	UnionFind shells( points.size() );
	for ( std::size_t t = 0; t < mesh.triangleCount; ++t )
	{
		const std::uint32_t* corner = mesh.indices + 3 * t;
		shells.join( binding.normalGroup[corner[0]], binding.normalGroup[corner[1]] );
		shells.join( binding.normalGroup[corner[0]], binding.normalGroup[corner[2]] );
	}
	std::vector<std::int64_t> votes( points.size(), 0 );
	for ( std::size_t g = 0; g < points.size(); ++g )
	{
		votes[shells.find( std::uint32_t( g ) )] += binder.sideOfMaterial( points[g] );
	}
	std::vector<std::uint8_t> isInsideOut( points.size() );
	for ( std::size_t g = 0; g < points.size(); ++g )
	{
		isInsideOut[g] = votes[shells.find( std::uint32_t( g ) )] < 0;
	}
	return isInsideOut;
}

} // namespace

SkinBinding bindSkin( const MeshView& mesh, const Lattice& lattice, const std::vector<std::uint32_t>& weldedVertex, Skinning kind )
{
	SkinBinding binding;
	binding.kind = kind;
	if ( kind == Skinning::None )
	{
		return binding;
	}
	numberGroups( mesh, weldedVertex, binding );
	std::vector<WeldedPoint> points = makePoints( mesh, binding );
	Binder binder( lattice, kind );
	const std::vector<std::uint8_t> isInsideOut = findInsideOut( mesh, binding, points, binder );
	std::vector<NodeWeight> nodeWeights;
	for ( std::size_t g = 0; g < points.size(); ++g )
	{
		points[g].first = std::uint32_t( nodeWeights.size() );
		binder.bind( points[g], isInsideOut[g] != 0, nodeWeights );
		points[g].last = std::uint32_t( nodeWeights.size() );
	}

	binding.start.reserve( mesh.vertexCount + 1 );
	binding.start.push_back( 0 );
	binding.restPosition.reserve( mesh.vertexCount );
	binding.restNormal.reserve( mesh.vertexCount );
	for ( std::size_t i = 0; i < mesh.vertexCount; ++i )
	{
		// Vertices of one point have identical weights, so no seam can open between them.
		const WeldedPoint& point = points[binding.normalGroup[i]];
		for ( std::uint32_t k = point.first; k < point.last; ++k )
		{
			binding.node.push_back( nodeWeights[k].node );
			binding.weight.push_back( float( nodeWeights[k].weight ) );
		}
		binding.start.push_back( std::uint32_t( binding.node.size() ) );
		binding.restPosition.push_back( ( meshVertex( mesh, i ) - lattice.massCentre ).cast<float>() );
		binding.restNormal.push_back( point.outward.isZero( 0.0 ) ? Vec3( Vec3::UnitZ() ) : Vec3( point.outward.cast<float>() ) );
	}
	return binding;
}

void SkinBinding::listBlended()
{
	blended.resize( placed.empty() ? 0 : restPosition.size() - placed.size() );
	auto to = blended.begin();
	std::uint32_t next = 0;
	for ( const Placed& of : placed )
	{
		std::iota( to, to + ( of.vertex - next ), next );
		to += of.vertex - next;
		next = of.vertex + 1;
	}
	std::iota( to, blended.end(), next );
}

} // namespace pliant
