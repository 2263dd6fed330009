// Pieces of surface and sides of faces that share an edge bound one part of the material. Each cell owns the largest of the parts nearest
// to it; every other part goes to the neighbour with which it shares the largest area.

#include "surface/crack_shapes/cell_owners.h"

#include "lattice/inside/grid.h"
#include "lattice/union_find.h"
#include "surface/constants.h"
#include "surface/skin/cell_finder.h"

#include <algorithm>
#include <memory>
#include <tuple>

namespace pliant {

namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

/// A connected part of the material in one position.
struct Blob
{
	std::uint64_t position = 0;
	double volume = 0.0; ///< in cells^3; negative for a bubble
	Vec3d moment = Vec3d::Zero();
	Vec3d corners = Vec3d::Zero(); ///< sum, for parts without a volume
	double cornerCount = 0.0;
	std::uint32_t owner = kNone;

	Vec3d middle() const { return volume > kSolidBlob ? Vec3d( moment / volume ) : Vec3d( corners / std::max( cornerCount, 1.0 ) ); }
};

/// Elements are the polygons, then two for each part of a face: its lower and its upper side.
class OwnerSearch
{
public:
	OwnerSearch( const Lattice& lattice, const ClippedSurface& surface, const FaceParts& faces, const std::vector<std::uint32_t>& merged ) :
		m_lattice( lattice ), m_surface( surface ), m_faces( faces ), m_merged( merged ), m_polygons( surface.polygons.count() ),
		m_blobOf( m_polygons + 2 * faces.part.size(), kNone )
	{
		for ( const auto& at : lattice.coordinate )
		{
			m_keys.push_back( positionKey( lattice.extent, at.cast<int>() ) );
		}
	}

	CellOwners run()
	{
		makeBlobs();
		assignLargest();
		while ( assignToNeighbours() )
		{}
		assignToNearest();
		CellOwners out;
		out.adopted = m_adopted;
		for ( std::size_t p = 0; p < m_polygons; ++p )
		{
			out.ofPolygon.push_back( m_blobs[m_blobOf[p]].owner );
		}
		for ( std::size_t f = 0; f < m_faces.part.size(); ++f )
		{
			out.below.push_back( m_blobs[m_blobOf[m_polygons + 2 * f]].owner );
			out.above.push_back( m_blobs[m_blobOf[m_polygons + 2 * f + 1]].owner );
		}
		return out;
	}

private:
	std::uint64_t positionOf( std::size_t element ) const
	{
		if ( element < m_polygons )
		{
			return positionKey( m_lattice.extent, m_surface.polygons.position[element] );
		}
		const FacePart& part = m_faces.part[( element - m_polygons ) / 2];
		Eigen::Vector3i position = positionOfKey( m_lattice.extent, part.below );
		position[part.axis] += ( element - m_polygons ) % 2 == 1 ? 1 : 0;
		return positionKey( m_lattice.extent, position );
	}

	/// Calls visit( from, to, firstOfLoop ) for each edge of an element, oriented so that the material is behind the element.
	template <class F>
	void forEdges( std::size_t element, F&& visit ) const
	{
		if ( element < m_polygons )
		{
			const ClipPolygons& all = m_surface.polygons;
			const std::uint32_t first = all.start[element], last = all.start[element + 1];
			for ( std::uint32_t c = first; c < last; ++c )
			{
				visit( m_merged[all.point[c]], m_merged[all.point[c + 1 < last ? c + 1 : first]], m_merged[all.point[first]] );
			}
			return;
		}
		const FacePart& part = m_faces.part[( element - m_polygons ) / 2];
		const bool isAbove = ( element - m_polygons ) % 2 == 1;
		for ( std::uint32_t loop = part.firstLoop; loop < part.lastLoop; ++loop )
		{
			const std::uint32_t first = m_faces.loops.start[loop], last = m_faces.loops.start[loop + 1];
			for ( std::uint32_t c = first; c < last; ++c )
			{
				const std::uint32_t a = m_faces.loops.point[c], b = m_faces.loops.point[c + 1 < last ? c + 1 : first];
				visit( isAbove ? b : a, isAbove ? a : b, m_faces.loops.point[first] );
			}
		}
	}

	void makeBlobs()
	{
		std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
		for ( std::size_t e = 0; e < m_blobOf.size(); ++e )
		{
			order.emplace_back( positionOf( e ), std::uint32_t( e ) );
		}
		std::sort( order.begin(), order.end() );
		std::vector<std::uint32_t> elements;
		for ( std::size_t first = 0, last = 0; first < order.size(); first = last )
		{
			elements.clear();
			for ( ; last < order.size() && order[last].first == order[first].first; ++last )
			{
				elements.push_back( order[last].second );
			}
			makeBlobsAt( order[first].first, elements );
		}
	}

	void makeBlobsAt( std::uint64_t position, const std::vector<std::uint32_t>& elements )
	{
		UnionFind sets( elements.size() );
		m_edges.clear();
		for ( std::uint32_t k = 0; k < elements.size(); ++k )
		{
			forEdges( elements[k], [&]( std::uint32_t a, std::uint32_t b, std::uint32_t ) {
				if ( a != b )
				{
					m_edges.emplace_back( std::min( a, b ), std::max( a, b ), k );
				}
			} );
		}
		std::sort( m_edges.begin(), m_edges.end() );
		for ( std::size_t k = 1; k < m_edges.size(); ++k )
		{
			if ( std::get<0>( m_edges[k] ) == std::get<0>( m_edges[k - 1] ) && std::get<1>( m_edges[k] ) == std::get<1>( m_edges[k - 1] ) )
			{
				sets.join( std::get<2>( m_edges[k] ), std::get<2>( m_edges[k - 1] ) );
			}
		}
		for ( std::uint32_t k = 0; k < elements.size(); ++k )
		{
			if ( sets.find( k ) == k )
			{
				m_blobOf[elements[k]] = std::uint32_t( m_blobs.size() );
				m_blobs.emplace_back();
				m_blobs.back().position = position;
			}
			m_blobOf[elements[k]] = m_blobOf[elements[sets.find( k )]];
			measure( elements[k], m_blobs[m_blobOf[elements[k]]] );
		}
	}

	/// Sums tetrahedra between a corner of the position and the element's triangles.
	void measure( std::size_t element, Blob& blob ) const
	{
		const Vec3d origin = positionOfKey( m_lattice.extent, blob.position ).cast<double>();
		const auto at = [&]( std::uint32_t p ) { return Vec3d( m_surface.point[p].bent - origin ); };
		forEdges( element, [&]( std::uint32_t from, std::uint32_t to, std::uint32_t first ) {
			const Vec3d a = at( first ), b = at( from ), c = at( to );
			const double volume = a.dot( b.cross( c ) ) / 6.0;
			blob.volume += volume;
			blob.moment += volume * ( 0.25 * ( a + b + c ) + origin );
			blob.corners += b + origin;
			blob.cornerCount += 1.0;
		} );
	}

	std::pair<std::uint32_t, std::uint32_t> cellsAt( std::uint64_t position ) const
	{
		const auto [first, last] = std::equal_range( m_keys.begin(), m_keys.end(), position );
		return { std::uint32_t( first - m_keys.begin() ), std::uint32_t( last - m_keys.begin() ) };
	}

	/// Centre of mass of a cell's material, cells.
	Vec3d middleOf( std::uint32_t cell ) const
	{
		return ( m_lattice.restCentre[cell].cast<double>() + m_lattice.massCentre - m_lattice.corner ) / double( m_lattice.cellSize );
	}

	std::uint32_t nearestOf( std::uint32_t first, std::uint32_t last, const Vec3d& position ) const
	{
		std::uint32_t best = first;
		for ( std::uint32_t cell = first + 1; cell < last; ++cell )
		{
			if ( ( middleOf( cell ) - position ).squaredNorm() < ( middleOf( best ) - position ).squaredNorm() )
			{
				best = cell;
			}
		}
		return best;
	}

	void assignLargest()
	{
		std::vector<std::uint32_t> largest( m_keys.size(), kNone ); // blob, by cell
		for ( std::uint32_t b = 0; b < m_blobs.size(); ++b )
		{
			const auto [first, last] = cellsAt( m_blobs[b].position );
			if ( first == last )
			{
				continue;
			}
			std::uint32_t& taken = largest[nearestOf( first, last, m_blobs[b].middle() )];
			if ( taken == kNone || m_blobs[b].volume > m_blobs[taken].volume )
			{
				taken = b;
			}
		}
		for ( std::uint32_t cell = 0; cell < largest.size(); ++cell )
		{
			if ( largest[cell] != kNone )
			{
				m_blobs[largest[cell]].owner = cell;
			}
		}
	}

	double areaOf( const FacePart& part ) const
	{
		double area = 0.0;
		for ( std::uint32_t loop = part.firstLoop; loop < part.lastLoop; ++loop )
		{
			area += loopArea( m_faces.loops, m_faces.at, loop );
		}
		return std::abs( area );
	}

	/// Runs one round based on the owners at its start. Returns false when no owner was found.
	bool assignToNeighbours()
	{
		struct Offer
		{
			std::uint32_t blob, owner;
			double area;
		};
		std::vector<Offer> offers;
		for ( std::size_t f = 0; f < m_faces.part.size(); ++f )
		{
			for ( std::size_t side = 0; side < 2; ++side )
			{
				const std::uint32_t here = m_blobOf[m_polygons + 2 * f + side], there = m_blobOf[m_polygons + 2 * f + 1 - side];
				if ( m_blobs[here].owner == kNone && m_blobs[there].owner != kNone )
				{
					offers.push_back( { here, m_blobs[there].owner, areaOf( m_faces.part[f] ) } );
				}
			}
		}
		std::stable_sort( offers.begin(), offers.end(),
			[]( const Offer& a, const Offer& b ) { return std::tie( a.blob, a.owner ) < std::tie( b.blob, b.owner ); } );
		std::size_t last = 0;
		for ( std::size_t first = 0; first < offers.size(); first = last )
		{
			Blob& blob = m_blobs[offers[first].blob];
			std::uint32_t widest = kNone, linkedCell = kNone;
			double most = -1.0;
			while ( last < offers.size() && offers[last].blob == offers[first].blob )
			{
				const std::uint32_t owner = offers[last].owner;
				double area = 0.0;
				for ( ; last < offers.size() && offers[last].blob == offers[first].blob && offers[last].owner == owner; ++last )
				{
					area += offers[last].area;
				}
				if ( area > most )
				{
					most = area;
					widest = owner;
				}
				linkedCell = std::min( linkedCell, linkedCellAt( blob, owner ) );
			}
			blob.owner = linkedCell != kNone ? linkedCell : widest;
			m_adopted += linkedCell == kNone ? 1 : 0;
		}
		return !offers.empty();
	}

	/// A cell at the blob's own position that is linked to a neighbour; kNone where there is none.
	std::uint32_t linkedCellAt( const Blob& blob, std::uint32_t neighbour ) const
	{
		const auto [first, last] = cellsAt( blob.position );
		for ( std::uint32_t cell = first; cell < last; ++cell )
		{
			if ( areLinked( m_lattice, cell, neighbour ) )
			{
				return cell;
			}
		}
		return kNone;
	}

	/// Assigns parts that touch no owned one: bubbles, and isolated fragments.
	void assignToNearest()
	{
		std::unique_ptr<CellTree> tree;
		for ( Blob& blob : m_blobs )
		{
			if ( blob.owner != kNone )
			{
				continue;
			}
			const auto [first, last] = cellsAt( blob.position );
			if ( first < last )
			{
				blob.owner = nearestOf( first, last, blob.middle() );
				continue;
			}
			if ( !tree )
			{
				tree = std::make_unique<CellTree>( m_lattice );
			}
			blob.owner = std::uint32_t( tree->nearest( m_lattice.corner + double( m_lattice.cellSize ) * blob.middle() ) );
			++m_adopted;
		}
	}

	const Lattice& m_lattice;
	const ClippedSurface& m_surface;
	const FaceParts& m_faces;
	const std::vector<std::uint32_t>& m_merged;
	std::size_t m_polygons;
	std::vector<std::uint64_t> m_keys; ///< of the cells
	std::vector<std::uint32_t> m_blobOf;
	std::vector<Blob> m_blobs;
	std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> m_edges;
	int m_adopted = 0;
};

} // namespace

bool areLinked( const Lattice& lattice, std::uint32_t a, std::uint32_t b )
{
	return std::binary_search( lattice.linkTo.begin() + lattice.linkStart[a], lattice.linkTo.begin() + lattice.linkStart[a + 1], b );
}

CellOwners findOwners(
	const Lattice& lattice, const ClippedSurface& surface, const FaceParts& faces, const std::vector<std::uint32_t>& merged )
{
	return OwnerSearch( lattice, surface, faces, merged ).run();
}

} // namespace pliant
