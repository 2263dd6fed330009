#pragma once

// How far two bodies made from the same mesh are from each other, vertex by vertex.

#include <pliant/soft_body.h>

#include <vector>

namespace pliant_demos {

struct SkinDistance
{
	std::vector<float> vertex;      ///< m
	double mean = 0, deviation = 0; ///< over the vertices, m
	double shape = 0;               ///< mean with the difference of the two middles taken off, m
	double largest = 0;             ///< m
};

/// `apart`: from where `reference` stands to where `body` stands when they are equal.
SkinDistance skinDistance( const pliant::SoftBody& body, const pliant::SoftBody& reference, const btVector3& apart );

/// Of the skin as it is now, m.
double boxDiagonal( const pliant::SoftBody& body );

/// Red, green, blue for each vertex: teal at 0, ochre halfway, brick at `full` (m) and beyond.
std::vector<float> heatColours( const std::vector<float>& distances, double full );

} // namespace pliant_demos
