#include "world/touch/level_faces.h"

#include "body/levels/levels.h"
#include "lattice/constants.h"
#include "world/constants.h"
#include "world/touch/edge_constants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

void LevelFaces::build(
	const Lattice& lattice, const Levels& levels, const std::vector<ContactPatch>& patches, const AxisNeighbours& beside )
{
	const Octree& octree = levels.octree();
	const Cut& cut = levels.cut();
	const auto count = std::size_t( cut.count() );
	m_cellSize = double( lattice.cellSize );
	m_largestSize = m_cellSize;
	m_overhang = 0.0;
	m_restCentre.resize( count );
	m_size.resize( count );
	m_start.assign( 1, 0 );
	m_faces.clear();
	for ( std::size_t node = 0; node < count; ++node )
	{
		const std::uint32_t block = cut.node[node];
		m_restCentre[node] = octree.restCentre[block];
		m_size[node] = std::ldexp( m_cellSize, octree.levelOf( block ) );
		m_largestSize = std::max( m_largestSize, m_size[node] );
		if ( octree.isSurface[block] != 0 )
		{
			addFaces( lattice, levels, patches, node );
		}
		m_start.push_back( std::uint32_t( m_faces.size() ) );
	}
	findNeighbours( levels, beside );
}

void LevelFaces::addFaces( const Lattice& lattice, const Levels& levels, const std::vector<ContactPatch>& patches, std::size_t node )
{
	const Octree& octree = levels.octree();
	const Cut& cut = levels.cut();
	const std::uint32_t* const cells = octree.cells.data() + octree.cellStart[cut.node[node]];
	const std::uint32_t count = octree.cellCount[cut.node[node]];
	m_linked.clear();
	for ( std::uint32_t k = 0; k < count; ++k )
	{
		const std::uint32_t cell = cells[k];
		if ( patches[cell].radius > 0.0f )
		{
			addFace( faceOf( lattice, patches[cell], cell, node ), m_size[node] );
		}
		for ( std::uint32_t e = lattice.edgeFaceStart[cell]; e < lattice.edgeFaceStart[cell + 1]; ++e )
		{
			Face face = faceOf( lattice, lattice.edgeFace[e], cell, node );
			face.isOwn = false;
			addFace( face, m_size[node] );
		}
		if ( lattice.isSurface[cell] != 0 )
		{
			m_linked.insert(
				m_linked.end(), lattice.linkTo.begin() + lattice.linkStart[cell], lattice.linkTo.begin() + lattice.linkStart[cell + 1] );
		}
	}
	std::sort( m_linked.begin(), m_linked.end() );
	m_linked.erase( std::unique( m_linked.begin(), m_linked.end() ), m_linked.end() );
	const std::size_t ownEnd = m_faces.size();
	for ( const std::uint32_t cell : m_linked )
	{
		if ( cut.slotOfCell[cell] == node || !( double( patches[cell].radius ) > kFlatRadius * m_cellSize ) )
		{
			continue;
		}
		Face face = faceOf( lattice, patches[cell], cell, node );
		face.isOwn = false;
		const bool isKnown = std::any_of(
			m_faces.begin() + m_start[node], m_faces.begin() + std::ptrdiff_t( ownEnd ), [&]( const Face& own ) {
				return own.normal.dot( face.normal ) > kCoplanarCosine &&
					std::abs( own.normal.dot( own.foot - face.foot ) ) < kPlaneTolerance * m_cellSize;
			} );
		if ( !isKnown )
		{
			addFace( face, m_size[node] );
		}
	}
}

LevelFaces::Face LevelFaces::faceOf( const Lattice& lattice, const ContactPatch& patch, std::uint32_t cell, std::size_t node ) const
{
	Face face;
	face.normal = patch.normal;
	face.foot = lattice.restCentre[cell] + patch.height * patch.normal - m_restCentre[node];
	face.radius = double( patch.radius ) > kPlaneRadius * m_cellSize ? float( kMaxPatchRadius * m_size[node] ) : patch.radius;
	return face;
}

void LevelFaces::addFace( const Face& face, double size )
{
	const double height = double( face.foot.dot( face.normal ) );
	if ( height > 0.0 ) // otherwise it belongs to a corner that is hollow
	{
		m_overhang = std::max( m_overhang, face.isOwn ? height - 0.5 * size : 0.0 );
		m_faces.push_back( face );
	}
}

void LevelFaces::findNeighbours( const Levels& levels, const AxisNeighbours& beside )
{
	const Octree& octree = levels.octree();
	const Cut& cut = levels.cut();
	m_neighbours.assign( std::size_t( cut.count() ), { -1, -1, -1, -1, -1, -1 } );
	for ( int node = 0; node < cut.count(); ++node )
	{
		const std::uint32_t block = cut.node[std::size_t( node )];
		if ( octree.isSurface[block] == 0 )
		{
			continue;
		}
		double best[6] = {};
		for ( std::uint32_t k = 0; k < octree.cellCount[block]; ++k )
		{
			const std::array<std::int32_t, 6>& around = beside[octree.cells[octree.cellStart[block] + k]];
			for ( std::size_t side = 0; side < around.size(); ++side )
			{
				const int other = around[side] < 0 ? node : int( cut.slotOfCell[std::size_t( around[side] )] );
				if ( other == node || other == m_neighbours[std::size_t( node )][side] )
				{
					continue;
				}
				// The cosine between the step and the axis.
				const Vec3d step = ( restCentre( other ) - restCentre( node ) ).cast<double>();
				const double along = step[Eigen::Index( side / 2 )] * ( side % 2 == 0 ? -1.0 : 1.0 ) / step.norm();
				if ( along > best[side] )
				{
					best[side] = along;
					m_neighbours[std::size_t( node )][side] = std::int32_t( other );
				}
			}
		}
	}
}

const LevelFaces::Face* LevelFaces::nearestFace( int node, const Vec3d& at ) const
{
	const Face* const first = m_faces.data() + m_start[std::size_t( node )];
	const Face* const last = m_faces.data() + m_start[std::size_t( node ) + 1];
	const Vec3 point = at.cast<float>();
	float nearest = std::numeric_limits<float>::max();
	for ( const Face* face = first; face != last; ++face )
	{
		nearest = std::min( nearest, ( point - face->foot ).squaredNorm() );
	}
	const float most = std::sqrt( nearest ) + float( m_cellSize );
	const Face* found = nullptr;
	float largest = 0.0f;
	for ( const Face* face = first; face != last; ++face )
	{
		const Vec3 apart = point - face->foot;
		const float gap = face->normal.dot( apart );
		if ( apart.squaredNorm() <= most * most && ( !found || gap > largest ) )
		{
			found = face;
			largest = gap;
		}
	}
	const bool isOfThisLayer = found && ( found->isOwn || double( found->foot.dot( found->normal ) ) < kLayerHeight * sizeOf( node ) );
	return isOfThisLayer ? found : nullptr;
}

} // namespace pliant
