// A block whose soft bodies all step explicitly, in the form of ContactSweeps.

#include "world/block/island_block.h"
#include "world/constants.h"

#include <algorithm>

namespace pliant {

namespace {

/// The response of a rigid body to impulses, without its locked axes.
ContactSweeps::Rigid responseOf( const RigidPart& part )
{
	ContactSweeps::Rigid response;
	Eigen::Matrix3d inertia = part.inertia;
	for ( int k = 0; k < 3; ++k )
	{
		response.inverseMass[k] = part.moves[k] ? 1.0 / part.mass : 0.0;
		if ( !part.turns[k] )
		{
			inertia.row( k ).setZero();
			inertia.col( k ).setZero();
			inertia( k, k ) = 1.0;
		}
	}
	response.inverseInertia = inertia.inverse();
	for ( int k = 0; k < 3; ++k )
	{
		response.inverseInertia( k, k ) = part.turns[k] ? response.inverseInertia( k, k ) : 0.0;
	}
	return response;
}

} // namespace

bool IslandBlock::canSweep() const
{
	const auto isElastic = []( const SoftPart& part ) { return part.motion->isElastic(); };
	const auto isSpecial = []( const BlockContact& contact ) { return contact.isAttachment() || contact.frictionScale >= 0; };
	return linked.empty() && std::none_of( soft.begin(), soft.end(), isElastic ) &&
		std::none_of( contacts.begin(), contacts.end(), isSpecial );
}

// The velocities without contacts, and the contacts with their impulses so far.
void IslandBlock::listSwept()
{
	m_sweeps.v.assign( std::size_t( m_size ), 0.0 );
	m_sweeps.rigid.clear();
	m_sweeps.contacts.clear();
	for ( const SoftPart& part : soft )
	{
		const Vec3Array& free = part.motion->nodes().v;
		const AlignedArray<float>* const from[3] = { &free.x, &free.y, &free.z };
		for ( int k = 0; k < 3; ++k )
		{
			std::copy_n( from[k]->begin(), part.motion->nodes().count, m_sweeps.v.begin() + part.offset + k * part.motion->padded() );
		}
	}
	for ( const RigidPart& part : rigid )
	{
		m_sweeps.rigid.push_back( responseOf( part ) );
		Eigen::Map<Vector6>( m_sweeps.v.data() + part.offset ) = part.freeVelocity;
	}
	for ( const BlockContact& contact : contacts )
	{
		ContactSweeps::Contact& own = m_sweeps.contacts.emplace_back();
		for ( int k = 0; k < 2; ++k )
		{
			const ContactSide& side = contact.side[k];
			own.side[k] = flatSide( side );
			own.rigid[k] = side.rigid;
			for ( int j = 0; side.soft >= 0 && j < side.shared.count; ++j )
			{
				own.inverseMass[k][j] = double( m_inverseDiagonal[std::size_t( own.side[k].index[j] )] );
			}
		}
		own.normal = contact.normal;
		own.prescribed = contact.side[0].prescribedVelocity - contact.side[1].prescribedVelocity;
		own.stiffness = contact.stiffness;
		own.multiplier = contact.normalMultiplier;
		own.target = contact.target;
		own.friction = contact.friction;
		own.tangentMultiplier = contact.tangentMultiplier;
		own.normalImpulse = contact.normalImpulse;
		own.tangentImpulse = contact.tangentImpulse;
	}
}

// The remaining error of the velocities is measured as their energy, as in the iteration of a pass.
bool IslandBlock::sweepContacts( BlockCount& count )
{
	listSwept();
	const auto atSpeed = [this]( double speed ) { return m_softMass * speed * speed; };
	const ContactSweeps::Result result = m_sweeps.solve(
		kImpulseError, atSpeed( kContactGradientSpeed ), atSpeed( kMostContactGradientSpeed ) );
	std::copy_n( m_sweeps.v.begin(), m_size, m_v.begin() );
	for ( std::size_t k = 0; k < contacts.size(); ++k )
	{
		const ContactSweeps::Contact& own = m_sweeps.contacts[k];
		contacts[k].normalImpulse = own.normalImpulse;
		contacts[k].tangentImpulse = own.tangentImpulse;
		contacts[k].isActive = own.normalImpulse > 0.0;
	}
	count.products += result.sweeps;
	return result.isAccurate;
}

} // namespace pliant
