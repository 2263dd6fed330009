#pragma once

// What touches see of a soft body's surface: in front of most of its nodes the sphere that fits the drawn surface there (ContactPatch)
// instead of the node's own, and for any point of it the nodes that share it. docs/design/contacts.md.

#include "lattice/axis_neighbours.h"
#include "lattice/lattice.h"
#include "world/constants.h"
#include "world/touch/node_touch.h"
#include "world/touch/shared_nodes.h"

#include <algorithm>
#include <cmath>

namespace pliant {

class Body;
struct NodeState;

class ContactSurface
{
public:
	/// Looks at the body's lattice where it has changed: `version` is another then. Bodies with levels have no patches, and their nodes
	/// share nothing.
	void follow( const Body& body, unsigned version );

	/// The patch of a node as the body is deformed now.
	struct Patch
	{
		Vec3d normal = Vec3d::UnitY(); ///< outwards, of unit length, world axes
		double height = 0.0;           ///< from the node along the normal to the surface, m
		double radius = 0.0;           ///< m

		bool isFlat( double cellSize ) const { return radius > kFlatRadius * cellSize; }
	};
	/// False where the node has none: at edges, in thin parts, at crack faces, where what is around it is crushed.
	bool patchOf( const NodeState& nodes, int node, Patch& patch ) const;
	bool hasPatches() const { return m_hasPatches; }
	/// Of bodies without levels; else empty.
	const AxisNeighbours& beside() const { return m_beside; }
	/// How much further the surface lies in front of a node than half a cell, at most, m.
	double overhang() const { return m_overhang; }
	double cellSize() const { return m_cellSize; }

	/// The nodes that share a contact. `at`: from the node's centre to its point, m, any point on the line along `normal` for what presses.
	/// What is returned presses along that line and rubs at `at`, which is moved to where the nodes can share it: not at all but in crumbs,
	/// sheets and crushed parts.
	SharedNodes fraction( const NodeState& nodes, int node, const Vec3d& normal, Vec3d& at ) const;

	/// The radius of the sphere that rolls over what touches a node, m, as the touching point runs along its patch; 0: the point stays
	/// where it is.
	double rollingRadius( const NodeState& nodes, int node, const Vec3d& outwards ) const;

private:
	struct Axes;
	bool axesOf( const NodeState& nodes, int node, const Vec3d& along, Axes& axes ) const;

	const Lattice* m_lattice = nullptr;
	unsigned m_version = 0;
	std::size_t m_links = 0;
	AxisNeighbours m_beside; ///< empty: nothing is shared
	bool m_hasPatches = false;
	double m_cellSize = 0.0, m_overhang = 0.0;
};

/// What a patch says of an obstacle.
enum class PatchAnswer : int
{
	UseSphere, ///< the patch does not face the obstacle; the node's own sphere may touch it
	Clear,     ///< it does not touch
	Touches
};

/// Where a patch touches an obstacle. `nearest( sphere, touch )`: what findNearest says of a sphere; `find( sphere, touch )`: what
/// findTouch says. The distance is that of the node's own sphere that would be as near (Touch::distance), and Touch::aside and Touch::reach
/// say where on the surface the point is.
///
/// The patch is a sphere of radius R, its centre R - h behind the node, h the height of the surface. Against something in a direction whose
/// angle with the normal has the sine s it touches ( R - h ) s aside of the node's line; so that it does not answer for what is in front of
/// other nodes, there is a smaller sphere where that is further than they are away.
template <class Nearest, class Find>
PatchAnswer findPatchTouch(
	const ContactSurface::Patch& patch, double cellSize, const MovingSphere& own, const Nearest& nearest, const Find& find, Touch& touch )
{
	const double flat = patch.radius - patch.height, most = kPatchHalfWidth * cellSize;
	MovingSphere sphere = own;
	double inwards = flat;
	for ( int round = 0; round < kPatchRounds; ++round )
	{
		sphere.centre = own.centre - inwards * patch.normal;
		if ( !nearest( sphere, touch ) )
		{
			return PatchAnswer::UseSphere;
		}
		const double cosine = -patch.normal.dot( touch.normal );
		if ( touch.distance < inwards + patch.height - kPatchDepth * cellSize )
		{
			inwards *= kPatchRetreat; // its centre may be on the other side of a thin body
			continue;
		}
		if ( cosine < kLeastContactCosine )
		{
			return PatchAnswer::UseSphere;
		}
		const double sine = std::sqrt( std::max( 0.0, 1.0 - cosine * cosine ) );
		if ( sine < kFlatSine && inwards > 0.0 )
		{
			Touch there; // a face that rests on another presses each node on its own line
			if ( nearest( own, there ) && there.normal.dot( touch.normal ) > kSameNormal )
			{
				inwards = 0.0;
				touch = there;
			}
		}
		else if ( round + 1 < kPatchRounds && inwards * sine > most * ( 1.0 + kPatchTolerance ) )
		{
			inwards = most / sine;
			continue;
		}
		const bool touchesNow = touch.distance <= inwards + patch.height + kContactSlop * own.radius;
		if ( !touchesNow && own.isFast() )
		{
			sphere.centre = own.centre - inwards * patch.normal;
			sphere.radius = inwards + patch.height;
			sphere.scale = own.radius;
			if ( !find( sphere, touch ) )
			{
				return PatchAnswer::Clear;
			}
			const double then = -patch.normal.dot( touch.normal );
			const double aside = inwards * std::sqrt( std::max( 0.0, 1.0 - then * then ) );
			if ( then < kLeastContactCosine || aside > most * ( 1.0 + kPatchTolerance ) )
			{
				return PatchAnswer::UseSphere;
			}
		}
		// The plane there is n.( y - q ) = 0. The node is D - ( c - x ).n from it; the sphere's foremost point is R + ( c - x ).n nearer.
		const Vec3d at = -inwards * patch.normal - ( inwards + patch.height ) * touch.normal;
		touch.reach = -at.dot( touch.normal );
		touch.aside = at + touch.reach * touch.normal;
		touch.distance += own.radius - ( inwards + patch.height );
		return own.reaches( touch.normal, touch.distance ) ? PatchAnswer::Touches : PatchAnswer::Clear;
	}
	return PatchAnswer::UseSphere;
}

} // namespace pliant
