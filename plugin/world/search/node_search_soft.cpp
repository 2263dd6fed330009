// Search for contacts between two soft bodies, by the rows of both.

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/search/node_search.h"
#include "world/touch/round_surface.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

std::vector<SeparatedPair>::iterator findFresh( std::vector<SeparatedPair>& fresh, unsigned other )
{
	const auto found = std::lower_bound( fresh.begin(), fresh.end(), SeparatedPair{ other, 0.0 } );
	return found != fresh.end() && found->other == other ? found : fresh.end();
}

/// Allowed overlap of the spheres of two bodies that came from one; 0 for all others.
double slackOf( const SoftBody::Impl& a, const SoftBody::Impl& b )
{
	const auto pair = findFresh( a.separatedPairs, b.serial );
	return pair == a.separatedPairs.end() ? 0.0 : pair->slack;
}

void setSlack( const SoftBody::Impl& of, unsigned other, double slack )
{
	const auto pair = findFresh( of.separatedPairs, other );
	if ( pair != of.separatedPairs.end() )
	{
		pair->slack = slack;
		if ( slack == 0.0 )
		{
			of.separatedPairs.erase( pair ); // they have separated
		}
	}
}

/// Limits the overlap to its present value while the bodies separate.
void shrinkSlack( const SoftBody::Impl& a, const SoftBody::Impl& b, double slack, double deepest )
{
	if ( slack > 0.0 )
	{
		setSlack( a, b.serial, std::min( slack, deepest ) );
		setSlack( b, a.serial, std::min( slack, deepest ) );
	}
}

/// Whether two spheres are farther apart than their reaches, the contact margin and their relative displacement, m. Candidate pairs come
/// from the sweeps of the bodies' fastest nodes, so that most of them are rejected here at less cost than by a contact test. `margin`: how
/// much farther than the nodes' own spheres the contact spheres may reach.
bool staysApart( const SphereRows::NearSpheres& pair, const Vec3& displacement, float margin )
{
	const float farthest = pair.reach + margin + displacement.norm();
	return pair.squaredDistance > farthest * farthest;
}

/// Keeps the pairs that may touch.
void dropSeparate(
	std::vector<SphereRows::NearSpheres>& pairs, const NodeState& nodesA, const NodeState& nodesB, double step, float margin )
{
	std::size_t kept = 0;
	for ( const SphereRows::NearSpheres& pair : pairs )
	{
		pairs[kept] = pair;
		const Vec3 displacement = float( step ) * ( nodesA.v.get( pair.nodeA ) - nodesB.v.get( pair.nodeB ) );
		kept += staysApart( pair, displacement, margin ) ? 0 : 1;
	}
	pairs.resize( kept );
}

/// Finds the pairs of nodes that may touch within the step.
void findPairs( const SoftBody::Impl& a, const SoftBody::Impl& b, double step, btScalar margin, SphereRows::Pairs& pairs )
{
	const NodeState &nodesA = a.body->nodes(), &nodesB = b.body->nodes();
	const btVector3 apart = toBt( nodesA.origin - nodesB.origin + ( a.shapeShift - b.shapeShift ).cast<double>() );
	const btVector3 around( margin, margin, margin );
	const float farther = float( around.length() ); // as findPairs computes it: stretched cells have more margin
	const btVector3 low = a.shape->sweepLow() - b.shape->sweepHigh() - around, high = a.shape->sweepHigh() - b.shape->sweepLow() + around;
	SphereRows::findPairs( a.shape->rows(), b.shape->rows(), SphereRows::Approach{ apart, low, high }, pairs );
	dropSeparate( pairs.found, nodesA, nodesB, step, farther );
}

/// A node of the second body: position in the first body's coordinates, m, and radius of its own sphere.
struct Ball
{
	Vec3d at;
	double radius;
	int node;
};

/// Contacts of two bodies' patches with each other, and of a patch with a node's own sphere.
class PatchPairs
{
public:
	PatchPairs( const SoftBody& a, const SoftBody& b ) :
		m_a( a.impl() ), m_b( b.impl() ), m_hasLevels( m_a.body->levels() || m_b.body->levels() )
	{}
	/// Largest gap between the own spheres of two nodes whose patches touch, m.
	btScalar margin() const
	{
		const ContactSurface &one = m_a.surfaceNow(), &other = m_b.surfaceNow();
		const double large = std::max( one.largestSize(), other.largestSize() );
		return btScalar( marginOf( large, std::min( one.cellSize(), other.cellSize() ) ) + one.overhang() + other.overhang() );
	}

	PatchAnswer find( const MovingSphere& sphere, int nodeA, const Ball& ball, Touch& touch ) const
	{
		ContactSurface::Patch one, other;
		const Vec3d apart = ball.at - sphere.centre;
		const double sizes[2] = { m_a.surfaceNow().sizeOf( nodeA ), m_b.surfaceNow().sizeOf( ball.node ) };
		const double most = sphere.radius + ball.radius + marginOf( sizes[0], sizes[1] ) + m_a.overhang() + m_b.overhang();
		if ( m_hasLevels && apart.norm() - sphere.displacement.norm() > most )
		{
			return PatchAnswer::Clear; // the margin of the body's largest nodes is wider
		}
		bool hasOne = patchOf( m_a, nodeA, apart, one ), hasOther = patchOf( m_b, ball.node, -apart, other );
		const bool oneIsPatch = hasOne, otherIsPatch = hasOther;
		// Nodes at edges: the face towards the other's surface, or else the one towards its node.
		hasOne = hasOne || edgeFaceOf( m_a, nodeA, otherIsPatch ? towardsPlane( other, -apart ) : Vec3d( 0.5 * apart ), one );
		hasOther = hasOther || edgeFaceOf( m_b, ball.node, oneIsPatch ? towardsPlane( one, apart ) : Vec3d( -0.5 * apart ), other );
		if ( hasOne && hasOther )
		{
			// A large node is as near to the second layer of small ones, whose faces are at the side.
			const bool mayMeet = std::min( sizes[0], sizes[1] ) > kAlikeSizes * std::max( sizes[0], sizes[1] ) ||
				-one.normal.dot( other.normal ) > kLeastContactCosine;
			return mayMeet ? findBoth( one, other, sizes, sphere, ball, touch ) : PatchAnswer::UseSphere;
		}
		if ( hasOne )
		{
			return findOn( m_a, nodeA, one, sphere, ball.at, ball.radius, touch );
		}
		if ( !hasOther )
		{
			return PatchAnswer::UseSphere;
		}
		// Reversed: the first node's sphere against the second node's patch.
		MovingSphere second;
		second.centre = ball.at;
		second.displacement = -sphere.displacement;
		second.radius = ball.radius;
		second.shape = sphere.shape;
		const PatchAnswer answer = findOn( m_b, ball.node, other, second, sphere.centre, sphere.radius, touch );
		if ( answer == PatchAnswer::Touches )
		{
			touch = fromSecond( touch, second, sphere );
		}
		return answer;
	}

private:
	/// The same for two nodes of these sizes, m. Where one touches the corner of the other's face, their centres are sqrt( c^2 / 2 + R^2 )
	/// apart, c the larger size and R the sum of their radii.
	static double marginOf( double one, double other )
	{
		const double large = std::max( one, other ), radii = 0.5 * ( one + other );
		return std::sqrt( 0.5 * large * large + radii * radii ) - radii + kPatchPairMargin * large;
	}
	static bool patchOf( const SoftBody::Impl& body, int node, const Vec3d& towards, ContactSurface::Patch& patch )
	{
		return body.surfaceNow().patchOf( body.body->nodes(), node, 0.5 * towards, false, patch );
	}
	/// The face in front of a node at an edge. `at`: of the other body, from the node's centre, m.
	static bool edgeFaceOf( const SoftBody::Impl& body, int node, const Vec3d& at, ContactSurface::Patch& face )
	{
		return body.surfaceNow().patchOf( body.body->nodes(), node, at, true, face );
	}
	/// The point of a patch's plane nearest to another node, from that node. `there`: the other node, from the patch's own, m.
	static Vec3d towardsPlane( const ContactSurface::Patch& patch, const Vec3d& there )
	{
		return ( patch.height - patch.normal.dot( there ) ) * patch.normal;
	}
	/// Tests a patch against a sphere around `at`.
	static PatchAnswer findOn( const SoftBody::Impl& body, int node, const ContactSurface::Patch& patch, const MovingSphere& own,
		const Vec3d& at, double radius, Touch& touch )
	{
		return findPatchTouch(
			patch, body.surfaceNow().sizeOf( node ), PatchObstacle{ .isSmall = true, .isRound = true }, own,
			[&]( const MovingSphere& now, Touch& found ) { return findNearest( radius, at, now, found ); },
			[&]( const MovingSphere& now, Touch& found ) { return findBallTouch( radius, at, now, found ); }, touch );
	}
	/// Converts a touch of the second body to one of the first, at the point midway between the two surfaces.
	static Touch fromSecond( const Touch& touch, const MovingSphere& second, const MovingSphere& first )
	{
		const double gap = touch.distance - second.radius;
		const Vec3d at = second.centre + touch.otherPoint( second.radius ) - first.centre;
		Touch back;
		back.normal = -touch.normal;
		back.distance = gap + first.radius;
		back.reach = -at.dot( back.normal );
		back.aside = at + back.reach * back.normal;
		return back;
	}
	/// Whether a patch's sphere touches within the half width of the patch; makes it smaller if not, as findPatchTouch does. `inwards`: of
	/// its centre behind the node, m; `cosine`: of the angle between the normals of patch and contact; `size`: of the node, m.
	static bool comesNear( double& inwards, double cosine, double size )
	{
		const double sine = std::sqrt( std::max( 0.0, 1.0 - cosine * cosine ) ), most = kPatchHalfWidth * size;
		const bool isNear = inwards * sine <= most * ( 1.0 + kPatchTolerance );
		inwards = isNear ? inwards : most / sine;
		return isNear;
	}
	/// Tests two patches. Only nodes that face each other are paired: no point of a grid is farther than .71 of its step from the nearest
	/// grid point. Flat faces meet along the mean of their normals, each node on its own line; as the large spheres that represent them
	/// they would roll on each other. `sizes`: of the nodes, m.
	static PatchAnswer findBoth( const ContactSurface::Patch& one, const ContactSurface::Patch& other, const double ( &sizes )[2],
		const MovingSphere& sphere, const Ball& ball, Touch& touch )
	{
		const double cell = std::max( sizes[0], sizes[1] );
		const bool isFlat = one.isFlat( cell ), isOtherFlat = other.isFlat( cell );
		double inwards = isFlat ? 0.0 : one.radius - one.height, otherInwards = isOtherFlat ? 0.0 : other.radius - other.height;
		bool isNear = false;
		for ( int round = 0; round < kPatchRounds && !isNear; ++round )
		{
			const Vec3d centre = sphere.centre - inwards * one.normal, otherCentre = ball.at - otherInwards * other.normal;
			const Vec3d apart = isFlat && isOtherFlat ? Vec3d( other.normal - one.normal )
				: isFlat                              ? Vec3d( -one.normal )
				: isOtherFlat                         ? other.normal
													  : Vec3d( centre - otherCentre );
			const double length = apart.norm();
			if ( !( length > 0.0 ) )
			{
				return PatchAnswer::UseSphere;
			}
			touch.normal = apart / length;
			const double cosine = -touch.normal.dot( one.normal ), otherCosine = touch.normal.dot( other.normal );
			if ( cosine < kLeastContactCosine || otherCosine < kLeastContactCosine )
			{
				return PatchAnswer::UseSphere;
			}
			const bool isOneNear = comesNear( inwards, cosine, sizes[0] ), isOtherNear = comesNear( otherInwards, otherCosine, sizes[1] );
			isNear = isOneNear && isOtherNear;
		}
		const Vec3d at = -inwards * one.normal - ( inwards + one.height ) * touch.normal,
					otherAt = -otherInwards * other.normal + ( otherInwards + other.height ) * touch.normal;
		const Vec3d between = ( sphere.centre + at ) - ( ball.at + otherAt );
		const double gap = between.dot( touch.normal );
		const Vec3d aside = at - at.dot( touch.normal ) * touch.normal;
		const Vec3d lines = sphere.centre - ball.at;
		if ( gap < -std::max( one.depth, other.depth ) )
		{
			return PatchAnswer::UseSphere;
		}
		if ( ( lines - lines.dot( touch.normal ) * touch.normal ).norm() > kPatchPairDistance * cell )
		{
			return PatchAnswer::Clear;
		}
		// Between the points where each would touch by itself, nearer to the smaller node's; a flat patch touches where the other does.
		const Vec3d apartThere = between - gap * touch.normal;
		const double fraction = sizes[0] * sizes[0] / ( sizes[0] * sizes[0] + sizes[1] * sizes[1] );
		touch.reach = -at.dot( touch.normal );
		touch.aside = isFlat == isOtherFlat ? Vec3d( aside - fraction * apartThere ) : isFlat ? Vec3d( aside - apartThere ) : aside;
		touch.distance = gap + sphere.radius;
		if ( touch.distance <= sphere.radius * ( 1.0 + kContactSlop ) || !sphere.isFast() )
		{
			return sphere.reaches( touch.normal, touch.distance ) ? PatchAnswer::Touches : PatchAnswer::Clear;
		}
		return PatchAnswer::UseSphere;
	}

	const SoftBody::Impl &m_a, &m_b;
	bool m_hasLevels;
};

/// Replaces both nodes' spheres by the round spheres of their faces.
void makeRound( const SoftBody& a, int nodeA, MovingSphere& sphere, const SoftBody& b, int nodeB, Vec3d& at, double& radius )
{
	const RoundSphere one = roundSphere( a, nodeA, at - sphere.centre ), other = roundSphere( b, nodeB, sphere.centre - at );
	sphere.centre += one.inwards;
	sphere.radius += one.inwards.norm();
	at += other.inwards;
	radius += other.inwards.norm();
}

} // namespace

std::vector<NodeHit>& NodeSearch::againstSoft( const SoftBody& a, const SoftBody& b, double step )
{
	const SoftBody::Impl &implA = a.impl(), &implB = b.impl();
	const NodeShape &shapeA = *implA.shape, &shapeB = *implB.shape;
	const NodeState &nodesA = implA.body->nodes(), &nodesB = implB.body->nodes();
	m_soft = &a;
	m_step = step;
	m_hits.clear();
	const double slack = slackOf( implA, implB );
	const bool isFresh = std::isinf( slack ); // not measured yet
	// Fragments have faces that fit into each other cell by cell.
	const bool hasPatches = slack == 0.0 && ( implA.isMetAsDrawnBy( b ) || implB.isMetAsDrawnBy( a ) );
	const PatchPairs patches( a, b ); // used only where there are patches
	const bool isRound = !hasPatches && slack == 0.0 && useRoundSpheres( a, b );
	double deepest = 0.0;
	const Vec3d fromAToB = nodesA.origin - nodesB.origin; // added to a position in A's coordinates gives one in B's
	const btScalar margin = hasPatches ? patches.margin()
		: isRound                      ? kRoundMargin * ( shapeA.largestRadius() + shapeB.largestRadius() )
									   : btScalar( 0 );
	findPairs( implA, implB, step, margin, m_pairs );
	for ( const SphereRows::NearSpheres& pair : m_pairs.found )
	{
		const int nodeA = pair.nodeA, nodeB = pair.nodeB;
		const Vec3 velocityA = nodesA.v.get( nodeA ), velocityB = nodesB.v.get( nodeB );
		MovingSphere sphere;
		sphere.radius = double( shapeA.sphereOfNode( nodeA )->getRadius() );
		sphere.centre = nodesA.x.get( nodeA ).cast<double>();
		sphere.displacement = step * velocityA.cast<double>() - step * velocityB.cast<double>();
		Vec3d at = nodesB.x.get( nodeB ).cast<double>() - fromAToB;
		double radius = double( shapeB.sphereOfNode( nodeB )->getRadius() );
		const double own = sphere.radius;
		if ( isRound )
		{
			makeRound( a, nodeA, sphere, b, nodeB, at, radius );
		}
		Touch touch;
		const PatchAnswer answer = hasPatches ? patches.find( sphere, nodeA, Ball{ at, radius, nodeB }, touch ) : PatchAnswer::UseSphere;
		if ( answer == PatchAnswer::Touches || ( answer == PatchAnswer::UseSphere && findBallTouch( radius, at, sphere, touch ) ) )
		{
			touch.distance -= sphere.radius - own; // distance of the node's own sphere at the same gap
			sphere.radius = own;
			deepest = std::max( deepest, sphere.radius - touch.distance );
			if ( !isFresh )
			{
				touch.distance += slack;
				if ( slack > 0.0 && touch.distance > sphere.radius )
				{
					continue;
				}
			}
			m_hits.push_back( NodeHit{ std::uint64_t( nodeA ) << 32 | std::uint32_t( nodeB ), touch, -1, nodeB } );
		}
	}
	// In the step after an event pieces may move by cells into each other, as an impact stops some of them: all faces between them touch.
	for ( NodeHit& hit : m_hits )
	{
		hit.touch.distance += isFresh ? deepest : 0.0;
	}
	shrinkSlack( implA, implB, slack, deepest );
	applyAllowances( a, &b );
	sortHits();
	return m_hits;
}

} // namespace pliant
