#include "lattice/faces/cell_boundary.h"

#include "lattice/axis_neighbours.h"

#include "lattice/constants.h"
#include "lattice/table.h"
#include "lattice/union_find.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <tuple>

namespace pliant {

namespace {

/// Corner c of a cell: bit k is its side along axis k.
constexpr std::size_t kCornersOfCell = 8;

/// A face without a link: its cell, the corners counter-clockwise seen from outside, and the lattice position in front of it.
struct Face
{
	std::uint32_t cell;
	std::array<std::uint32_t, 4> corners; ///< of the cell
	Eigen::Vector3i front;
};

/// Corners of the face on a side (axis * 2 + 1 for the high side), counter-clockwise seen from outside.
std::array<std::uint32_t, 4> cornersOf( int side )
{
	const std::uint32_t axis = std::uint32_t( side ) / 2, u = 1u << ( axis + 1 ) % 3, v = 1u << ( axis + 2 ) % 3;
	const std::uint32_t base = side % 2 == 1 ? 1u << axis : 0u;
	return side % 2 == 1 ? std::array<std::uint32_t, 4>{ base, base | u, base | u | v, base | v }
						 : std::array<std::uint32_t, 4>{ base, base | v, base | u | v, base | u };
}

/// Two linked cells share the corners between them.
void joinCorners( const Lattice& lattice, UnionFind& joined )
{
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			const Eigen::Vector3i step = lattice.coordinate[j].cast<int>() - lattice.coordinate[i].cast<int>();
			for ( std::uint32_t c = 0; c < kCornersOfCell && j > i; ++c )
			{
				std::uint32_t other = c;
				bool isShared = true;
				for ( int axis = 0; axis < 3; ++axis )
				{
					const int side = int( c >> axis & 1u );
					isShared = isShared && ( step[axis] == 0 || side == ( step[axis] > 0 ? 1 : 0 ) );
					other ^= step[axis] == 0 ? 0u : 1u << axis;
				}
				if ( isShared )
				{
					joined.join( std::uint32_t( kCornersOfCell * i ) + c, std::uint32_t( kCornersOfCell * j ) + other );
				}
			}
		}
	}
}

std::vector<Face> findFaces( const Lattice& lattice )
{
	const AxisNeighbours beside = findAxisNeighbours( lattice );
	std::vector<Face> faces;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( int side = 0; side < 6; ++side )
		{
			if ( beside[i][std::size_t( side )] < 0 )
			{
				Eigen::Vector3i front = lattice.coordinate[i].cast<int>();
				front[side / 2] += side % 2 == 1 ? 1 : -1;
				faces.push_back( Face{ i, cornersOf( side ), front } );
			}
		}
	}
	return faces;
}

/// An edge of a face: its ends, ascending, and the position in front of the face. Faces that meet at an edge continue one another where
/// they have the same position in front of them, or where they are the only two.
struct Edge
{
	std::uint32_t low, high, face;
	Eigen::Vector3i front;

	bool isAt( const Edge& other ) const { return low == other.low && high == other.high; }
	auto order() const { return std::make_tuple( low, high, front.x(), front.y(), front.z(), face ); }
};

void joinAt( std::vector<Edge>::const_iterator begin, std::vector<Edge>::const_iterator end, UnionFind& surfaces )
{
	std::vector<Edge> single;
	for ( auto edge = begin; edge != end; )
	{
		auto next = edge + 1;
		for ( ; next != end && next->front == edge->front; ++next )
		{
			surfaces.join( edge->face, next->face );
		}
		if ( next == edge + 1 )
		{
			single.push_back( *edge );
		}
		edge = next;
	}
	for ( std::size_t k = 1; k < single.size(); ++k )
	{
		surfaces.join( single[0].face, single[k].face );
	}
}

void joinFaces( const std::vector<Face>& faces, UnionFind& corners, UnionFind& surfaces )
{
	std::vector<Edge> edges;
	edges.reserve( 4 * faces.size() );
	for ( std::uint32_t f = 0; f < std::uint32_t( faces.size() ); ++f )
	{
		for ( std::size_t k = 0; k < 4; ++k )
		{
			const std::uint32_t first = std::uint32_t( kCornersOfCell ) * faces[f].cell;
			const std::uint32_t a = corners.find( first + faces[f].corners[k] ),
								b = corners.find( first + faces[f].corners[( k + 1 ) % 4] );
			edges.push_back( Edge{ std::min( a, b ), std::max( a, b ), f, faces[f].front } );
		}
	}
	std::sort( edges.begin(), edges.end(), []( const Edge& a, const Edge& b ) { return a.order() < b.order(); } );
	for ( auto edge = edges.cbegin(); edge != edges.cend(); )
	{
		auto next = edge + 1;
		while ( next != edges.cend() && next->isAt( *edge ) )
		{
			++next;
		}
		joinAt( edge, next, surfaces );
		edge = next;
	}
}

/// Cells of each group of joined corners.
Table cellsOfCorners( std::size_t count, UnionFind& corners )
{
	Table cells;
	const auto forCorners = [&]( auto&& visit ) {
		for ( std::uint32_t c = 0; c < std::uint32_t( count ); ++c )
		{
			visit( corners.find( c ), c / std::uint32_t( kCornersOfCell ) );
		}
	};
	sortIntoRows( count, forCorners, cells.start, cells.entry );
	return cells;
}

Vec3 restPositionOf( const Lattice& lattice, std::uint32_t corner )
{
	const Eigen::Vector3i side( int( corner & 1u ), int( corner >> 1 & 1u ), int( corner >> 2 & 1u ) );
	const Eigen::Vector3i at = lattice.coordinate[corner / kCornersOfCell].cast<int>() + side;
	return ( lattice.corner + double( lattice.cellSize ) * at.cast<double>() - lattice.massCentre ).cast<float>();
}

void measureVolumes( const Lattice& lattice, CellBoundary& boundary )
{
	double enclosed = 0.0, material = 0.0;
	for ( const std::array<std::uint32_t, 4>& quad : boundary.quads )
	{
		const auto at = [&]( std::size_t k ) { return Vec3d( boundary.restPosition[quad[k]].cast<double>() ); };
		const double volume = ( at( 0 ) + at( 1 ) + at( 2 ) + at( 3 ) ).dot( ( at( 2 ) - at( 0 ) ).cross( at( 3 ) - at( 1 ) ) ) / 24.0;
		boundary.restVolume[boundary.surface[quad[0]]] += volume;
		enclosed += volume;
	}
	for ( const float fill : lattice.fill )
	{
		material += double( fill );
	}
	double outer = 0.0;
	for ( const double volume : boundary.restVolume )
	{
		outer += std::max( volume, 0.0 );
	}
	const double cell = double( lattice.cellSize ), empty = enclosed - material * cell * cell * cell;
	boundary.displaced = 1.0 - ( outer > enclosed * ( 1.0 + kCavityFraction ) ? 0.5 : 1.0 ) * empty / outer;
}

} // namespace

CellBoundary findBoundary( const Lattice& lattice )
{
	const std::size_t count = kCornersOfCell * std::size_t( lattice.cellCount() );
	UnionFind corners( count );
	joinCorners( lattice, corners );
	const std::vector<Face> faces = findFaces( lattice );
	UnionFind surfaces( faces.size() );
	joinFaces( faces, corners, surfaces );
	const Table cells = cellsOfCorners( count, corners );

	// A point is a corner on a surface.
	CellBoundary boundary;
	boundary.cellStart.push_back( 0 );
	struct Use
	{
		std::uint32_t surface, corner, face, index;
	};
	std::vector<Use> uses;
	uses.reserve( 4 * faces.size() );
	for ( std::uint32_t f = 0; f < std::uint32_t( faces.size() ); ++f )
	{
		for ( std::uint32_t k = 0; k < 4; ++k )
		{
			const std::uint32_t corner = corners.find( std::uint32_t( kCornersOfCell ) * faces[f].cell + faces[f].corners[k] );
			uses.push_back( Use{ surfaces.find( f ), corner, f, k } );
		}
	}
	std::sort( uses.begin(), uses.end(), []( const Use& a, const Use& b ) {
		return std::tie( a.surface, a.corner, a.face, a.index ) < std::tie( b.surface, b.corner, b.face, b.index );
	} );
	boundary.quads.resize( faces.size() );
	for ( std::size_t k = 0; k < uses.size(); ++k )
	{
		const Use& use = uses[k];
		const bool isNewSurface = k == 0 || uses[k - 1].surface != use.surface;
		if ( isNewSurface )
		{
			boundary.restVolume.push_back( 0.0 );
		}
		if ( isNewSurface || uses[k - 1].corner != use.corner )
		{
			boundary.restPosition.push_back( restPositionOf( lattice, use.corner ) );
			boundary.surface.push_back( std::uint32_t( boundary.restVolume.size() - 1 ) );
			boundary.cell.insert( boundary.cell.end(), cells.begin( use.corner ), cells.end( use.corner ) );
			boundary.cellStart.push_back( std::uint32_t( boundary.cell.size() ) );
		}
		boundary.quads[use.face][use.index] = std::uint32_t( boundary.restPosition.size() - 1 );
	}
	measureVolumes( lattice, boundary );
	return boundary;
}

} // namespace pliant
