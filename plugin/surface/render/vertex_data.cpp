#include "surface/render/vertex_data.h"

#include "surface/constants.h"
#include "surface/render/skin_tables.h"
#include "threads/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

constexpr std::uint32_t kNone = CellComplex::kNone;

/// Any direction at a right angle to `normal`, which is a unit vector or zero.
Vec3 besideOf( const Vec3& normal )
{
	const Vec3 axis = std::abs( normal.x() ) < 0.6f ? Vec3::UnitX() : Vec3::UnitY();
	return ( axis - normal * normal.dot( axis ) ).normalized();
}

/// The part of a direction at a right angle to the normal, of unit length.
Vec3 straightened( const Vec3& direction, const Vec3& normal )
{
	const Vec3 beside = direction - normal * normal.dot( direction );
	const float length = beside.norm();
	return length > 1e-6f * direction.norm() && std::isfinite( length ) ? Vec3( beside / length ) : besideOf( normal );
}

VertexSource inputVertex( std::uint32_t vertex )
{
	return { { vertex, vertex, vertex }, { 1.0f, 0.0f, 0.0f } };
}

VertexSource sourceOf( const CellComplex& complex, std::uint32_t kind )
{
	if ( kind >= CrackPatches::kInside )
	{
		return { { VertexSource::kInside, VertexSource::kInside, VertexSource::kInside }, { 0.0f, 0.0f, 0.0f } };
	}
	if ( kind < complex.inputVertices )
	{
		return inputVertex( kind );
	}
	const CellComplex::Origin& origin = complex.addedOrigin[kind - complex.inputVertices];
	VertexSource source = inputVertex( origin.vertex[0] );
	for ( std::size_t k = 0; k < 3; ++k )
	{
		const bool isUsed = origin.vertex[k] != kNone;
		source.vertex[k] = isUsed ? origin.vertex[k] : origin.vertex[0];
		source.weight[k] = isUsed ? origin.weight[k] : 0.0f;
	}
	return source;
}

void store( const Vec3& tangent, float handedness, float* to )
{
	std::copy_n( tangent.data(), 3, to );
	to[3] = handedness;
}

/// Linear part of the map that moves a vertex.
Eigen::Matrix3f turnOf( const SkinBinding& binding, const SkinPose& pose, std::size_t vertex )
{
	using MapRows = Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>;
	Eigen::Matrix3f sum = Eigen::Matrix3f::Zero();
	const std::uint32_t carrier = binding.carrierOf( vertex );
	for ( std::uint32_t k = binding.start[carrier]; k < binding.start[carrier + 1]; ++k )
	{
		const std::uint32_t node = pose.slotOfCell ? pose.slotOfCell[binding.node[k]] : binding.node[k];
		sum += binding.weight[k] * MapRows( pose.maps + std::size_t( node ) * kSkinMapFloats ).leftCols<3>();
	}
	return sum;
}

} // namespace

std::vector<VertexSource> sourcesOf( const CrackView& cracks, const CellComplex& complex )
{
	std::vector<VertexSource> sources( cracks.binding.restPosition.size() );
	for ( std::size_t v = 0; v < sources.size(); ++v )
	{
		sources[v] = sourceOf( complex, cracks.kinds[v] );
	}
	return sources;
}

// The tangent of a triangle is dP/du; those of a vertex are summed with the triangles' areas.
std::vector<float> tangentsFromTexture(
	const float* positions, const float* texture, const SkinTriangles& triangles, const std::vector<Vec3>& normals )
{
	std::vector<Vec3> alongU( normals.size(), Vec3::Zero() ), alongV( normals.size(), Vec3::Zero() );
	const auto at = [&]( std::uint32_t v ) { return Eigen::Map<const Vec3>( positions + 3 * std::size_t( v ) ); };
	const auto textureAt = [&]( std::uint32_t v ) { return Eigen::Map<const Eigen::Vector2f>( texture + 2 * std::size_t( v ) ); };
	for ( int t = 0; t < triangles.count; ++t )
	{
		const std::uint32_t* const c = triangles.indices + 3 * std::size_t( t );
		const Vec3 a = at( c[1] ) - at( c[0] ), b = at( c[2] ) - at( c[0] );
		const Eigen::Vector2f u = textureAt( c[1] ) - textureAt( c[0] ), v = textureAt( c[2] ) - textureAt( c[0] );
		const float side = u.x() * v.y() - u.y() * v.x() < 0.0f ? -1.0f : 1.0f;
		const Vec3 du = side * ( v.y() * a - u.y() * b ), dv = side * ( u.x() * b - v.x() * a );
		const float area = a.cross( b ).norm(), length = du.norm(), width = dv.norm();
		for ( int k = 0; k < 3 && length > 0.0f && width > 0.0f; ++k )
		{
			alongU[c[k]] += du * ( area / length );
			alongV[c[k]] += dv * ( area / width );
		}
	}
	std::vector<float> tangents( 4 * normals.size() );
	for ( std::size_t v = 0; v < normals.size(); ++v )
	{
		const Vec3 tangent = straightened( alongU[v], normals[v] );
		store( tangent, normals[v].cross( tangent ).dot( alongV[v] ) < 0.0f ? -1.0f : 1.0f, tangents.data() + 4 * v );
	}
	return tangents;
}

std::vector<float> crackTangents( const CrackView& cracks, const std::vector<VertexSource>& sources, const float* input )
{
	std::vector<float> tangents( 4 * sources.size() );
	for ( std::size_t v = 0; v < sources.size(); ++v )
	{
		const VertexSource& source = sources[v];
		const Vec3& normal = cracks.binding.restNormal[v];
		if ( source.vertex[0] == VertexSource::kInside )
		{
			// u and v grow along the next two axes (CrackPatches::Appearance)
			const std::uint32_t kind = cracks.kinds[v];
			const int axis = int( ( kind - CrackPatches::kInside ) / 2 );
			store( Vec3::Unit( ( axis + 1 ) % 3 ), normal[axis] < 0.0f ? -1.0f : 1.0f, tangents.data() + 4 * v );
			continue;
		}
		Vec3 sum = Vec3::Zero();
		for ( int k = 0; k < 3; ++k )
		{
			sum += source.weight[k] * Eigen::Map<const Vec3>( input + 4 * std::size_t( source.vertex[k] ) );
		}
		store( straightened( sum, normal ), input[4 * std::size_t( source.vertex[0] ) + 3], tangents.data() + 4 * v );
	}
	return tangents;
}

void turnTangents( const SkinBinding& binding, const SkinPose& pose, const std::vector<float>& rest, const float* normals,
	std::vector<float>& tangents, TaskRunner* runner )
{
	tangents.resize( rest.size() );
	const std::size_t count = rest.size() / 4;
	const auto turned = [&]( std::size_t v, const Vec3& tangent ) { return Vec3( turnOf( binding, pose, v ) * tangent ); };
	const auto write = [&]( std::size_t v, const Vec3& direction ) {
		const Vec3 tangent = straightened( direction, Eigen::Map<const Vec3>( normals + 3 * v ) );
		store( tangent, rest[4 * v + 3], tangents.data() + 4 * v );
	};
	const auto restOf = [&]( std::size_t v ) { return Vec3( Eigen::Map<const Vec3>( rest.data() + 4 * v ) ); };
	auto task = [&]( int chunk ) {
		const std::size_t first = std::size_t( chunk ) * kVerticesPerTask, last = std::min( count, first + kVerticesPerTask );
		for ( std::size_t v = first; v < last; ++v )
		{
			write( v, turned( v, restOf( v ) ) );
		}
	};
	runTasks( runner, int( ( count + kVerticesPerTask - 1 ) / kVerticesPerTask ), task );
	for ( const SkinBinding::Placed& placed : binding.placed ) // their own rows are unused
	{
		Vec3 sum = Vec3::Zero();
		for ( std::size_t k = 0; k < 3; ++k )
		{
			sum += placed.weight[k] * turned( placed.corner[k], restOf( placed.vertex ) );
		}
		write( placed.vertex, sum );
	}
}

} // namespace pliant
