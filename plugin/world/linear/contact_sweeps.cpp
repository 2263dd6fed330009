#include "world/linear/contact_sweeps.h"

#include "world/constants.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// The larger eigenvalue of a symmetric matrix restricted to the plane across the normal.
double largestAcross( const Eigen::Matrix3d& response, const Vec3d& normal )
{
	const Vec3d a = normal.unitOrthogonal(), b = normal.cross( a );
	const double aa = a.dot( response * a ), bb = b.dot( response * b ), ab = a.dot( response * b );
	return 0.5 * ( aa + bb ) + std::hypot( 0.5 * ( aa - bb ), ab );
}

ContactSweeps::Vec times( const ContactSweeps::Matrix& m, const ContactSweeps::Vec& a )
{
	return a[0] * m.col( 0 ) + a[1] * m.col( 1 ) + a[2] * m.col( 2 );
}

} // namespace

void ContactSweeps::clear()
{
	firstNode.clear();
	rigid.clear();
	contacts.clear();
	v.clear();
	m_arms.clear();
}

int ContactSweeps::addArm( const Rigid& body, const Vec3d& r )
{
	Arm& arm = m_arms.emplace_back();
	Eigen::Matrix3d cross; // r x
	cross << 0.0, -r[2], r[1], r[2], 0.0, -r[0], -r[1], r[0], 0.0;
	arm.at = body.at;
	arm.inverseMass = padded( body.inverseMass );
	arm.velocityOfTurn << -cross, Eigen::RowVector3d::Zero();
	arm.turnOfImpulse << body.inverseInertia * cross, Eigen::RowVector3d::Zero();
	return int( m_arms.size() ) - 1;
}

// 1 / M + [r]^T I^-1 [r]
Eigen::Matrix3d ContactSweeps::responseOf( const Arm& arm ) const
{
	return Eigen::Matrix3d( arm.inverseMass.head<3>().asDiagonal() ) + arm.velocityOfTurn.topRows<3>() * arm.turnOfImpulse.topRows<3>();
}

// W = sum p^2 / m along the normal and sum r^2 / m across it for nodes.
void ContactSweeps::measureResponse( Contact& contact ) const
{
	const Vec3d normal = contact.normal.head<3>();
	contact.m_alongResponse = contact.m_acrossResponse = 0.0;
	contact.m_slide.setZero();
	for ( const Side& side : contact.side )
	{
		if ( side.rigid >= 0 )
		{
			const Eigen::Matrix3d response = responseOf( m_arms[std::size_t( side.rigid )] );
			const Vec3d byPress = response * normal;
			const double along = normal.dot( byPress );
			contact.m_alongResponse += along;
			contact.m_acrossResponse += largestAcross( response, normal );
			contact.m_slide.head<3>() += byPress - along * normal;
		}
		for ( int j = 0; j < side.count; ++j )
		{
			const double press = side.rub[j] + side.excess[j];
			contact.m_alongResponse += press * press * side.inverseMass[j];
			contact.m_acrossResponse += side.rub[j] * side.rub[j] * side.inverseMass[j];
		}
	}
	contact.m_pressFactor = 1.0 / ( 1.0 + contact.stiffness * contact.m_alongResponse );
}

// u += sign ( sum r_j v_j + n n.( sum ( p_j - r_j ) v_j ) ) for nodes, sign ( V + W x r ) for a rigid body
void ContactSweeps::addVelocity( const Side& side, const Vec& normal, double sign, Vec& u ) const
{
	if ( side.rigid >= 0 )
	{
		const Arm& arm = m_arms[std::size_t( side.rigid )];
		u += sign * ( v[std::size_t( arm.at )] + times( arm.velocityOfTurn, v[std::size_t( arm.at + 1 )] ) );
		return;
	}
	Vec rubbed = Vec::Zero(), more = Vec::Zero();
	for ( int j = 0; j < side.count; ++j )
	{
		const Vec& own = v[std::size_t( side.at[j] )];
		rubbed += side.rub[j] * own;
		more += side.excess[j] * own;
	}
	u += sign * ( rubbed + normal.dot( more ) * normal );
}

// v += M^-1 J^T j, for one side
void ContactSweeps::push( const Side& side, const Vec& normal, const Vec& impulse )
{
	if ( side.rigid >= 0 )
	{
		const Arm& arm = m_arms[std::size_t( side.rigid )];
		v[std::size_t( arm.at )] += arm.inverseMass.cwiseProduct( impulse );
		v[std::size_t( arm.at + 1 )] += times( arm.turnOfImpulse, impulse );
		return;
	}
	const Vec along = normal.dot( impulse ) * normal;
	for ( int j = 0; j < side.count; ++j )
	{
		v[std::size_t( side.at[j] )] += ( side.inverseMass[j] * side.rub[j] ) * impulse + ( side.inverseMass[j] * side.excess[j] ) * along;
	}
}

void ContactSweeps::apply( const Contact& contact, const Vec& impulse )
{
	push( contact.side[0], contact.normal, impulse );
	push( contact.side[1], contact.normal, -impulse );
}

// Along the normal   jn = max( 0, ln + k ( b - un - W ( jn - jn' ) ) ) = max( 0, ( ln + k ( b - un + W jn' ) ) / ( 1 + k W ) ),
// jn' the impulse before; across it the same with ks and lt, but at most mu jn long. What is added to jn makes rigid bodies slide.
// Returns the energy of the changes, J.
double ContactSweeps::sweep( double relaxation )
{
	double change = 0.0;
	for ( Contact& contact : contacts )
	{
		const Vec normal = contact.normal;
		Vec u = contact.prescribed;
		addVelocity( contact.side[0], normal, 1.0, u );
		addVelocity( contact.side[1], normal, -1.0, u );
		const double k = contact.stiffness, W = contact.m_alongResponse, before = contact.normalImpulse, un = normal.dot( u );
		const double solved = ( contact.multiplier + k * ( contact.target - un + W * before ) ) * contact.m_pressFactor;
		contact.normalImpulse = std::max( 0.0, before + relaxation * ( solved - before ) );
		if ( before == 0.0 && contact.normalImpulse == 0.0 )
		{
			continue;
		}
		const double pushed = contact.normalImpulse - before, limit = contact.friction * contact.normalImpulse;
		const double stick = std::min( k, limit * ( 1.0 / kSlipSpeed ) ), across = contact.m_acrossResponse;
		const Vec slip = u - un * normal + pushed * contact.m_slide;
		const Vec stopped = ( contact.tangentMultiplier - stick * ( slip - across * contact.tangentImpulse ) ) / ( 1.0 + stick * across );
		Vec rubbed = contact.tangentImpulse + relaxation * ( stopped - contact.tangentImpulse );
		const double square = rubbed.squaredNorm();
		if ( square > limit * limit )
		{
			rubbed *= limit / std::sqrt( square );
		}
		const Vec slowed = rubbed - contact.tangentImpulse;
		contact.tangentImpulse = rubbed;
		apply( contact, pushed * normal + slowed );
		change += pushed * pushed * W * ( 1.0 + k * W ) + slowed.squaredNorm() * across * ( 1.0 + stick * across );
	}
	return change;
}

double ContactSweeps::storedEnergy() const
{
	double stored = 0.0;
	for ( const Contact& contact : contacts )
	{
		stored += contact.normalImpulse * contact.normalImpulse / contact.stiffness;
	}
	return stored;
}

// Sweeps converge linearly: after changes of the ratio q those still to come sum to q / ( 1 - q ) times the last, and n more sweeps divide
// their energy by q^2n. Sweeps that would not end within kMostSweeps end after kTrialSweeps.
ContactSweeps::Result ContactSweeps::solve( double fraction, double least, double most )
{
	for ( Contact& contact : contacts )
	{
		measureResponse( contact );
		contact.normalImpulse = std::max( 0.0, contact.normalImpulse );
		contact.tangentImpulse *= contact.normalImpulse > 0.0 ? 1.0 : 0.0;
		apply( contact, contact.normalImpulse * contact.normal + contact.tangentImpulse );
	}
	Result result;
	double last = 0.0;
	bool mayEnd = true;
	while ( !result.isAccurate && result.sweeps < kMostSweeps && mayEnd )
	{
		const double change = sweep( result.sweeps < kPlainSweeps ? 1.0 : kSweepRelaxation );
		++result.sweeps;
		const double square = result.sweeps > 1 ? change / last : 1.0, ratio = std::sqrt( square );
		const double left = ratio < 1.0 ? change * square / ( ( 1.0 - ratio ) * ( 1.0 - ratio ) ) : HUGE_VAL;
		const double tolerance = std::clamp( fraction * fraction * storedEnergy(), least, most );
		result.isAccurate = change == 0.0 || left <= tolerance;
		mayEnd = result.sweeps < kTrialSweeps || left * std::pow( square, kMostSweeps - result.sweeps ) <= tolerance;
		last = change;
	}
	return result;
}

} // namespace pliant
