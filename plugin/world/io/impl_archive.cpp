// A soft body's own state as bytes: everything that refers to no other object.

#include "archive/settings_archive.h"
#include "body/levels/levels.h"
#include "lattice/features.h"
#include "world/bodies/soft_body_impl.h"
#include "world/io/body_record.h"

#include <algorithm>
#include <tuple>

namespace pliant {

void archive( Archive& archive, ElasticityState& state )
{
	auto& [isImplicit, calmTime, load, landingTime, blow, checksLoads, needsImplicit, rolling, heaviestLoad, impulse, nodeMass] = state;
	archive( isImplicit, calmTime, load, landingTime, blow, checksLoads, needsImplicit, rolling, heaviestLoad, impulse, nodeMass );
}

void archive( Archive& archive, SeparatedPair& pair )
{
	archive( pair.other, pair.slack );
}

void archive( Archive& archive, Fading& fading )
{
	auto& [time, left, isOver] = fading;
	archive( time, left, isOver );
}

void archive( Archive& archive, RestPositions& rest )
{
	auto& [positions, origin, numbering] = rest;
	archive( positions, origin, numbering );
}

void archive( Archive& archive, SoftBody::Impl::Near& near )
{
	archive( near.node );
	archive.choice( near.request, SoftBody::Impl::Near::Request::SplitLater );
}

void archive( Archive& archive, CutTrace& cut )
{
	archive( cut.link.a, cut.link.b, cut.point, cut.normal );
}

void archive( Archive& archive, GasCavity& cavity )
{
	auto& [cells, amount, pressure, surface] = cavity;
	archive( cells, amount, pressure, surface );
}

/// The boundary and the sums of forces are rebuilt.
void archive( Archive& archive, SurfaceForces& forces )
{
	archive.choice( forces.gas.law, GasLaw::Ideal );
	archive( forces.gas.pressure, forces.gas.outside, forces.cavities, forces.cavityVersion );
	if ( archive.isReading() )
	{
		forces.boundary = BodyBoundary{};
	}
}

void SoftBody::Impl::archiveMake( Archive& archive )
{
	if ( archive.isReading() )
	{
		body = Body::blank();
	}
	body->archiveMake( archive, Body::Shared{ bodyTemplate->sharedLattice(), bodyTemplate->cache() } );
	bool collidesWithItself = self != nullptr;
	archive( collidesWithItself );
	if ( archive.isReading() && archive.isSound() )
	{
		archive.require( !collidesWithItself || hasFeature( Feature::SelfCollision ), "This build of the library has no self-collision." );
		self = collidesWithItself ? std::make_unique<SelfCollision>() : nullptr;
		shape = std::make_unique<NodeShape>( *body );
	}
	if ( archive.isSound() )
	{
		shape->archive( archive, *body );
	}
	bool hasPose = follower != nullptr;
	archive( hasPose );
	if ( archive.isReading() )
	{
		follower = hasPose ? std::make_unique<PoseFollower>() : nullptr;
	}
	if ( hasPose && archive.isSound() )
	{
		follower->archiveMake( archive, std::size_t( bodyTemplate->cellCount() ) );
	}
}

// Not stored: temporary data of a substep, data read again from Bullet's object or from the lattice, and data for drawing only.
void SoftBody::Impl::archiveState( Archive& archive )
{
	body->archiveState( archive );
	const int count = body->nodeCount();
	std::vector<Near> near = nearNodes; // found in the order of the spheres' rows, and used in none
	std::sort( near.begin(), near.end(),
		[]( const Near& a, const Near& b ) { return std::tie( a.node, a.request ) < std::tie( b.node, b.request ); } );
	archive( shapeShift, mass, meanSquareSpeed, slowTime, restTime, isBroken, plan, elasticity, isImplicit, lastSubstep, isGuarded,
		isHealthy, stateBefore, hasOwnGravity, gravity, centralForce, hasNodeForces, heldBefore, fractureVersion, separatedPairs, fading,
		newCuts, partingPhases, placements, numbering, near, nodeAxes, rest, skin.tolerance );
	archive( mustDeform, rigidWait, rigidPause, separatedAt, isKept, asleepTime, isScenery, partsWait, fieldAcceleration, scale );
	archive.owned( forces, [] { return std::make_unique<SurfaceForces>(); } );
	bool tellsContacts = contactRecords != nullptr, isInterpolated = skin.blend != nullptr;
	archive( tellsContacts, isInterpolated );
	archive( rigidLoad.impulse, rigidLoad.now, rigidLoad.mean, rigidLoad.first, rigidLoad.acceleration );
	allowance.archive( archive, count );
	if ( follower )
	{
		follower->archiveState( archive );
	}
	if ( self )
	{
		self->search.archive( archive );
	}
	btVector3 sweepLow = shape->sweepLow(), sweepHigh = shape->sweepHigh();
	archive( sweepLow, sweepHigh );
	if ( !archive.isReading() )
	{
		return;
	}
	contactRecords = tellsContacts ? std::make_unique<ContactRecords>() : nullptr; // its events start again
	skin.interpolate( isInterpolated );
	nearNodes = std::move( near );
	const auto isNode = [count]( const Near& each ) { return each.node >= 0 && each.node < count; };
	archive.require( std::isfinite( mass ) && mass > 0.0 && shapeShift.cwiseAbs().maxCoeff() <= kFarthestStored &&
			std::isfinite( meanSquareSpeed ) && std::isfinite( lastSubstep ) && std::isfinite( skin.tolerance ) &&
			sweepLow.length() <= kFarthestStored && sweepHigh.length() <= kFarthestStored &&
			( heldBefore.empty() || heldBefore.size() == std::size_t( count ) ) &&
			( nodeAxes.empty() || nodeAxes.size() == 4 * std::size_t( count ) ) &&
			std::all_of( nearNodes.begin(), nearNodes.end(), isNode ) && std::is_sorted( separatedPairs.begin(), separatedPairs.end() ),
		"The state of a body is not valid." );
	if ( archive.isSound() )
	{
		shape->place( body->nodes(), shapeShift );
		shape->setSweep( sweepLow, sweepHigh );
		skin.nodesMoved();
		++skin.moves;
	}
}

namespace {

/// The shift with which a version shown as `shown` is shown as a later one, for any present version.
int shiftPast( unsigned shown, unsigned now )
{
	return int( shown + 1 - now );
}

} // namespace

void SoftBody::Impl::install( SoftBody& owner, std::unique_ptr<Impl> impl )
{
	if ( owner.m_impl )
	{
		const unsigned fracture = owner.fractureVersion(), levels = owner.levelVersion();
		const double tolerance = impl->skin.tolerance;
		const bool isInterpolated = impl->skin.blend != nullptr;
		Impl& before = *owner.m_impl;
		const Levels* const now = impl->body->levels();
		const int shift = std::max( shiftPast( fracture, impl->fractureVersion ), now ? shiftPast( levels, now->version() ) : 0 );
		impl->versionShift = unsigned( shift );
		impl->wasDrawn = impl->wasDrawn || before.isDrawn();
		impl->skin = std::move( before.skin );
		impl->skin.fade.clear();
		impl->skin.tolerance = tolerance;
		impl->skin.interpolate( isInterpolated );
		impl->skin.nodesChanged();
		impl->surface = before.surface;
		impl->system = before.system;
	}
	owner.m_impl = std::move( impl );
	Impl& now = *owner.m_impl;
	++now.skin.moves; // queries start again from any restored position
	now.proxyOfNode.assign( std::size_t( now.body->nodeCount() ), nullptr );
	owner.m_internalType = kInternalType;
	owner.internalSetExtensionPointer( const_cast<char*>( &kSoftBodyMark ) );
	now.queried = std::make_unique<BodyShape>( owner );
	owner.setCollisionShape( now.queried.get() );
}

} // namespace pliant
