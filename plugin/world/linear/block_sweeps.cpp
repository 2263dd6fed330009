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
	m_sweeps.clear();
	for ( const SoftPart& part : soft )
	{
		m_sweeps.firstNode.push_back( int( m_sweeps.v.size() ) );
		const NodeState& nodes = part.motion->nodes();
		for ( int i = 0; i < nodes.count; ++i )
		{
			m_sweeps.v.push_back( ContactSweeps::padded( nodes.v.get( i ).cast<double>() ) );
		}
	}
	for ( const RigidPart& part : rigid )
	{
		m_sweeps.rigid.push_back( responseOf( part ) );
		m_sweeps.rigid.back().at = int( m_sweeps.v.size() );
		m_sweeps.v.push_back( ContactSweeps::padded( part.freeVelocity.head<3>() ) );
		m_sweeps.v.push_back( ContactSweeps::padded( part.freeVelocity.tail<3>() ) );
	}
	for ( const BlockContact& contact : contacts )
	{
		ContactSweeps::Contact& own = m_sweeps.contacts.emplace_back();
		for ( int k = 0; k < 2; ++k )
		{
			own.side[k] = sweptSide( contact.side[k] );
		}
		own.normal = ContactSweeps::padded( contact.normal );
		own.prescribed = ContactSweeps::padded( contact.side[0].prescribedVelocity - contact.side[1].prescribedVelocity );
		own.stiffness = contact.stiffness;
		own.multiplier = contact.normalMultiplier;
		own.target = contact.target;
		own.friction = contact.friction;
		own.tangentMultiplier = ContactSweeps::padded( contact.tangentMultiplier );
		own.normalImpulse = contact.normalImpulse;
		own.tangentImpulse = ContactSweeps::padded( contact.tangentImpulse );
	}
}

ContactSweeps::Side IslandBlock::sweptSide( const ContactSide& side )
{
	ContactSweeps::Side own;
	if ( side.rigid >= 0 )
	{
		own.rigid = m_sweeps.addArm( m_sweeps.rigid[std::size_t( side.rigid )], side.arm );
	}
	else if ( side.soft >= 0 )
	{
		own.count = side.shared.count;
		for ( int j = 0; j < own.count; ++j )
		{
			const int node = side.shared.node[j];
			own.at[j] = m_sweeps.firstNode[std::size_t( side.soft )] + node;
			own.rub[j] = side.shared.rub[j];
			own.excess[j] = side.shared.press[j] - side.shared.rub[j];
			own.inverseMass[j] = double( m_inverseDiagonal[std::size_t( soft[std::size_t( side.soft )].offset + node )] );
		}
	}
	return own;
}

// To m_v: by components for nodes, six to a rigid body.
void IslandBlock::readSwept()
{
	for ( std::size_t p = 0; p < soft.size(); ++p )
	{
		const int padded = soft[p].motion->padded();
		float* const to = m_v.data() + soft[p].offset;
		std::fill_n( to, soft[p].motion->size(), 0.0f );
		for ( int i = 0; i < soft[p].motion->nodes().count; ++i )
		{
			const ContactSweeps::Vec& v = m_sweeps.v[std::size_t( m_sweeps.firstNode[p] + i )];
			for ( int k = 0; k < 3; ++k )
			{
				to[k * padded + i] = float( v[k] );
			}
		}
	}
	for ( std::size_t p = 0; p < rigid.size(); ++p )
	{
		const ContactSweeps::Vec* const v = m_sweeps.v.data() + m_sweeps.rigid[p].at;
		Eigen::Map<Eigen::Matrix<float, 6, 1>> to( m_v.data() + rigid[p].offset );
		to << v[0].head<3>().cast<float>(), v[1].head<3>().cast<float>();
	}
}

// The remaining error of the velocities is measured as their energy, as in the iteration of a pass.
bool IslandBlock::sweepContacts( BlockCount& count )
{
	listSwept();
	const auto atSpeed = [this]( double speed ) { return m_softMass * speed * speed; };
	const ContactSweeps::Result result = m_sweeps.solve(
		kImpulseError, atSpeed( kContactGradientSpeed ), atSpeed( kMostContactGradientSpeed ) );
	readSwept();
	for ( std::size_t k = 0; k < contacts.size(); ++k )
	{
		const ContactSweeps::Contact& own = m_sweeps.contacts[k];
		contacts[k].normalImpulse = own.normalImpulse;
		contacts[k].tangentImpulse = own.tangentImpulse.head<3>();
		contacts[k].isActive = own.normalImpulse > 0.0;
	}
	count.products += result.sweeps;
	return result.isAccurate;
}

} // namespace pliant
