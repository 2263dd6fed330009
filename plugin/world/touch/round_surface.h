#pragma once

// What two soft bodies' surfaces are to each other where both step implicitly: rounder than their nodes' spheres. docs/design/contacts.md.

#include "lattice/lattice.h"

namespace pliant {

class SoftBody;

/// A sphere that touches a face of the body where the node's own does, with its centre on the way to the node behind it. What presses on it
/// presses on both.
struct RoundSphere
{
	int inner = -1;                ///< the node behind; -1: it is the node's own sphere
	double fraction = 0.0;         ///< of the way to it
	Vec3d inwards = Vec3d::Zero(); ///< from the node to the sphere's centre, m
};

/// Whether the two bodies meet in such spheres.
bool meetRound( const SoftBody& a, const SoftBody& b );
/// Of a node, against what lies `towards`, m.
RoundSphere roundSphere( const SoftBody& body, int node, const Vec3d& towards );

} // namespace pliant
