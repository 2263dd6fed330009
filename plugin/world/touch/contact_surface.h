#pragma once

// A soft body's surface for contacts: in front of most nodes, the sphere that fits the drawn surface there (ContactPatch) replaces the
// node's own sphere; and each point of the surface is shared by the nodes around it. docs/design/contacts.md.

#include "lattice/axis_neighbours.h"
#include "lattice/lattice.h"
#include "world/constants.h"
#include "world/touch/level_faces.h"
#include "world/touch/node_touch.h"
#include "world/touch/shared_nodes.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace pliant {

class Body;
struct NodeState;

class ContactSurface
{
public:
	/// Reads the body's lattice where its nodes' numbers or its links have changed, and its levels. `numbering`, `links`: counts of
	/// changes.
	void follow( const Body& body, unsigned numbering, unsigned links );

	/// The patch of a node in the body's present deformation.
	struct Patch
	{
		Vec3d normal = Vec3d::UnitY(); ///< outwards, unit length, world axes
		double height = 0.0;           ///< from the node along the normal to the surface, m
		double radius = 0.0;           ///< m
		double depth = 0.0;            ///< penetration beyond which it does not apply, m

		bool isFlat( double cellSize ) const { return radius > kFlatRadius * cellSize; }
		/// True for the largest radius, which stands for a plane.
		bool isPlane( double cellSize ) const { return radius > kPlaneRadius * cellSize; }
	};
	/// False where the node has none: at edges, in thin parts, and where the cells around it are crushed. `towards`: from the node's
	/// centre to an object's point near it, m: nodes at edges, in thin parts and of coarse levels have several. `withEdges`: also the
	/// faces at edges, which large objects do not touch.
	bool patchOf( const NodeState& nodes, int node, const Vec3d& towards, bool withEdges, Patch& patch ) const;
	/// True where patchOf depends on `towards`.
	bool hasSeveral( int node, bool withEdges ) const { return m_levels || hasEdgeFace( node, withEdges ); }
	bool hasPatches() const { return m_hasPatches; }
	/// Null for a body without levels.
	const LevelFaces* levels() const { return m_levels.get(); }
	/// Nodes beside each node; where levels differ, the one most nearly along the axis.
	const AxisNeighbours& neighbours() const { return m_levels ? m_levels->neighbours() : m_neighbours; }
	double cellSize() const { return m_cellSize; }                                               ///< of the finest cells, m
	double sizeOf( int node ) const { return m_levels ? m_levels->sizeOf( node ) : m_cellSize; } ///< edge of the node's cells together, m
	double largestSize() const { return m_levels ? m_levels->largestSize() : m_cellSize; }       ///< m
	/// How far the patches are in front of the nodes' spheres at most, m.
	double overhang() const { return m_levels ? m_levels->overhang() : double( m_lattice->overhang ); }

	/// The nodes that share a contact. `at`: from the node's centre to the contact point, m; it is moved to where the nodes can share it,
	/// which changes it only in crumbs, sheets and crushed parts. The weights `press` are for impulses at any point of the line through it
	/// along `normal`, `rub` for impulses at the point.
	SharedNodes sharedNodes( const NodeState& nodes, int node, const Vec3d& normal, Vec3d& at ) const;

	/// Radius of the rolling sphere at a node, m, where the touching point travels along its patch; 0 where the point stays.
	double rollingRadius( const NodeState& nodes, int node, const Vec3d& outwards ) const;

private:
	const std::vector<ContactPatch>& patches() const { return m_patch.empty() ? m_lattice->patch : m_patch; }
	struct Axes;
	/// Steps between the neighbours on both sides of a node along each axis, as columns, at rest and now, m.
	struct Steps
	{
		Eigen::Matrix3d before, now, cofactors; ///< cofactors of `now`
	};
	bool stepsAt( const NodeState& nodes, int node, Steps& steps ) const;
	bool cellPatchOf( const ContactPatch& rest, const Steps& steps, Patch& patch ) const;
	bool hasEdgeFace( int node, bool withEdges ) const
	{
		const auto cell = std::size_t( node );
		return withEdges ? !m_lattice->edgeFace.empty() && m_lattice->edgeFaceStart[cell] < m_lattice->edgeFaceStart[cell + 1]
						 : !m_isThin.empty() && m_isThin[cell] != 0;
	}
	void findThinCells();
	bool edgeFaceOf( const NodeState& nodes, int node, const Vec3d& towards, bool withEdges, Patch& patch ) const;
	bool patchOfFace( const LevelFaces::Face& face, const Steps& steps, Patch& patch ) const;
	const Vec3& restCentre( int node ) const
	{
		return m_levels ? m_levels->restCentre( node ) : m_lattice->restCentre[std::size_t( node )];
	}
	void followCracks();
	bool axesOf( const NodeState& nodes, int node, const Vec3d& along, Axes& axes ) const;

	const Lattice* m_lattice = nullptr;
	unsigned m_numbering = 0, m_linkVersion = 0;
	std::size_t m_links = 0;
	AxisNeighbours m_neighbours; ///< of cells
	std::unique_ptr<LevelFaces> m_levels;
	std::vector<ContactPatch> m_patch;  ///< by cell; empty: the lattice's
	std::vector<std::uint8_t> m_isThin; ///< by cell: two of its faces are on opposite sides; empty: none is
	bool m_hasPatches = false;
	double m_cellSize = 0.0;
};

/// Result of testing a patch against an obstacle.
enum class PatchAnswer : int
{
	UseSphere, ///< the patch does not face the obstacle; the node's own sphere is to be tested
	Clear,     ///< no touch
	Touches
};

/// Moves a touch of the sphere whose centre is `inwards`, m, behind the node to the plane that the patch stands for. `rounding`: radius of
/// an obstacle that is a small capsule, m.
inline void touchPlane( const ContactSurface::Patch& patch, double inwards, double rounding, const MovingSphere& own, Touch& touch )
{
	// q - x = ( c - x ) - D n - r ( n + N ):   the gap is N.( q - x ) - h, N the patch's normal, r the radius of a capsule.
	const Vec3d onObstacle = -inwards * patch.normal - touch.distance * touch.normal - rounding * ( touch.normal + patch.normal );
	touch.normal = -patch.normal;
	touch.distance = patch.normal.dot( onObstacle ) + own.radius - patch.height;
	touch.reach = patch.height;
	touch.aside = onObstacle - patch.normal.dot( onObstacle ) * patch.normal;
}

/// Finds where a patch that does not touch yet touches within the step. `inwards`: of its sphere's centre behind the node, m; `most`:
/// largest distance of the point from the node's line, m.
template <class Find>
PatchAnswer sweepPatch(
	const ContactSurface::Patch& patch, double inwards, double most, const MovingSphere& own, const Find& find, Touch& touch )
{
	MovingSphere sphere = own;
	sphere.centre = own.centre - inwards * patch.normal;
	sphere.radius = inwards + patch.height;
	sphere.scale = own.radius;
	if ( !find( sphere, touch ) )
	{
		return PatchAnswer::Clear;
	}
	const double cosine = -patch.normal.dot( touch.normal );
	const double aside = inwards * std::sqrt( std::max( 0.0, 1.0 - cosine * cosine ) );
	return cosine < kLeastContactCosine || aside > most * ( 1.0 + kPatchTolerance ) ? PatchAnswer::UseSphere : PatchAnswer::Touches;
}

/// Tests a patch against an obstacle. `nearest( sphere, touch )`: findNearest for a sphere; `find( sphere, touch )`: findTouch. The
/// distance returned is that of the node's own sphere at the same gap (Touch::distance); Touch::aside and Touch::reach locate the point on
/// the surface.
///
/// The patch is a sphere of radius R with its centre R - h behind the node, h the height of the surface. Where the sine of the angle
/// between contact normal and patch normal is s, it touches at a distance ( R - h ) s from the node's line. Where that exceeds the distance
/// to other nodes' regions, a smaller sphere is used. In front of a plane the sphere only finds a polyhedron's nearest point, which touches
/// the plane itself: its normal does not slant to the side.
template <class Nearest, class Find>
PatchAnswer findPatchTouch( const ContactSurface::Patch& patch, double cellSize, PatchObstacle obstacle, const MovingSphere& own,
	const Nearest& nearest, const Find& find, Touch& touch )
{
	MovingSphere sphere = own;
	const bool isPlane = patch.isPlane( cellSize ), isSmallSphere = obstacle.isSmall && obstacle.isRound;
	const double depth = obstacle.planeDepth() * cellSize;
	const double most = ( isPlane && !isSmallSphere ? obstacle.planeHalfWidth() : kPatchHalfWidth ) * cellSize;
	double inwards = isPlane && !isSmallSphere ? depth : patch.radius - patch.height;
	for ( int round = 0; round < kPatchRounds; ++round )
	{
		sphere.centre = own.centre - inwards * patch.normal;
		if ( !nearest( sphere, touch ) )
		{
			return PatchAnswer::UseSphere;
		}
		const double cosine = -patch.normal.dot( touch.normal );
		if ( touch.distance < inwards + patch.height - patch.depth )
		{
			inwards = std::min( kPatchRetreat * inwards, kFirstRetreat * cellSize ); // the centre may lie on the other side of a thin body
			continue;
		}
		if ( cosine < kLeastContactCosine )
		{
			return PatchAnswer::UseSphere;
		}
		const double sine = std::sqrt( std::max( 0.0, 1.0 - cosine * cosine ) );
		if ( sine < kFlatSine && inwards > 0.0 )
		{
			Touch there; // a face at rest on another presses each node on its own line
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
		const bool touchesNow = touch.distance <= inwards + patch.height + kContactSlop * own.radius + own.pressedReach;
		if ( !touchesNow && own.isFast() )
		{
			const PatchAnswer swept = sweepPatch( patch, inwards, most, own, find, touch );
			if ( swept != PatchAnswer::Touches )
			{
				return swept;
			}
		}
		if ( isPlane && !obstacle.isRound && inwards == depth )
		{
			touchPlane( patch, depth, obstacle.rounding, own, touch );
			return own.reaches( touch.normal, touch.distance ) ? PatchAnswer::Touches : PatchAnswer::Clear;
		}
		// The plane there is n.( y - q ) = 0. The node is D - ( c - x ).n from it, the sphere's foremost point nearer by R + ( c - x ).n.
		const Vec3d at = -inwards * patch.normal - ( inwards + patch.height ) * touch.normal;
		touch.reach = -at.dot( touch.normal );
		touch.aside = at + touch.reach * touch.normal;
		touch.distance += own.radius - ( inwards + patch.height );
		return own.reaches( touch.normal, touch.distance ) ? PatchAnswer::Touches : PatchAnswer::Clear;
	}
	return PatchAnswer::UseSphere;
}

} // namespace pliant
