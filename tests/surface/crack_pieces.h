#pragma once

// Bodies broken into pieces, and their invariants.

#include "surface/crack_case.h"

#include "support/drawn_cracks.h"

#include <algorithm>
#include <map>
#include <random>

namespace pliant::test {

inline CrackSettings noisy( float amplitude = 0.3f )
{
	CrackSettings settings;
	settings.noiseAmplitude = amplitude;
	settings.subdivision = amplitude > 0.0f ? 2 : 1;
	return settings;
}

inline double volumeOf( const DrawnCracks& surface )
{
	double sum = 0.0;
	const auto at = [&]( std::uint32_t v ) { return Vec3d( surface.binding().restPosition[v].cast<double>() ); };
	for ( const TrianglePoints& t : surface.triangles() )
	{
		sum += signedVolume( at( t[0] ), at( t[1] ), at( t[2] ) );
	}
	return sum;
}

/// Vertices of one side at one position are one: the surface without the seams of normals and texture coordinates.
inline std::vector<TrianglePoints> welded( const DrawnCracks& surface )
{
	std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> number;
	std::vector<std::uint32_t> of( surface.vertexCount() );
	for ( std::uint32_t v = 0; v < surface.vertexCount(); ++v )
	{
		of[v] = number.emplace( surface.sideOf( v ), std::uint32_t( number.size() ) ).first->second;
	}
	std::vector<TrianglePoints> out;
	for ( const TrianglePoints& t : surface.triangles() )
	{
		out.push_back( { of[t[0]], of[t[1]], of[t[2]] } );
	}
	return out;
}

/// Cells by their nearest seed, measured along the lattice.
inline std::vector<std::vector<std::uint32_t>> shatter( const Lattice& lattice, int pieces, unsigned seed )
{
	std::mt19937 random( seed );
	std::vector<Vec3> middle;
	for ( int k = 0; k < pieces; ++k )
	{
		middle.push_back( lattice.restCentre[random() % lattice.restCentre.size()] );
	}
	std::vector<std::vector<std::uint32_t>> out( middle.size() );
	for ( std::uint32_t cell = 0; cell < std::uint32_t( lattice.cellCount() ); ++cell )
	{
		const auto nearest = std::min_element( middle.begin(), middle.end(), [&]( const Vec3& a, const Vec3& b ) {
			return ( a - lattice.restCentre[cell] ).squaredNorm() < ( b - lattice.restCentre[cell] ).squaredNorm();
		} );
		out[std::size_t( nearest - middle.begin() )].push_back( cell );
	}
	return out;
}

inline std::vector<std::uint32_t> facesBetween( const CellComplex& complex, const std::vector<std::vector<std::uint32_t>>& pieces )
{
	std::vector<std::size_t> of( complex.cellCount() );
	for ( std::size_t k = 0; k < pieces.size(); ++k )
	{
		for ( const std::uint32_t cell : pieces[k] )
		{
			of[cell] = k;
		}
	}
	std::vector<std::uint32_t> faces;
	for ( std::uint32_t f = 0; f < complex.face.size(); ++f )
	{
		if ( of[complex.face[f].cellA] != of[complex.face[f].cellB] )
		{
			faces.push_back( f );
		}
	}
	return faces;
}

/// Copies of one side have equal carriers, to the bit, so that no seam can open between them.
inline void expectNoSeams( const DrawnCracks& surface )
{
	const SkinBinding& b = surface.binding();
	std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> first;
	int seams = 0;
	for ( std::uint32_t v = 0; v < surface.vertexCount(); ++v )
	{
		const std::uint32_t w = first.emplace( surface.sideOf( v ), v ).first->second;
		const auto row = [&b]( const auto& list, std::uint32_t i ) {
			return std::vector( list.begin() + b.start[b.carrierOf( i )], list.begin() + b.start[b.carrierOf( i ) + 1] );
		};
		seams += row( b.node, v ) != row( b.node, w ) || row( b.weight, v ) != row( b.weight, w ) || b.restPosition[v] != b.restPosition[w];
	}
	EXPECT_EQ( seams, 0 );
}

} // namespace pliant::test
