#include "surface/skinning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

/// Weights below this are dropped and the rest scaled up: a vertex then follows about a dozen nodes instead of 27.
constexpr float kSmallestWeight = 0.004f;

/// How far outside the nearest cell's box, in cells, a vertex may lie before its weights stop changing with the distance.
constexpr float kHalfCell = 0.5f;

using Coordinate = Eigen::Matrix<std::int16_t, 3, 1>;

bool before( const Coordinate& a, const Coordinate& b )
{
	return std::array{ a.z(), a.y(), a.x() } < std::array{ b.z(), b.y(), b.x() };
}

/// Finds the cells at lattice positions; cells are sorted by position.
class CellFinder
{
public:
	explicit CellFinder( const Lattice& lattice ) : m_lattice( lattice ) {}

	std::pair<int, int> at( const Eigen::Vector3i& position ) const
	{
		if ( ( position.array() < 0 ).any() || ( position.array() >= m_lattice.extent.array() ).any() )
		{
			return { 0, 0 };
		}
		const Coordinate wanted = position.cast<std::int16_t>();
		const auto range = std::equal_range( m_lattice.coordinate.begin(), m_lattice.coordinate.end(), wanted, before );
		return { int( range.first - m_lattice.coordinate.begin() ), int( range.second - m_lattice.coordinate.begin() ) };
	}

	/// The cell a surface point belongs to: of the cells around it the one whose material lies behind the surface there.
	/// `behind` is a point a little inside the material, in the mesh's coordinates.
	int owner( const Vec3d& point, const Vec3d& behind ) const
	{
		const Eigen::Vector3i home = ( ( point - m_lattice.corner ) / m_lattice.cellSize ).array().floor().cast<int>();
		for ( int reach = 1; reach <= kSearchReach; ++reach )
		{
			const int found = nearestWithin( home, reach, behind );
			if ( found >= 0 )
			{
				return found;
			}
		}
		return nearestOfAll( behind );
	}

private:
	static constexpr int kSearchReach = 3;

	double distance( int cell, const Vec3d& point ) const
	{
		const Vec3d centre = m_lattice.restCentre[cell].cast<double>() + m_lattice.massCentre;
		return ( centre - point ).squaredNorm();
	}

	int nearestWithin( const Eigen::Vector3i& home, int reach, const Vec3d& behind ) const
	{
		int best = -1;
		double bestDistance = std::numeric_limits<double>::max();
		for ( int z = -reach; z <= reach; ++z )
		{
			for ( int y = -reach; y <= reach; ++y )
			{
				for ( int x = -reach; x <= reach; ++x )
				{
					const auto [first, last] = at( home + Eigen::Vector3i( x, y, z ) );
					for ( int cell = first; cell < last; ++cell )
					{
						if ( distance( cell, behind ) < bestDistance )
						{
							bestDistance = distance( cell, behind );
							best = cell;
						}
					}
				}
			}
		}
		return best;
	}

	int nearestOfAll( const Vec3d& behind ) const
	{
		int best = 0;
		for ( int cell = 1; cell < m_lattice.cellCount(); ++cell )
		{
			best = distance( cell, behind ) < distance( best, behind ) ? cell : best;
		}
		return best;
	}

	const Lattice& m_lattice;
};

struct Share
{
	std::uint32_t node;
	float weight;
};

/// The quadratic B-spline over the cells at -1, 0 and +1, for a point at t in [-1/2, 1/2] of the middle one. Sums to 1, smooth across cells.
std::array<float, 3> splineWeights( float t )
{
	return { 0.5f * ( 0.5f - t ) * ( 0.5f - t ), 0.75f - t * t, 0.5f * ( 0.5f + t ) * ( 0.5f + t ) };
}

/// Trilinear weights of the middle cell's two corners, each shared by the two cells that meet there.
std::array<float, 3> trilinearWeights( float t )
{
	return { 0.5f * ( 0.5f - t ), 0.5f, 0.5f * ( 0.5f + t ) };
}

/// Owner and its links, weighted by place. Linked cells only: what lies across a gap or a crack has no say.
void collectShares( const Lattice& lattice, int owner, const Vec3d& point, Skinning kind, std::vector<Share>& shares )
{
	const auto home = lattice.coordinate[owner];
	std::array<std::array<float, 3>, 3> axis;
	for ( int k = 0; k < 3; ++k )
	{
		const double place = ( point[k] - lattice.corner[k] ) / lattice.cellSize - home[k] - 0.5;
		const float t = std::clamp( float( place ), -kHalfCell, kHalfCell );
		axis[k] = kind == Skinning::Trilinear ? trilinearWeights( t ) : splineWeights( t );
	}
	shares.assign( 1, Share{ std::uint32_t( owner ), axis[0][1] * axis[1][1] * axis[2][1] } );
	for ( std::uint32_t k = lattice.linkStart[owner]; k < lattice.linkStart[owner + 1]; ++k )
	{
		const std::uint32_t cell = lattice.linkTo[k];
		const auto step = lattice.coordinate[cell] - home;
		shares.push_back( Share{ cell, axis[0][step.x() + 1] * axis[1][step.y() + 1] * axis[2][step.z() + 1] } );
	}
	float sum = 0.0f;
	for ( const Share& share : shares )
	{
		sum += share.weight;
	}
	shares.erase( std::remove_if( shares.begin() + 1, shares.end(), [&]( const Share& s ) { return s.weight < kSmallestWeight * sum; } ), shares.end() );
	sum = 0.0f;
	for ( const Share& share : shares )
	{
		sum += share.weight;
	}
	for ( Share& share : shares )
	{
		share.weight /= sum;
	}
}

Vec3d meshVertex( const MeshView& mesh, std::size_t i )
{
	const float* p = mesh.positions + i * mesh.positionStride;
	return { p[0], p[1], p[2] };
}

/// Area-weighted normals of the rest mesh, one a group.
std::vector<Vec3d> groupNormals( const MeshView& mesh, const std::vector<std::uint32_t>& group, int groups )
{
	std::vector<Vec3d> normal( groups, Vec3d::Zero() );
	for ( std::size_t t = 0; t < mesh.triangleCount; ++t )
	{
		const std::uint32_t* corner = mesh.indices + 3 * t;
		const Vec3d a = meshVertex( mesh, corner[0] ), b = meshVertex( mesh, corner[1] ), c = meshVertex( mesh, corner[2] );
		const Vec3d area = ( b - a ).cross( c - a );
		for ( int k = 0; k < 3; ++k )
		{
			normal[group[corner[k]]] += area;
		}
	}
	return normal;
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

	// Vertices at one place share one normal, so that seams of texture coordinates stay smooth.
	std::vector<std::uint32_t> number( mesh.vertexCount, std::numeric_limits<std::uint32_t>::max() );
	binding.normalGroup.resize( mesh.vertexCount );
	for ( std::size_t i = 0; i < mesh.vertexCount; ++i )
	{
		std::uint32_t& group = number[weldedVertex.empty() ? i : weldedVertex[i]];
		if ( group == std::numeric_limits<std::uint32_t>::max() )
		{
			group = std::uint32_t( binding.normalGroups++ );
		}
		binding.normalGroup[i] = group;
	}
	const std::vector<Vec3d> normal = groupNormals( mesh, binding.normalGroup, binding.normalGroups );

	const CellFinder finder( lattice );
	std::vector<Share> shares;
	binding.start.assign( 1, 0 );
	binding.restPosition.reserve( mesh.vertexCount );
	binding.restNormal.reserve( mesh.vertexCount );
	for ( std::size_t i = 0; i < mesh.vertexCount; ++i )
	{
		const Vec3d point = meshVertex( mesh, i );
		const Vec3d outward = normal[binding.normalGroup[i]].stableNormalized();
		const Vec3d behind = point - 0.5 * lattice.cellSize * outward;
		collectShares( lattice, finder.owner( point, behind ), point, kind, shares );
		for ( const Share& share : shares )
		{
			binding.node.push_back( share.node );
			binding.weight.push_back( share.weight );
		}
		binding.start.push_back( std::uint32_t( binding.node.size() ) );
		binding.restPosition.push_back( ( point - lattice.massCentre ).cast<float>() );
		binding.restNormal.push_back( outward.cast<float>() );
	}
	return binding;
}

namespace {

constexpr int kMapFloats = 16;

/// A node's affine map from rest to now, twelve floats in a line of sixteen: columns of R, then x - R x0.
void fillMaps( const NodeState& state, const float* rotations, AlignedArray<float>& maps )
{
	maps.resize( std::size_t( state.count ) * kMapFloats );
	for ( int i = 0; i < state.count; ++i )
	{
		const Eigen::Quaternionf q( rotations[4 * i + 3], rotations[4 * i], rotations[4 * i + 1], rotations[4 * i + 2] );
		const Eigen::Matrix3f r = q.toRotationMatrix();
		const Vec3 t = state.x.get( i ) - r * state.x0.get( i );
		float* to = maps.data() + std::size_t( i ) * kMapFloats;
		for ( int column = 0; column < 3; ++column )
		{
			to[4 * column + 0] = r( 0, column );
			to[4 * column + 1] = r( 1, column );
			to[4 * column + 2] = r( 2, column );
			to[4 * column + 3] = 0.0f;
		}
		to[12] = t.x();
		to[13] = t.y();
		to[14] = t.z();
		to[15] = 0.0f;
	}
}

/// x = sum w ( x_n + R_n ( X - x0_n ) ): the maps are blended first, then applied once.
void writePositions( const SkinBinding& binding, const AlignedArray<float>& maps, float* positions )
{
	const std::size_t vertices = binding.restPosition.size();
	for ( std::size_t v = 0; v < vertices; ++v )
	{
		alignas( 64 ) float blend[kMapFloats] = {};
		for ( std::uint32_t k = binding.start[v]; k < binding.start[v + 1]; ++k )
		{
			const float* map = maps.data() + std::size_t( binding.node[k] ) * kMapFloats;
			const float weight = binding.weight[k];
			for ( int j = 0; j < kMapFloats; ++j )
			{
				blend[j] += weight * map[j];
			}
		}
		const Vec3& at = binding.restPosition[v];
		for ( int row = 0; row < 3; ++row )
		{
			positions[3 * v + row] = ( blend[row] * at.x() + blend[4 + row] * at.y() ) + ( blend[8 + row] * at.z() + blend[12 + row] );
		}
	}
}

void writeNormals( const SkinBinding& binding, const SkinTriangles& triangles, const float* positions, SkinScratch& scratch, float* normals )
{
	scratch.groupNormal.assign( std::size_t( binding.normalGroups ) * 3, 0.0f );
	for ( int t = 0; t < triangles.count; ++t )
	{
		const std::uint32_t* corner = triangles.indices + 3 * std::size_t( t );
		const Eigen::Map<const Vec3> a( positions + 3 * std::size_t( corner[0] ) ), b( positions + 3 * std::size_t( corner[1] ) ),
			c( positions + 3 * std::size_t( corner[2] ) );
		const Vec3 area = ( b - a ).cross( c - a );
		for ( int k = 0; k < 3; ++k )
		{
			Eigen::Map<Vec3>( scratch.groupNormal.data() + 3 * std::size_t( binding.normalGroup[corner[k]] ) ) += area;
		}
	}
	for ( std::size_t i = 0; i < binding.normalGroup.size(); ++i )
	{
		const Eigen::Map<const Vec3> sum( scratch.groupNormal.data() + 3 * std::size_t( binding.normalGroup[i] ) );
		const float length = sum.norm();
		// A vertex of no triangle, or of triangles without area, keeps its rest normal: there is nothing to measure.
		const Vec3 unit = length > 0.0f ? Vec3( sum / length ) : binding.restNormal[i];
		Eigen::Map<Vec3>( normals + 3 * i ) = unit;
	}
}

} // namespace

void skin( const SkinBinding& binding, const NodeState& state, const float* rotations, const SkinTriangles& triangles, SkinScratch& scratch,
	float* positions, float* normals )
{
	if ( binding.kind == Skinning::None )
	{
		return;
	}
	fillMaps( state, rotations, scratch.nodeMap );
	writePositions( binding, scratch.nodeMap, positions );
	writeNormals( binding, triangles, positions, scratch, normals );
}

} // namespace pliant
