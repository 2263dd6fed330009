// Restores the momentum that the truncated iteration loses.

#include "body/implicit/touched_nodes.h"
#include "world/block/island_block.h"
#include "world/bodies/soft_body_impl.h"

#include "lattice/union_find.h"

#include <algorithm>

namespace pliant {

namespace {

/// Returns the mass matrix of rigid motions about `centre` of a body with `mass` and `inertia` at `at`.
Matrix6 massAbout( const Vec3d& centre, double mass, const Eigen::Matrix3d& inertia, const Vec3d& at )
{
	const Vec3d arm = at - centre;
	Matrix6 whole = Matrix6::Zero();
	whole.topLeftCorner<3, 3>() = mass * Eigen::Matrix3d::Identity();
	whole.bottomRightCorner<3, 3>() = inertia + mass * ( arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose() );
	return whole;
}

/// Returns a momentum and angular momentum about `at` as seen about `centre`.
Vector6 movedTo( const Vec3d& centre, const Vector6& sums, const Vec3d& at )
{
	Vector6 moved = sums;
	moved.tail<3>() += ( at - centre ).cross( sums.head<3>() );
	return moved;
}

/// Returns the rigid motion about `centre` expressed at `at`.
Vector6 seenFrom( const Vec3d& at, const Vector6& motion, const Vec3d& centre )
{
	Vector6 seen = motion;
	seen.head<3>() += motion.tail<3>().cross( at - centre );
	return seen;
}

/// Adds a rigid motion to the nodes of a part so that their momentum changes by it: the rounding error of one node is passed to the next.
/// Added to each node separately, a motion of less than half of a velocity's last digit would be lost in every substep.
void addToTheLastDigit( ImplicitMotion& motion, int part, const Vector6& added )
{
	NodeState& nodes = motion.nodes();
	const Vec3d shift = added.head<3>(), turn = added.tail<3>(), &centre = motion.centre( part );
	Vec3d rest = Vec3d::Zero(); // N s
	motion.parts().forNodes( part, nodes.count, [&]( int i ) {
		if ( nodes.freedom[i] == 0.0f )
		{
			return;
		}
		const double mass = double( nodes.mass[i] );
		const Vec3d change = shift + turn.cross( nodes.x.get( i ).cast<double>() - centre );
		const Vec3d wanted = nodes.v.get( i ).cast<double>() + change + rest / mass;
		nodes.v.set( i, wanted.cast<float>() );
		rest = mass * ( wanted - nodes.v.get( i ).cast<double>() );
	} );
}

} // namespace

// The iteration is truncated and runs in float. The missing momentum of each group of touching bodies without a fixed one is added to the
// whole group as one rigid motion; added to light members alone it would throw them. Connected parts of a soft body are separate bodies.
void IslandBlock::restoreMomentum()
{
	const std::size_t parts = m_connected.size(), count = 1 + parts + rigid.size(); // 0: the fixed group
	UnionFind groups( count );
	const auto indexOf = [&]( const ContactSide& side ) {
		return std::uint32_t( side.soft >= 0 ? 1 + std::size_t( &connectedOf( side ) - m_connected.data() )
				: side.rigid >= 0            ? 1 + parts + std::size_t( side.rigid )
											 : 0 );
	};
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.normalImpulse != 0.0 )
		{
			for ( const ContactSide& side : contact.side )
			{
				side.soft >= 0 ? void( m_connected[std::size_t( &connectedOf( side ) - m_connected.data() )].isPressed = true ) : void();
			}
			groups.join( indexOf( contact.side[0] ), indexOf( contact.side[1] ) );
		}
	}
	for ( std::size_t p = 0; p < parts; ++p )
	{
		// Explicit parts that no contact presses keep their velocities of free flight.
		const SoftPart& part = soft[std::size_t( m_connected[p].soft )];
		if ( part.motion->isHeld( m_connected[p].part ) || ( part.touched && !m_connected[p].isPressed ) )
		{
			groups.join( std::uint32_t( 1 + p ), 0 );
		}
	}
	for ( std::size_t p = 0; p < rigid.size(); ++p )
	{
		if ( rigid[p].hasLockedAxis() )
		{
			groups.join( std::uint32_t( 1 + parts + p ), 0 );
		}
	}
	for ( const LinkedParts& whole : linked )
	{
		for ( const int part : whole.parts )
		{
			groups.join(
				std::uint32_t( 1 + parts + std::size_t( whole.parts.front() ) ), std::uint32_t( 1 + parts + std::size_t( part ) ) );
		}
	}
	listGroups( groups, std::uint32_t( count ) );
	for ( const SoftPart& part : soft )
	{
		part.touched ? part.touched->store() : void();
	}
	for ( std::size_t group = 1; group < count; ++group )
	{
		if ( m_groupStart[group - 1] < m_groupStart[group] )
		{
			restoreMomentumOf( m_groupMembers.data() + m_groupStart[group - 1], m_groupMembers.data() + m_groupStart[group] );
		}
	}
}

/// Lists the groups of `count` bodies in the order of their lowest member, each with its members in ascending order.
void IslandBlock::listGroups( UnionFind& groups, std::uint32_t count )
{
	m_groupStart.assign( std::size_t( count ) + 1, 0 );
	for ( std::uint32_t k = 0; k < count; ++k )
	{
		++m_groupStart[groups.find( k ) + 1];
	}
	for ( std::uint32_t k = 0; k < count; ++k )
	{
		m_groupStart[k + 1] += m_groupStart[k];
	}
	m_groupMembers.resize( count );
	for ( std::uint32_t k = 0; k < count; ++k )
	{
		m_groupMembers[m_groupStart[groups.find( k )]++] = k; // moves each start to the start of the next group
	}
}

/// Returns the body of index `k` as numbered in restoreMomentum.
IslandBlock::MovingBody IslandBlock::movingBodyAt( std::uint32_t k )
{
	MovingBody moving;
	if ( k <= m_connected.size() )
	{
		const ConnectedPart& own = m_connected[k - 1];
		SoftPart& part = soft[std::size_t( own.soft )];
		// Few touched nodes have little inertia, and a friction that acts at the centres of two node spheres has a torque.
		moving.motion = &wholeOf( part );
		moving.part = part.touched ? moving.motion->parts().partOf( part.touched->firstOf( own.part ) ) : own.part;
		moving.centre = moving.motion->nodes().origin + moving.motion->centre( moving.part );
		moving.mass = moving.motion->rigidMass( moving.part );
		moving.missingMomentum = movedTo(
			moving.motion->centre( moving.part ), part.motion->missingMomentum( own.part ), part.motion->centre( own.part ) );
		return moving;
	}
	moving.rigid = &rigid[k - 1 - m_connected.size()];
	const Vector6 missingVelocity = moving.rigid->freeVelocity - moving.rigid->velocity;
	moving.centre = moving.rigid->centre;
	moving.mass( 0, 0 ) = moving.rigid->mass;
	moving.mass.bottomRightCorner<3, 3>() = moving.rigid->inertia;
	moving.missingMomentum << moving.rigid->mass * missingVelocity.head<3>(), moving.rigid->inertia * missingVelocity.tail<3>();
	if ( moving.rigid->linked >= 0 )
	{
		moving.missingMomentum = linkMomentum(
			*moving.rigid, []( const RigidPart& link ) { return Vector6( link.freeVelocity - link.velocity ); } );
	}
	return moving;
}

void IslandBlock::restoreMomentumOf( const std::uint32_t* begin, const std::uint32_t* end )
{
	double mass = 0.0;
	Vec3d centre = Vec3d::Zero();
	m_movingBodies.clear();
	for ( const std::uint32_t* k = begin; k < end; ++k )
	{
		const MovingBody& moving = m_movingBodies.emplace_back( movingBodyAt( *k ) );
		mass += moving.mass( 0, 0 );
		centre += moving.mass( 0, 0 ) * moving.centre;
	}
	centre /= mass;
	if ( std::any_of( m_movingBodies.begin(), m_movingBodies.end(),
			 []( const MovingBody& moving ) { return moving.motion && moving.motion->isHeld( moving.part ); } ) )
	{
		return; // held by a node that nothing touches
	}

	Matrix6 whole = Matrix6::Zero();
	Vector6 missingMomentum = Vector6::Zero();
	for ( const MovingBody& moving : m_movingBodies )
	{
		whole += massAbout( centre, moving.mass( 0, 0 ), moving.mass.bottomRightCorner<3, 3>(), moving.centre );
		missingMomentum += movedTo( centre, moving.missingMomentum, moving.centre );
	}
	const Vector6 motion = whole.inverse() * missingMomentum;
	const bool isAttached = std::any_of(
		contacts.begin(), contacts.end(), []( const BlockContact& contact ) { return contact.isAttachment(); } );
	for ( const MovingBody& moving : m_movingBodies )
	{
		const Vector6 seen = seenFrom( moving.centre, motion, centre );
		if ( moving.motion && isAttached )
		{
			addToTheLastDigit( *moving.motion, moving.part, seen );
		}
		else if ( moving.motion )
		{
			moving.motion->addMotion( seen, moving.part );
		}
		else
		{
			moving.rigid->velocity += seen;
		}
	}
}

} // namespace pliant
