#pragma once

// Distances between two bodies made from the same mesh, vertex by vertex.

#include <pliant/soft_body.h>

#include <vector>

namespace pliant_demos {

struct SkinDistance
{
	std::vector<float> vertex;      ///< m
	double mean = 0, deviation = 0; ///< over the vertices, m
	double shape = 0;               ///< mean, without the difference of the two centres, m
	double largest = 0;             ///< m
};

/// `apart`: displacement from `reference` to `body` when the two are equal.
SkinDistance skinDistance( const pliant::SoftBody& body, const pliant::SoftBody& reference, const btVector3& apart );

/// Of the present skin, m.
double boxDiagonal( const pliant::SoftBody& body );

/// Red, green, blue for each vertex: teal at 0, ochre halfway, brick at `full` (m) and beyond.
std::vector<float> heatColours( const std::vector<float>& distances, double full );

} // namespace pliant_demos
