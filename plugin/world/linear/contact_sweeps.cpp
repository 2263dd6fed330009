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

} // namespace

// W = sum p^2 / m along the normal and sum r^2 / m across it for nodes; 1 / M + [r]^T I^-1 [r] for a rigid body.
void ContactSweeps::measureResponse( Contact& contact ) const
{
	contact.alongResponse = contact.acrossResponse = 0.0;
	for ( int k = 0; k < 2; ++k )
	{
		const ActiveContact::Side& side = contact.side[k];
		if ( contact.rigid[k] >= 0 )
		{
			const Rigid& body = rigid[std::size_t( contact.rigid[k] )];
			Eigen::Matrix3d cross;
			cross << 0.0, -side.arm[2], side.arm[1], side.arm[2], 0.0, -side.arm[0], -side.arm[1], side.arm[0], 0.0;
			const Eigen::Matrix3d response = Eigen::Matrix3d( body.inverseMass.asDiagonal() ) +
				cross.transpose() * body.inverseInertia * cross;
			contact.alongResponse += contact.normal.dot( response * contact.normal );
			contact.acrossResponse += largestAcross( response, contact.normal );
			continue;
		}
		for ( int j = 0; j < side.count; ++j )
		{
			const double press = side.rub[j] + side.excess[j];
			contact.alongResponse += press * press * contact.inverseMass[k][j];
			contact.acrossResponse += side.rub[j] * side.rub[j] * contact.inverseMass[k][j];
		}
	}
}

// v += M^-1 J^T j, for one side
void ContactSweeps::push( const Contact& contact, int k, const Vec3d& impulse )
{
	const ActiveContact::Side& side = contact.side[k];
	if ( contact.rigid[k] >= 0 )
	{
		const Rigid& body = rigid[std::size_t( contact.rigid[k] )];
		Eigen::Map<Vector6> to( v.data() + side.index[0] );
		to.head<3>() += body.inverseMass.cwiseProduct( impulse );
		to.tail<3>() += body.inverseInertia * Eigen::Map<const Vec3d>( side.arm ).cross( impulse );
		return;
	}
	const Vec3d along = contact.normal.dot( impulse ) * contact.normal;
	for ( int j = 0; j < side.count; ++j )
	{
		double* const at = v.data() + side.index[j];
		const double rub = contact.inverseMass[k][j] * side.rub[j], excess = contact.inverseMass[k][j] * side.excess[j];
		for ( int i = 0; i < 3; ++i )
		{
			at[i * side.stride] += rub * impulse[i] + excess * along[i];
		}
	}
}

void ContactSweeps::apply( const Contact& contact, const Vec3d& impulse )
{
	push( contact, 0, impulse );
	push( contact, 1, -impulse );
}

Vec3d ContactSweeps::velocity( const Contact& contact ) const
{
	const double normal[3] = { contact.normal[0], contact.normal[1], contact.normal[2] };
	double u[3] = { contact.prescribed[0], contact.prescribed[1], contact.prescribed[2] };
	for ( int k = 0; k < 2; ++k )
	{
		if ( contact.side[k].count > 0 )
		{
			addVelocity( contact.side[k], normal, v.data(), k == 0 ? 1.0 : -1.0, u );
		}
	}
	return Vec3d( u[0], u[1], u[2] );
}

// jn = max( 0, ln + k ( b - un - W ( jn - jn' ) ) ) = max( 0, ( ln + k ( b - un + W jn' ) ) / ( 1 + k W ) ),   jn' the impulse before
double ContactSweeps::press( Contact& contact, const Vec3d& u, double relaxation )
{
	const double before = contact.normalImpulse, k = contact.stiffness, response = contact.alongResponse;
	const double solved = ( contact.multiplier + k * ( contact.target - contact.normal.dot( u ) + response * before ) ) /
		( 1.0 + k * response );
	contact.normalImpulse = std::max( 0.0, before + relaxation * ( solved - before ) );
	return contact.normalImpulse - before;
}

// Across the normal the same with ks and lt, but at most mu jn long. Applies the change together with `pushed` along the normal.
double ContactSweeps::rub( Contact& contact, const Vec3d& u, double pushed, double relaxation )
{
	const double limit = contact.friction * contact.normalImpulse, stick = std::min( contact.stiffness, limit / kSlipSpeed );
	const Vec3d before = contact.tangentImpulse, slip = u - contact.normal.dot( u ) * contact.normal;
	const Vec3d stopped = ( contact.tangentMultiplier - stick * ( slip - contact.acrossResponse * before ) ) /
		( 1.0 + stick * contact.acrossResponse );
	const Vec3d relaxed = before + relaxation * ( stopped - before );
	const double size = relaxed.norm();
	contact.tangentImpulse = size > limit ? Vec3d( limit / size * relaxed ) : relaxed;
	const Vec3d change = contact.tangentImpulse - before;
	apply( contact, pushed * contact.normal + change );
	return change.squaredNorm() * contact.acrossResponse * ( 1.0 + stick * contact.acrossResponse );
}

/// Returns the energy of the changes, J.
double ContactSweeps::sweep( double relaxation )
{
	double change = 0.0;
	for ( Contact& contact : contacts )
	{
		Vec3d u = velocity( contact );
		const bool wasIdle = contact.normalImpulse == 0.0;
		double pushed = press( contact, u, relaxation );
		if ( wasIdle && contact.normalImpulse == 0.0 )
		{
			continue;
		}
		change += pushed * pushed * contact.alongResponse * ( 1.0 + contact.stiffness * contact.alongResponse );
		if ( contact.rigid[0] >= 0 || contact.rigid[1] >= 0 ) // a push along the normal makes a rigid body's surface slide
		{
			apply( contact, pushed * contact.normal );
			pushed = 0.0;
			u = velocity( contact );
		}
		change += rub( contact, u, pushed, relaxation );
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

// Sweeps converge linearly: after changes of the ratio q those still to come sum to q / ( 1 - q ) times the last.
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
	while ( !result.isAccurate && result.sweeps < kMostSweeps )
	{
		const double change = sweep( result.sweeps < kPlainSweeps ? 1.0 : kSweepRelaxation );
		++result.sweeps;
		const double ratio = result.sweeps > 1 ? std::sqrt( change / last ) : 1.0;
		const double left = ratio < 1.0 ? change * ratio * ratio / ( ( 1.0 - ratio ) * ( 1.0 - ratio ) ) : HUGE_VAL;
		result.isAccurate = change == 0.0 || left <= std::clamp( fraction * fraction * storedEnergy(), least, most );
		last = change;
	}
	return result;
}

} // namespace pliant
