#pragma once

// Contact spheres between two soft bodies that do not touch in their drawn surfaces, larger than their nodes' spheres.
// docs/design/contacts.md.

#include "lattice/lattice.h"

namespace pliant {

class SoftBody;

/// A sphere that touches a face where the node's own does, centred between the node and the one behind it; impulses act on both.
struct RoundSphere
{
	int inner = -1;                ///< the node behind; -1: this is the node's own sphere
	double fraction = 0.0;         ///< of the distance to it
	Vec3d inwards = Vec3d::Zero(); ///< from the node to the sphere's centre, m
};

/// Whether the two bodies touch each other in such spheres.
bool useRoundSpheres( const SoftBody& a, const SoftBody& b );
/// The sphere of a node for an object in the direction `towards`, m.
RoundSphere roundSphere( const SoftBody& body, int node, const Vec3d& towards );

} // namespace pliant
