#pragma once

// A sphere of triangles about as large as its cells that can be cracked and bent.

#include "surface/drawn_by_definition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace pliant::test {

inline constexpr double kCell = 0.2;

/// A bend about z by `angle` over a length of 1, and the rotation there.
inline Vec3 bent( const Vec3& x, float angle )
{
	const float a = angle * x.x();
	return Vec3( std::sin( a ) / angle - x.y() * std::sin( a ), x.y() * std::cos( a ) + ( 1.0f - std::cos( a ) ) / angle, x.z() );
}

inline Eigen::Matrix3f turnOfBend( const Vec3& x, float angle )
{
	return Eigen::AngleAxisf( angle * x.x(), Vec3::UnitZ() ).toRotationMatrix();
}

/// A sphere of triangles about as large as its cells, and a crack at one position of it.
struct Cracked
{
	/// `hasSeams`: no two triangles share a vertex.
	explicit Cracked( int rings = 24, double cell = kCell, bool hasSeams = false ) :
		it( hasSeams ? unwelded( makeSphere( 1.0, rings, rings * 3 / 2 ) ) : makeSphere( 1.0, rings, rings * 3 / 2 ), cell, noisy() ),
		surface( it.complex ), withCuts( withAllCuts( it.complex ) )
	{}

	/// Breaks faces above a height between cells on either side of the middle.
	void crack( float height )
	{
		std::vector<std::uint32_t> faces;
		for ( std::uint32_t f = 0; f < std::uint32_t( it.complex->face.size() ); ++f )
		{
			const Vec3 &a = it.lattice().restCentre[it.complex->face[f].cellA], &b = it.lattice().restCentre[it.complex->face[f].cellB];
			if ( std::min( a.z(), b.z() ) > height && ( a.x() < 0.0f ) != ( b.x() < 0.0f ) )
			{
				faces.push_back( f );
			}
		}
		EXPECT_FALSE( faces.empty() );
		breakFaces( faces );
	}

	void breakFaces( const std::vector<std::uint32_t>& faces )
	{
		surface.breakFaces( faces );
		withCuts.breakFaces( faces );
		expectValid( surface );
	}

	void bend( float angle )
	{
		it.deform( [=]( const Vec3& x ) { return bent( x, angle ); }, [=]( const Vec3& x ) { return turnOfBend( x, angle ); } );
	}

	void skinAs( const DrawnCracks& shown, TaskRunner* runner = nullptr )
	{
		positions.assign( 3 * std::size_t( shown.vertexCount() ), 1e9f );
		normals = positions;
		const SkinTriangles triangles{ shown.triangles()[0].data(), int( shown.triangles().size() ) };
		skin( shown.binding(), it.nodes, SkinPose{ .rotations = it.rotations.data() }, triangles, it.scratch, positions.data(),
			normals.data(), runner );
	}

	Vec3 position( std::uint32_t v ) const { return Eigen::Map<const Vec3>( &positions[3 * std::size_t( v )] ); }
	Vec3 normal( std::uint32_t v ) const { return Eigen::Map<const Vec3>( &normals[3 * std::size_t( v )] ); }

	/// Of the points where broken faces pass.
	float distanceToCrack( const Vec3& rest ) const
	{
		float least = 1e9f;
		for ( std::uint32_t f = 0; f < std::uint32_t( it.complex->face.size() ); ++f )
		{
			for ( const std::uint32_t* p = it.complex->pointsOfFace.begin( f );
				  surface.isBroken( f ) && p != it.complex->pointsOfFace.end( f ); ++p )
			{
				least = std::min( least, ( it.complex->pointRest[*p] - rest ).norm() );
			}
		}
		return least;
	}

	CrackCase it;
	DrawnCracks surface, withCuts; ///< with panels as in the input, and with all their cuts
	std::vector<float> positions, normals;
};

} // namespace pliant::test
