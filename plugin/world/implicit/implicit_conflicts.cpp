// What two standing things ask of one node and it cannot do: a plate over a floor, nearer to it than a node is wide, a slot between two
// walls, a corner of one wall that reaches below another. Each asks for a speed of parting, the law's impulses carry on from substep to
// substep, and where none of the speeds is ever reached they grow without end; whoever takes the plate away then gets all of it at once. So
// such contacts ask for what lies between them.

#include "world/constants.h"
#include "world/implicit/implicit_block.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// A contact that lacks more than this, m/s, and comes no nearer to it or further from it by more than this share of that in a substep,
/// gets nowhere. What rests lacks less than a tenth of a millimetre a second, and what strikes changes.
constexpr double kOddsLack = 5e-3, kOddsChange = 1e-2;
/// What it presses with is then taken for what others carry but for this share, substep by substep.
constexpr double kOddsLeft = 0.1;

/// n.w >= least, w the node's speed.
struct Demand
{
	Vec3d normal;
	double least;

	double lack( const Vec3d& w ) const { return least - normal.dot( w ); }
};

Demand demandOf( const BlockContact& contact, int side )
{
	const Vec3d normal = side == 0 ? contact.normal : Vec3d( -contact.normal );
	return Demand{ normal, contact.target + normal.dot( contact.side[1 - side].given ) };
}

/// Cosine to an axis from which on a contact presses along it: of any direction one axis has more.
constexpr double kAlong = 0.5;

/// Whether things whose speeds are given press on the block from two sides.
bool isPressedBetween( const std::vector<BlockContact>& contacts )
{
	Vec3d low = Vec3d::Zero(), high = Vec3d::Zero();
	for ( const BlockContact& contact : contacts )
	{
		for ( int k = 0; k < 2; ++k )
		{
			const ContactSide& other = contact.side[1 - k];
			if ( contact.presses && other.soft < 0 && other.rigid < 0 )
			{
				const Vec3d normal = k == 0 ? contact.normal : Vec3d( -contact.normal );
				low = low.cwiseMin( normal );
				high = high.cwiseMax( normal );
			}
		}
	}
	return ( low.array() < -kAlong && high.array() > kAlong ).any();
}

} // namespace

void ImplicitBlock::agreeOnTargets()
{
	m_between.clear();
	for ( std::size_t c = 0; c < contacts.size(); ++c )
	{
		for ( int k = 0; k < 2; ++k )
		{
			const ContactSide &own = contacts[c].side[k], &other = contacts[c].side[1 - k];
			if ( own.soft >= 0 && other.soft < 0 && other.rigid < 0 )
			{
				m_between.push_back( Between{ own.block[0], c, k } );
			}
		}
	}
	std::stable_sort( m_between.begin(), m_between.end(), []( const Between& a, const Between& b ) { return a.node < b.node; } );
	for ( std::size_t first = 0, end = 0; first < m_between.size(); first = end )
	{
		for ( end = first; end < m_between.size() && m_between[end].node == m_between[first].node; ++end )
		{}
		if ( end - first > 1 )
		{
			agreeOnTargets( first, end );
		}
	}
}

// Where some speed does what all ask for, and is not much larger than what they ask for, there is no conflict. Else the one that lacks
// least in squares, among those near the speed of what stands around: of two walls that all but face each other the way out between them
// would be arbitrarily fast.
void ImplicitBlock::agreeOnTargets( std::size_t first, std::size_t end )
{
	const auto demand = [this]( std::size_t k ) { return demandOf( contacts[m_between[k].contact], m_between[k].side ); };
	Vec3d around = Vec3d::Zero();
	for ( std::size_t k = first; k < end; ++k )
	{
		around += contacts[m_between[k].contact].side[1 - m_between[k].side].given / double( end - first );
	}
	double most = 0.0;
	for ( std::size_t k = first; k < end; ++k )
	{
		most = std::max( most, demand( k ).lack( around ) );
	}
	const auto lacks = [&]( const Vec3d& w, std::size_t k ) { return demand( k ).lack( w ) > kAgreedFraction * most; };
	Vec3d way = around;
	bool isShort = true;
	for ( int sweep = 0; sweep < kAgreeSweeps && isShort; ++sweep )
	{
		isShort = false;
		for ( std::size_t k = first; k < end; ++k )
		{
			if ( lacks( way, k ) )
			{
				const Demand asked = demand( k );
				way += asked.lack( way ) * asked.normal;
				isShort = true;
			}
		}
	}
	if ( !isShort && ( way - around ).norm() <= kLargestExitDistance * most )
	{
		return;
	}
	way = around;
	for ( int round = 0; round < kAgreeSweeps; ++round )
	{
		Eigen::Matrix3d sum = kAgreeRest * Eigen::Matrix3d::Identity();
		Vec3d right = Vec3d::Zero();
		for ( std::size_t k = first; k < end; ++k )
		{
			if ( const Demand asked = demand( k ); asked.lack( way ) > 0.0 )
			{
				sum += asked.normal * asked.normal.transpose();
				right += asked.lack( around ) * asked.normal;
			}
		}
		const Vec3d next = around + sum.inverse() * right;
		const bool isSame = ( next - way ).norm() <= kAgreedFraction * most;
		way = next;
		if ( isSame )
		{
			break;
		}
	}
	for ( std::size_t k = first; k < end; ++k )
	{
		BlockContact& contact = contacts[m_between[k].contact];
		const double less = std::max( 0.0, demand( k ).lack( way ) );
		contact.target -= less;
		contact.parting = std::min( contact.parting, contact.target );
	}
}

// Where others stand between two things from whose two sides the block is pressed, a box, the nodes of another body, no node knows. But who
// is pressed between them and can go nowhere stands, and lacks what it is asked for in each substep: then no more of it is carried on. What
// is held up by what it presses is pressed further, moves, and so is carried again.
void ImplicitBlock::carryImpulses()
{
	const bool isBetween = isPressedBetween( contacts );
	for ( BlockContact& contact : contacts )
	{
		contact.carried = contact.normalImpulse;
		const double along = contact.normal.dot( relativeSpeed( contact, m_v.data() ) ), lack = contact.target - along;
		const double change = std::abs( along - contact.normal.dot( contact.before ) );
		if ( isBetween && contact.presses && lack > kOddsLack && change < kOddsChange * lack )
		{
			contact.carried = std::max( 0.0, ( 1.0 - kOddsLeft ) * ( contact.normalImpulse - contact.stiffness * lack ) );
		}
	}
}

} // namespace pliant
