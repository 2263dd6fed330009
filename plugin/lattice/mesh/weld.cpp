// Welds coincident vertices, found through a sorted grid of buckets and a search across bucket borders.

#include "lattice/mesh/weld.h"

#include "lattice/attempt.h"
#include "lattice/constants.h"
#include "lattice/union_find.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace pliant {

namespace {

void checkCounts( const MeshView& mesh, const LatticeSettings& settings )
{
	rejectIf( mesh.vertexCount == 0 || mesh.triangleCount == 0, ResultCode::EmptyMesh, "The mesh has no vertex or no triangle." );
	rejectIf( !mesh.positions || !mesh.indices || mesh.positionStride < 3, ResultCode::BadArgument,
		"The mesh needs positions, indices and a positionStride of at least 3." );
	if ( mesh.triangleCount > std::size_t( settings.maxTriangles ) )
	{
		reject( ResultCode::TooManyTriangles,
			"The mesh has " + std::to_string( mesh.triangleCount ) + " triangles; LatticeSettings::maxTriangles allows " +
				std::to_string( settings.maxTriangles ) + "." );
	}
	// A triangle uses at most three vertices; far more vertices are an error and would waste memory.
	if ( mesh.vertexCount > 3 * std::size_t( settings.maxTriangles ) )
	{
		reject( ResultCode::TooManyTriangles,
			"The mesh has " + std::to_string( mesh.vertexCount ) +
				" vertices, more than three for each of LatticeSettings::maxTriangles." );
	}
}

void checkNumbers( const MeshView& mesh )
{
	for ( std::size_t i = 0; i < mesh.vertexCount; ++i )
	{
		const float* p = mesh.positions + i * mesh.positionStride;
		if ( !std::isfinite( p[0] ) || !std::isfinite( p[1] ) || !std::isfinite( p[2] ) )
		{
			reject( ResultCode::NonFiniteVertex, "Vertex " + std::to_string( i ) + " has a coordinate that is NaN or infinite." );
		}
	}
	for ( std::size_t k = 0; mesh.tangents && k < 4 * mesh.vertexCount; ++k )
	{
		if ( !std::isfinite( mesh.tangents[k] ) )
		{
			reject( ResultCode::NonFiniteVertex,
				"The tangent of vertex " + std::to_string( k / 4 ) + " has a number that is NaN or infinite." );
		}
	}
	for ( std::size_t k = 0; k < 3 * mesh.triangleCount; ++k )
	{
		if ( mesh.indices[k] >= mesh.vertexCount )
		{
			reject( ResultCode::IndexOutOfRange,
				"Triangle " + std::to_string( k / 3 ) + " refers to vertex " + std::to_string( mesh.indices[k] ) + " of " +
					std::to_string( mesh.vertexCount ) + "." );
		}
	}
}

Vec3d positionOf( const MeshView& mesh, std::size_t i )
{
	const float* p = mesh.positions + i * mesh.positionStride;
	return Vec3d( p[0], p[1], p[2] );
}

void boundingBox( const MeshView& mesh, WeldedMesh& out )
{
	out.low = out.high = positionOf( mesh, mesh.indices[0] );
	for ( std::size_t k = 1; k < 3 * mesh.triangleCount; ++k )
	{
		const Vec3d p = positionOf( mesh, mesh.indices[k] );
		out.low = out.low.cwiseMin( p );
		out.high = out.high.cwiseMax( p );
	}
	const double diagonal = ( out.high - out.low ).norm();
	if ( diagonal > kLargestDiagonal )
	{
		reject( ResultCode::ExtentOutOfRange,
			"The mesh is " + std::to_string( diagonal ) + " m across, more than the 1e7 m that float arithmetic supports." );
	}
	rejectIf( diagonal == 0.0, ResultCode::ZeroVolume, "All triangles lie at one point: there is no inside." );
	rejectIf( diagonal < kSmallestDiagonal, ResultCode::ExtentOutOfRange,
		"The mesh is less than 1e-7 m across, too small for float arithmetic." );
}

/// Rejects a surface so crumpled that no cell size can resolve its layers, before the expensive part begins.
void checkFolds( const MeshView& mesh, const WeldedMesh& box )
{
	double area = 0.0;
	for ( std::size_t t = 0; t < mesh.triangleCount; ++t )
	{
		const std::uint32_t* corner = mesh.indices + 3 * t;
		const Vec3d a = positionOf( mesh, corner[0] );
		area += 0.5 * ( positionOf( mesh, corner[1] ) - a ).cross( positionOf( mesh, corner[2] ) - a ).norm();
	}
	rejectIf( area > kMaxFolds * ( box.high - box.low ).squaredNorm(), ResultCode::TooFolded,
		"The surface is folded thousands of times into its bounding box: no cell size can separate its layers." );
}

/// A vertex and its bucket. Outliers that no triangle uses are clamped to the border buckets; welding still depends on distances.
struct Slot
{
	std::uint64_t bucket;
	std::uint32_t vertex;
};

class Welder
{
public:
	Welder( const MeshView& mesh, const WeldedMesh& box ) :
		m_mesh( mesh ), m_low( box.low ), m_tolerance( box.tolerance ), m_sets( mesh.vertexCount )
	{
		m_width = std::max( kTolerancesPerBucket * m_tolerance, ( box.high - box.low ).norm() / kMaxBuckets );
		m_slots.reserve( mesh.vertexCount );
		for ( std::size_t i = 0; i < mesh.vertexCount; ++i )
		{
			m_slots.push_back( { pack( bucketOf( positionOf( mesh, i ) ) ), std::uint32_t( i ) } );
		}
		std::sort( m_slots.begin(), m_slots.end(),
			[]( const Slot& a, const Slot& b ) { return a.bucket != b.bucket ? a.bucket < b.bucket : a.vertex < b.vertex; } );
	}

	void weld()
	{
		for ( std::size_t first = 0; first < m_slots.size(); )
		{
			std::size_t last = first;
			while ( last < m_slots.size() && m_slots[last].bucket == m_slots[first].bucket )
			{
				++last;
			}
			weldBucket( first, last );
			first = last;
		}
		if ( m_tolerance > 0.0 )
		{
			for ( std::size_t k = 0; k < m_slots.size(); ++k )
			{
				weldAcross( k );
			}
		}
	}

	std::uint32_t rootOf( std::size_t vertex ) { return m_sets.find( std::uint32_t( vertex ) ); }

private:
	using Bucket = Eigen::Matrix<std::int64_t, 3, 1>;

	Bucket bucketOf( const Vec3d& p ) const
	{
		return ( ( p - m_low ) / m_width ).array().floor().max( 0.0 ).min( kMaxBuckets - 1.0 ).cast<std::int64_t>();
	}

	static std::uint64_t pack( const Bucket& b )
	{
		return ( std::uint64_t( b.z() ) << 40 ) | ( std::uint64_t( b.y() ) << 20 ) | std::uint64_t( b.x() );
	}

	bool areCoincident( std::uint32_t a, std::uint32_t b ) const
	{
		return ( positionOf( m_mesh, a ) - positionOf( m_mesh, b ) ).squaredNorm() <= m_tolerance * m_tolerance;
	}

	void weldBucket( std::size_t first, std::size_t last )
	{
		if ( last - first > kCrowdedBucket )
		{
			first = joinEqual( first, last );
		}
		const bool isCrowded = last - first > kCrowdedBucket && m_tolerance > 0.0;
		for ( std::size_t i = first; i < last; ++i )
		{
			for ( std::size_t j = i + 1; j < ( isCrowded ? std::min( i + 2, last ) : last ); ++j )
			{
				if ( isCrowded || areCoincident( m_slots[i].vertex, m_slots[j].vertex ) )
				{
					m_sets.join( m_slots[i].vertex, m_slots[j].vertex );
				}
			}
		}
	}

	/// Joins exact duplicates and moves one of each to the end of the bucket's range; returns where those begin.
	std::size_t joinEqual( std::size_t first, std::size_t last )
	{
		const auto key = [this]( const Slot& s ) {
			const Vec3d p = positionOf( m_mesh, s.vertex );
			return std::array<double, 4>{ p.x(), p.y(), p.z(), double( s.vertex ) };
		};
		const auto begin = m_slots.begin();
		std::sort( begin + std::ptrdiff_t( first ), begin + std::ptrdiff_t( last ),
			[&]( const Slot& a, const Slot& b ) { return key( a ) < key( b ); } );
		std::size_t out = last - 1;
		for ( std::size_t i = last - 1; i-- > first; )
		{
			if ( positionOf( m_mesh, m_slots[i].vertex ) == positionOf( m_mesh, m_slots[out].vertex ) )
			{
				m_sets.join( m_slots[i].vertex, m_slots[out].vertex );
			}
			else
			{
				std::swap( m_slots[--out], m_slots[i] );
			}
		}
		return out;
	}

	/// Searches the other buckets that a ball of one tolerance around the vertex touches.
	void weldAcross( std::size_t k )
	{
		const Vec3d p = positionOf( m_mesh, m_slots[k].vertex );
		const Vec3d reach = Vec3d::Constant( m_tolerance );
		const Bucket low = bucketOf( p - reach );
		const Bucket high = bucketOf( p + reach );
		for ( std::int64_t z = low.z(); z <= high.z(); ++z )
		{
			for ( std::int64_t y = low.y(); y <= high.y(); ++y )
			{
				for ( std::int64_t x = low.x(); x <= high.x(); ++x )
				{
					// Each pair is visited from both sides; one is enough.
					if ( const std::uint64_t bucket = pack( Bucket( x, y, z ) ); bucket > m_slots[k].bucket )
					{
						weldWith( k, bucket );
					}
				}
			}
		}
	}

	void weldWith( std::size_t k, std::uint64_t bucket )
	{
		auto other = std::lower_bound(
			m_slots.begin(), m_slots.end(), bucket, []( const Slot& slot, std::uint64_t wanted ) { return slot.bucket < wanted; } );
		std::size_t visited = 0;
		for ( ; other != m_slots.end() && other->bucket == bucket && visited <= kCrowdedBucket; ++other, ++visited )
		{
			if ( areCoincident( m_slots[k].vertex, other->vertex ) )
			{
				m_sets.join( m_slots[k].vertex, other->vertex );
			}
		}
	}

	const MeshView& m_mesh;
	Vec3d m_low;
	double m_tolerance;
	double m_width = 0.0;
	UnionFind m_sets;
	std::vector<Slot> m_slots;
};

} // namespace

Status weldMesh( const MeshView& mesh, const LatticeSettings& settings, WeldedMesh& out, BuildReport& report )
{
	Status status = attempt( [&]() {
		checkCounts( mesh, settings );
		checkNumbers( mesh );
		boundingBox( mesh, out );
		checkFolds( mesh, out );
	} );
	if ( !status.ok() )
	{
		return status;
	}
	out.tolerance = double( settings.weldTolerance ) * ( out.high - out.low ).norm();

	Welder welder( mesh, out );
	welder.weld();
	out.weldedVertex.resize( mesh.vertexCount );
	out.position.clear();
	for ( std::size_t i = 0; i < mesh.vertexCount; ++i )
	{
		// The lowest vertex represents its set and comes first.
		const std::uint32_t root = welder.rootOf( i );
		if ( root == i )
		{
			out.weldedVertex[i] = std::uint32_t( out.position.size() );
			out.position.push_back( positionOf( mesh, i ) );
		}
		else
		{
			out.weldedVertex[i] = out.weldedVertex[root];
		}
	}
	report.weldedVertices = int( mesh.vertexCount - out.position.size() );

	out.triangle.resize( mesh.triangleCount );
	for ( std::size_t t = 0; t < mesh.triangleCount; ++t )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			out.triangle[t][k] = out.weldedVertex[mesh.indices[3 * t + k]];
		}
	}
	return {};
}

} // namespace pliant
