#include "pliant/game/queries.h"

#include "lattice/mesh/winding_number.h"
#include "world/bodies/soft_body_impl.h"
#include "world/game/constants.h"
#include "world/game/solid_tree.h"

#include <cmath>
#include <optional>

namespace pliant {

struct SurfaceQuery::Data
{
	std::vector<Vec3d> position; ///< relative to `origin`, m
	std::vector<Triangle> triangles;
	std::vector<Vec3d> nodes; ///< relative to `origin`, m
	Vec3d origin = Vec3d::Zero();
	bool isDrawn = false;
	std::optional<SolidTree> tree;
	std::optional<WindingTree> winding;

	Vec3d normalOf( int triangle ) const
	{
		const Triangle& t = triangles[std::size_t( triangle )];
		return ( position[t[1]] - position[t[0]] ).cross( position[t[2]] - position[t[0]] );
	}
	bool isInside( const Vec3d& point ) const { return winding->at( point ) > 0.5; }
};

namespace {

void takeDrawn( const SurfaceView& view, std::vector<Vec3d>& position, std::vector<Triangle>& triangles )
{
	for ( int i = 0; i < view.vertexCount; ++i )
	{
		const float* const at = view.positions + 3 * std::size_t( i );
		position.emplace_back( double( at[0] ), double( at[1] ), double( at[2] ) );
	}
	for ( int t = 0; t < view.triangleCount; ++t )
	{
		const std::uint32_t* const corner = view.indices + 3 * std::size_t( t );
		triangles.push_back( Triangle{ corner[0], corner[1], corner[2] } );
	}
}

void takeCells( const SoftBody::Impl& impl, std::vector<Vec3d>& position, std::vector<Triangle>& triangles )
{
	BodyBoundary boundary;
	boundary.update( *impl.body, impl.fractureVersion );
	for ( int p = 0; p < boundary.count(); ++p )
	{
		position.push_back( boundary.position( p ) );
	}
	for ( const std::array<std::uint32_t, 4>& quad : boundary.cells().quads )
	{
		triangles.push_back( Triangle{ quad[0], quad[1], quad[2] } );
		triangles.push_back( Triangle{ quad[0], quad[2], quad[3] } );
	}
}

} // namespace

SurfaceQuery::SurfaceQuery( const SoftBody& body ) : m_data( std::make_unique<Data>() )
{
	const SoftBody::Impl& impl = body.impl();
	const BuildReport& report = body.bodyTemplate().report();
	const SurfaceView view = body.surface();
	Data& data = *m_data;
	data.isDrawn = view.triangleCount > 0 && report.openEdges == 0 && report.flippedTriangles == 0 && report.nonManifoldEdges == 0;
	if ( data.isDrawn )
	{
		data.origin = toVec3d( view.origin );
		takeDrawn( view, data.position, data.triangles );
	}
	else
	{
		data.origin = impl.body->nodes().origin;
		takeCells( impl, data.position, data.triangles );
	}
	const NodeState& nodes = impl.body->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		data.nodes.push_back( nodes.worldPosition( i ) - data.origin );
	}
	data.tree.emplace( data.position, data.triangles );
	data.winding.emplace( data.position, data.triangles );
}

SurfaceQuery::~SurfaceQuery() = default;

NearestPoint SurfaceQuery::nearest( const btVector3& position ) const
{
	NearestPoint result;
	const Vec3d to = toVec3d( position ) - m_data->origin;
	const SolidTree::Nearest found = isFinite( position ) ? m_data->tree->nearest( to ) : SolidTree::Nearest{};
	if ( found.triangle < 0 )
	{
		return result;
	}
	const bool isInside = m_data->isInside( to );
	const double distance = std::sqrt( found.squaredDistance );
	const Vec3d face = m_data->normalOf( found.triangle );
	// At edges and corners the direction to the point is the normal; on the surface it is the triangle's.
	const Vec3d apart = ( isInside ? -1.0 : 1.0 ) * ( to - found.point );
	const Vec3d normal = distance * distance > face.norm() * kSurfaceRounding ? Vec3d( apart / distance ) : Vec3d( face.normalized() );
	result.point = toBt( m_data->origin + found.point );
	result.normal = toBt( normal );
	result.distance = btScalar( isInside ? -distance : distance );
	result.triangle = m_data->isDrawn ? found.triangle : -1;
	double best = SIMD_INFINITY;
	for ( std::size_t i = 0; i < m_data->nodes.size(); ++i )
	{
		const double square = ( m_data->nodes[i] - found.point ).squaredNorm();
		if ( square < best )
		{
			best = square;
			result.node = int( i );
		}
	}
	return result;
}

bool SurfaceQuery::isInside( const btVector3& position ) const
{
	return isFinite( position ) && m_data->isInside( toVec3d( position ) - m_data->origin );
}

bool SurfaceQuery::touchesSphere( const btVector3& centre, btScalar radius ) const
{
	if ( !isFinite( centre ) || !std::isfinite( radius ) || radius < 0 )
	{
		return false;
	}
	const Vec3d to = toVec3d( centre ) - m_data->origin;
	return m_data->tree->nearest( to ).squaredDistance <= double( radius ) * double( radius ) || m_data->isInside( to );
}

btScalar SurfaceQuery::volume() const
{
	double sum = 0.0;
	for ( std::size_t t = 0; t < m_data->triangles.size(); ++t )
	{
		sum += m_data->position[m_data->triangles[t][0]].dot( m_data->normalOf( int( t ) ) ) / 6.0;
	}
	return btScalar( sum );
}

btScalar SurfaceQuery::area() const
{
	double sum = 0.0;
	for ( std::size_t t = 0; t < m_data->triangles.size(); ++t )
	{
		sum += m_data->normalOf( int( t ) ).norm() / 2.0;
	}
	return btScalar( sum );
}

bool SurfaceQuery::isDrawn() const
{
	return m_data->isDrawn;
}

} // namespace pliant
