#pragma once

// A mesh, its lattice, its nodes and its skin in one line, and deformations to try on them.

#include "lattice/build/build_lattice.h"
#include "lattice/test_meshes.h"
#include "matching/rotation.h"
#include "support/block_body.h"
#include "surface/skin/skinning.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

namespace pliant::test {

struct SkinCase
{
	Mesh mesh;
	LatticeBuild built;
	SkinBinding binding;
	NodeState nodes;
	std::vector<float> rotations;
	const float* flow = nullptr; ///< SkinPose::flow
	std::vector<float> positions, normals;
	SkinScratch scratch;

	SkinCase( Mesh skinned, double cellSize, Skinning kind = Skinning::NearbyNodes ) : mesh( std::move( skinned ) )
	{
		LatticeSettings settings;
		settings.cellSize = float( cellSize );
		Result<LatticeBuild> result = buildLattice( mesh.view(), settings );
		EXPECT_TRUE( result.ok() ) << result.status.sentence;
		built = std::move( result.value );
		binding = bindSkin( mesh.view(), built.lattice, built.weldedVertex, kind );
		nodes = restNodes( built.lattice );
		rotations.assign( 4 * std::size_t( nodes.count ), 0.0f );
		turnNodes( []( const Vec3& ) { return Eigen::Matrix3f( Eigen::Matrix3f::Identity() ); } );
	}

	int vertexCount() const { return int( mesh.vertexCount() ); }
	const Lattice& lattice() const { return built.lattice; }

	/// A rest vertex relative to the mass centre.
	Vec3 rest( int v ) const { return Eigen::Map<const Vec3>( mesh.positions.data() + 3 * v ) - built.lattice.massCentre.cast<float>(); }
	Vec3 position( int v ) const { return Eigen::Map<const Vec3>( positions.data() + 3 * v ); }
	Vec3 normal( int v ) const { return Eigen::Map<const Vec3>( normals.data() + 3 * v ); }
	Vec3 corner( std::size_t triangle, int k ) const { return position( int( mesh.indices[3 * triangle + std::size_t( k )] ) ); }

	/// Node positions by a map of the rest shape, node rotations from its gradient.
	void deform( const std::function<Vec3( const Vec3& )>& map, const std::function<Eigen::Matrix3f( const Vec3& )>& gradient )
	{
		for ( int i = 0; i < nodes.count; ++i )
		{
			nodes.x.set( i, map( nodes.x0.get( i ) ) );
		}
		turnNodes( gradient );
	}
	void turnNodes( const std::function<Eigen::Matrix3f( const Vec3& )>& gradient )
	{
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Eigen::Quaternionf q = fitRotation( gradient( nodes.x0.get( i ) ), Eigen::Quaternionf::Identity() );
			Eigen::Map<Eigen::Vector4f>( rotations.data() + 4 * i ) = q.coeffs();
		}
	}
	void affine( const Eigen::Matrix3f& a, const Vec3& shift = Vec3::Zero() )
	{
		deform( [&]( const Vec3& x ) { return Vec3( a * x + shift ); }, [&]( const Vec3& ) { return a; } );
	}

	void skinIt( TaskRunner* runner = nullptr )
	{
		positions.assign( mesh.positions.size(), 1e9f );
		normals.assign( mesh.positions.size(), 1e9f );
		const SkinTriangles triangles{ mesh.indices.data(), int( mesh.triangleCount() ) };
		SkinPose pose;
		pose.rotations = rotations.data();
		pose.flow = flow;
		skin( binding, nodes, pose, triangles, scratch, positions.data(), normals.data(), runner );
	}

	/// Largest distance of the skinned vertices from the positions given by a map of the rest shape, m.
	double largestError( const std::function<Vec3( const Vec3& )>& map ) const
	{
		double most = 0.0;
		for ( int v = 0; v < vertexCount(); ++v )
		{
			most = std::max( most, double( ( position( v ) - map( rest( v ) ) ).norm() ) );
		}
		return most;
	}
};

} // namespace pliant::test
