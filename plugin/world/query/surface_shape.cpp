#include "world/query/surface_shape.h"

#include "body/levels/levels.h"
#include "lattice/table.h"
#include "world/bodies/soft_body_impl.h"
#include "world/query/query_constants.h"

#include <LinearMath/btAabbUtil2.h>

#include <algorithm>
#include <cmath>

namespace pliant {

SurfaceShape::SurfaceShape( const SoftBody& owner ) : m_owner( owner )
{
	m_shapeType = CUSTOM_CONCAVE_SHAPE_TYPE;
	m_collisionMargin = 0; // triangles are met where they are drawn
}

void SurfaceShape::getAabb( const btTransform& at, btVector3& low, btVector3& high ) const
{
	const NodeShape& spheres = *m_owner.impl().shape;
	spheres.getAabb( at, low, high );
	const btScalar beyond = btScalar( kDrawnBeyondSpheres ) * spheres.largestRadius();
	low -= btVector3( beyond, beyond, beyond );
	high += btVector3( beyond, beyond, beyond );
}

Vec3d SurfaceShape::inNodes( const btVector3& point ) const
{
	return toVec3d( point ) + m_owner.impl().shapeShift.cast<double>();
}

btVector3 SurfaceShape::fromNodes( const Vec3d& point ) const
{
	return toBt( point - m_owner.impl().shapeShift.cast<double>() );
}

const SurfaceShape::Surface& SurfaceShape::now() const
{
	const unsigned moves = m_owner.impl().skin.moves;
	if ( m_moves.load( std::memory_order_acquire ) != moves )
	{
		const std::lock_guard lock( m_lock );
		if ( m_moves.load( std::memory_order_relaxed ) != moves )
		{
			update();
			m_moves.store( moves, std::memory_order_release );
		}
	}
	return m_surface;
}

// The tree is sorted again if triangles have changed, and refitted if vertices have moved.
void SurfaceShape::update() const
{
	const TriangleView before = m_surface.view;
	const SoftBody::Impl& impl = m_owner.impl();
	const bool sameLinks = m_isKnown && m_surface.links == impl.fractureVersion, isDrawn = placeDrawn();
	if ( !isDrawn )
	{
		if ( !sameLinks || m_surface.boundary.triangle.empty() )
		{
			m_surface.boundary = findBoundaryFaces( impl.body->lattice() );
		}
		placeBoundary();
	}
	m_surface.view.positions = m_surface.positions.data();
	const bool isSame = sameLinks && before.indices == m_surface.view.indices && before.triangles == m_surface.view.triangles;
	if ( !isSame )
	{
		const std::vector<Vec3>& rest = isDrawn ? impl.binding().restPosition : m_surface.boundary.rest;
		m_surface.tree.sort(
			TriangleView{ rest.empty() ? nullptr : rest.front().data(), m_surface.view.indices, m_surface.view.triangles } );
		listCorners();
	}
	m_surface.tree.refit( m_surface.view );
	m_surface.links = impl.fractureVersion;
	m_isKnown = true;
}

// Group by group of vertices that share a normal, in the order of the triangles.
void SurfaceShape::listCorners() const
{
	std::vector<std::uint32_t>&start = m_surface.groupStart, &triangle = m_surface.groupTriangle;
	start.clear();
	triangle.clear();
	if ( m_surface.normals.empty() )
	{
		return;
	}
	const SkinBinding& shown = m_owner.impl().binding();
	const TriangleView& view = m_surface.view;
	const int corners = 3 * view.triangles;
	const auto forCorners = [&]( auto&& visit ) {
		for ( int k = 0; k < corners; ++k )
		{
			visit( shown.normalGroup[view.indices[k]], std::uint32_t( k / 3 ) );
		}
	};
	sortIntoRows( std::size_t( shown.normalGroups ), forCorners, start, triangle );
}

bool SurfaceShape::placeDrawn() const
{
	SkinTriangles triangles;
	if ( !m_owner.impl().placeDrawn( m_surface.positions, m_surface.normals, triangles ) )
	{
		return false;
	}
	m_surface.view.indices = triangles.indices;
	m_surface.view.triangles = triangles.count;
	return true;
}

// The position of a corner is the mean of its positions by the cells around it, each as rotated, or as stretched where cells share a node.
void SurfaceShape::placeBoundary() const
{
	using Matrix3fRows = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
	const Body& body = *m_owner.impl().body;
	const NodeState& nodes = body.nodes();
	const Levels* const levels = body.levels();
	const BoundaryFaces& faces = m_surface.boundary;
	std::vector<float>& maps = m_surface.nodeMaps;
	maps.resize( 9 * std::size_t( nodes.padded ) );
	levels ? body.nodeDeformations( maps.data() ) : body.nodeRotations( maps.data() );
	m_surface.positions.resize( 3 * faces.rest.size() );
	m_surface.normals.clear();
	for ( std::size_t i = 0; i < faces.rest.size(); ++i )
	{
		Vec3 sum = Vec3::Zero();
		for ( std::uint32_t k = faces.start[i]; k < faces.start[i + 1]; ++k )
		{
			const std::size_t node = levels ? levels->cut().slotOfCell[faces.cell[k]] : faces.cell[k];
			const Vec3 offset = faces.rest[i] - nodes.x0.get( int( node ) );
			const float* const q = maps.data() + 4 * node;
			sum += nodes.x.get( int( node ) ) +
				( levels ? Vec3( Eigen::Map<const Matrix3fRows>( maps.data() + 9 * node ) * offset )
						 : Vec3( Eigen::Quaternionf( q[3], q[0], q[1], q[2] ) * offset ) );
		}
		Eigen::Map<Vec3>( m_surface.positions.data() + 3 * i ) = sum / float( faces.start[i + 1] - faces.start[i] );
	}
	m_surface.view.indices = faces.triangle.empty() ? nullptr : faces.triangle.front().data();
	m_surface.view.triangles = int( faces.triangle.size() );
}

void SurfaceShape::cornersOf( int triangle, Vec3d ( &corner )[3] ) const
{
	for ( int k = 0; k < 3; ++k )
	{
		corner[k] = m_surface.view.corner( triangle, k );
	}
}

void SurfaceShape::cornersOf( int triangle, btVector3 ( &corner )[3] ) const
{
	for ( int k = 0; k < 3; ++k )
	{
		corner[k] = fromNodes( m_surface.view.corner( triangle, k ) );
	}
}

std::vector<SurfaceShape::Piece> SurfaceShape::piecesIn( const btVector3& low, const btVector3& high ) const
{
	std::vector<Piece> pieces;
	now().tree.visitOverlaps( inNodes( low ).cast<float>(), inNodes( high ).cast<float>(), [&]( int triangle ) {
		pieces.emplace_back();
		cornersOf( triangle, pieces.back().corner );
	} );
	const btScalar cell = m_owner.bodyTemplate().cellSize();
	int splits = 0;
	for ( std::size_t k = 0; k < pieces.size(); )
	{
		btVector3( &corner )[3] = pieces[k].corner;
		btVector3 least = corner[0], most = corner[0];
		int longest = 0;
		for ( int side = 0; side < 3; ++side )
		{
			least.setMin( corner[side] );
			most.setMax( corner[side] );
			const auto lengthOf = [&corner]( int from ) { return corner[from].distance2( corner[( from + 1 ) % 3] ); };
			longest = lengthOf( side ) > lengthOf( longest ) ? side : longest;
		}
		if ( !TestAabbAgainstAabb2( least, most, low, high ) )
		{
			std::swap( pieces[k], pieces.back() );
			pieces.pop_back();
			continue;
		}
		const btVector3 a = corner[longest], b = corner[( longest + 1 ) % 3], c = corner[( longest + 2 ) % 3], middle = ( a + b ) / 2;
		if ( !( a.distance2( b ) > cell * cell ) || splits == kMostSurfaceSplits )
		{
			++k;
			continue;
		}
		++splits;
		pieces[k] = Piece{ { a, middle, c } };
		pieces.push_back( Piece{ { middle, b, c } } );
	}
	return pieces;
}

// The mean of all normals around a corner would count it as smooth on a plate, whose large faces outweigh the others.
bool SurfaceShape::isOnCrease( std::uint32_t vertex ) const
{
	const std::uint32_t group = m_owner.impl().binding().normalGroup[vertex];
	const std::uint32_t* const begin = m_surface.groupTriangle.data() + m_surface.groupStart[group];
	const std::uint32_t* const end = m_surface.groupTriangle.data() + m_surface.groupStart[group + 1];
	const auto normalOf = [this]( std::uint32_t triangle ) {
		Vec3d corner[3];
		cornersOf( int( triangle ), corner );
		return Vec3( ( corner[1] - corner[0] ).cross( corner[2] - corner[0] ).normalized().cast<float>() );
	};
	Vec3 sum = Vec3::Zero();
	for ( const std::uint32_t* triangle = begin; triangle < end; ++triangle )
	{
		sum += normalOf( *triangle );
	}
	const float least = kCreaseCosine * sum.norm();
	return std::any_of( begin, end, [&]( std::uint32_t triangle ) { return normalOf( triangle ).dot( sum ) < least; } );
}

bool SurfaceShape::isSmoothAt( std::uint32_t vertex, const Vec3d& face ) const
{
	return normalAt( vertex ).dot( face ) >= kSmoothCosine && !isOnCrease( vertex );
}

Vec3d SurfaceShape::normalAt( std::uint32_t vertex ) const
{
	return Eigen::Map<const Vec3>( m_surface.normals.data() + 3 * std::size_t( vertex ) ).cast<double>();
}

// Where the corners' normals are near the face's, the surface is smooth there; at edges the face's own counts.
Vec3d SurfaceShape::smoothNormal( int triangle, const Vec3d& weights, const Vec3d& face ) const
{
	if ( m_surface.normals.empty() )
	{
		return face;
	}
	Vec3d sum = Vec3d::Zero();
	for ( int k = 0; k < 3; ++k )
	{
		const std::uint32_t vertex = m_surface.view.indices[3 * std::size_t( triangle ) + std::size_t( k )];
		if ( !isSmoothAt( vertex, face ) )
		{
			return face;
		}
		sum += weights[k] * normalAt( vertex );
	}
	return sum.normalized();
}

int SurfaceShape::childNear( const btVector3& point ) const
{
	const NodeShape& spheres = *m_owner.impl().shape;
	const NodeState& nodes = m_owner.impl().body->nodes();
	const bool hasLevels = m_owner.impl().body->levels() != nullptr;
	const Vec3d at = inNodes( point );
	const auto gapOf = [&]( int node ) {
		const double distance = ( nodes.x.get( node ).cast<double>() - at ).norm();
		return hasLevels ? distance - double( spheres.sphereOfNode( node )->getRadius() ) : distance;
	};
	int best = -1;
	double least = 0.0, reach = double( spheres.smallestRadius() );
	for ( int round = 0; round < kMostDoublings && ( best < 0 || least > reach ); ++round )
	{
		reach *= round > 0 ? 2.0 : 1.0;
		const btVector3 around = btVector3( 1, 1, 1 ) * btScalar( reach );
		spheres.rows().visitOverlaps( SphereRows::Box::of( point - around, point + around ), [&]( int node ) {
			const double gap = gapOf( node );
			if ( best < 0 || gap < least || ( gap == least && node < best ) )
			{
				best = node;
				least = gap;
			}
		} );
	}
	return best < 0 ? 0 : spheres.childOfNode( best );
}

bool SurfaceShape::contains( const btVector3& point, btVector3& onSurface, btVector3& outwards ) const
{
	const Surface& surface = now();
	const Vec3d at = inNodes( point );
	double least = -1.0, across = 0.0, reach = double( m_owner.impl().shape->smallestRadius() );
	Vec3d nearest = Vec3d::Zero();
	for ( int round = 0; round < kMostDoublings && ( least < 0.0 || least > reach ); ++round )
	{
		reach *= round > 0 ? 2.0 : 1.0;
		const Vec3 around = Vec3::Constant( float( reach ) );
		surface.tree.visitOverlaps( at.cast<float>() - around, at.cast<float>() + around, [&]( int triangle ) {
			Vec3d corner[3];
			cornersOf( triangle, corner );
			const Vec3d weights = nearestWeights( at, corner );
			const Vec3d there = weights[0] * corner[0] + weights[1] * corner[1] + weights[2] * corner[2];
			const double distance = ( there - at ).norm();
			// Among the triangles at an edge, the one that faces the point most determines on which side the point is.
			const double height = ( at - there ).dot( ( corner[1] - corner[0] ).cross( corner[2] - corner[0] ).normalized() );
			const bool isEqual = least >= 0.0 && std::abs( distance - least ) < least * kEqualDistance;
			if ( least < 0.0 || ( isEqual ? std::abs( height ) > std::abs( across ) : distance < least ) )
			{
				least = distance;
				across = height;
				nearest = there;
			}
		} );
	}
	if ( !( least > 0.0 ) || across >= 0.0 )
	{
		return false;
	}
	// An open surface has no inside beyond the cells.
	const int node = m_owner.nearestNode( point + m_owner.getWorldTransform().getOrigin() );
	const double cell = 2.0 * double( m_owner.nodeRadius( node ) );
	if ( ( m_owner.impl().body->nodes().x.get( node ).cast<double>() - at ).norm() > cell )
	{
		return false;
	}
	onSurface = fromNodes( nearest );
	outwards = toBt( ( nearest - at ) / least );
	return true;
}

} // namespace pliant
