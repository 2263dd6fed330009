// Contacts of an implicit block: how hard they press and rub at given speeds, linearised.
//
//   jn = max( 0, ln + k ( b - u.n ) ),   ln the impulse of the last substep
//   jt = s ( lt - ks ut ),   s = min( 1, mu jn / | lt - ks ut | ),   ks = min( k, mu jn / u_eps )
//
// Both are what an augmented Lagrangian with one step a substep makes of Signorini's and Coulomb's laws (Alart and Curnier 1991): a contact
// that keeps pressing ends with u.n = b and, held, with ut = 0, however soft k is. The derivative of jt is replaced by its secant, - s ks,
// which can only dissipate; Newton's own turned small slips round in this place and threw stacks.
//
// Friction by direction (btCollisionObject::setAnisotropicFriction): the same law finds t, of length mu jn at most, and jt = S t, S the
// things' scales in their own axes, without the normal. So a slide along t is braked by mu jn S t, as Bullet's solver does.

#include "world/constants.h"
#include "world/implicit/implicit_block.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

struct Law
{
	double tangentStiffness;
	Vec3d held;
};

double pressAt( const BlockContact& contact, const Vec3d& u )
{
	return contact.pushed + contact.stiffness * ( contact.target - contact.normal.dot( u ) );
}

Vec3d speedAmong( const BlockContact& contact, const ContactSide& side, const Vec3Array& v )
{
	return side.shared.velocity( contact.normal, [&]( int node ) { return Vec3d( v.get( node ).cast<double>() ); } );
}

Law lawAt( const BlockContact& contact, const Vec3d& u, double press )
{
	const double along = contact.normal.dot( u );
	if ( !( press > 0.0 ) )
	{
		return Law{ 0.0, Vec3d::Zero() };
	}
	const double limit = contact.friction * press;
	const double stick = std::min( contact.stiffness, limit / kSlipSpeed );
	const Vec3d trial = contact.heldBefore - stick * ( u - along * contact.normal );
	const double size = trial.norm();
	const double fraction = size > limit ? limit / size : 1.0;
	return Law{ fraction * stick, fraction * contact.heldBefore };
}

} // namespace

Vec3d ImplicitBlock::freeSpeed( const BlockContact& contact ) const
{
	Vec3d speed[2];
	for ( int k = 0; k < 2; ++k )
	{
		const ContactSide& side = contact.side[k];
		speed[k] = side.given;
		if ( side.soft >= 0 )
		{
			speed[k] += speedAmong( contact, side, soft[std::size_t( side.soft )].motion->nodes().v );
		}
		else if ( side.rigid >= 0 )
		{
			const Vector6& free = rigid[std::size_t( side.rigid )].free;
			speed[k] += free.head<3>() + free.tail<3>().cross( side.arm );
		}
	}
	return speed[0] - speed[1];
}

const Vec3d& ImplicitBlock::turnOf( const ContactSide& side )
{
	SoftPart& part = soft[std::size_t( side.soft )];
	if ( part.turn.empty() )
	{
		for ( int k = 0; k < part.motion->parts().count(); ++k )
		{
			part.turn.push_back( part.motion->hasShape( k )
					? Vec3d( ( part.motion->rigidMass( k ).inverse() * part.motion->momentum( k ) ).tail<3>() )
					: Vec3d( Vec3d::Zero() ) );
		}
	}
	return part.turn[std::size_t( part.motion->parts().partOf( side.node ) )];
}

Vec3d ImplicitBlock::velocityBefore( const BlockContact& contact ) const
{
	Vec3d speed[2];
	for ( int k = 0; k < 2; ++k )
	{
		const ContactSide& side = contact.side[k];
		speed[k] = side.given;
		if ( side.soft >= 0 )
		{
			speed[k] += speedAmong( contact, side, *soft[std::size_t( side.soft )].before );
		}
		else if ( side.rigid >= 0 )
		{
			const Vector6& before = rigid[std::size_t( side.rigid )].before;
			speed[k] += before.head<3>() + before.tail<3>().cross( side.arm );
		}
	}
	return speed[0] - speed[1];
}

// The impulse t of the last substep that has become S t: what S does not let through was none.
Vec3d ImplicitBlock::undirected( const BlockContact& contact ) const
{
	if ( contact.directed < 0 )
	{
		return contact.tangentImpulse;
	}
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes( directions[std::size_t( contact.directed )] );
	const double floor = kLeastDirection * std::max( 1.0, axes.eigenvalues()[2] );
	const Vec3d inverse = ( axes.eigenvalues().array() > floor ).select( axes.eigenvalues().array().max( floor ).inverse(), 0.0 );
	return axes.eigenvectors() * ( inverse.asDiagonal() * ( axes.eigenvectors().transpose() * contact.tangentImpulse ) );
}

// k is as much more than the nodes' own resistance as keeps the error of a first touch small and the system easy to solve.
void ImplicitBlock::chooseStiffness()
{
	for ( BlockContact& contact : contacts )
	{
		double least = HUGE_VAL;
		for ( const ContactSide& side : contact.side )
		{
			least = side.soft < 0 ? least : std::min( least, double( soft[std::size_t( side.soft )].motion->diagonal( side.node ) ) );
		}
		// A marble on a stiff body is a thousandth of what its nodes resist with; what is left of that when the iteration ends would be all
		// its weight.
		const bool hasNode = contact.side[0].soft >= 0 || contact.side[1].soft >= 0;
		for ( const ContactSide& side : contact.side )
		{
			least = ( hasNode && !contact.isDrawn ) || side.rigid < 0 ? least : std::min( least, rigid[std::size_t( side.rigid )].mass );
		}
		contact.stiffness = kContactStiffness * least;
		contact.pushed = contact.normalImpulse;
		contact.heldBefore = undirected( contact );
	}
}

// At the start speeds are the last substep's, and k times what they are off by says little: what has pressed presses on as hard.
//
// Friction's limits are mu times what contacts were last solved to press with, not what the law makes of the speeds there are: k is ten
// times what nodes resist with, and where a contact is new, or a way is not gone to its end, that is ten times too much and more, which
// stopped what is light. So what is new does not rub in the first pass, and of a wild pass nothing is taken for what has pressed before;
// not for long, for limits that were too high can be what keeps it wild.
void ImplicitBlock::linearise( const float* v, int passes )
{
	const bool isFirst = passes == 0, keeps = !isFirst && passes < kMostFairPasses && isWild();
	for ( BlockContact& contact : contacts )
	{
		const bool hasPressed = contact.pushed > 0.0;
		if ( !( keeps && hasPressed ) )
		{
			contact.limited = std::max( 0.0, isFirst ? contact.pushed : contact.normalImpulse );
		}
		const Vec3d u = relativeSpeed( contact, v );
		const Law law = lawAt( contact, u, contact.limited );
		contact.presses = ( isFirst && hasPressed ) || pressAt( contact, u ) > 0.0;
		contact.tangentStiffness = law.tangentStiffness;
		contact.held = law.held;
	}
	listPressing();
}

ImplicitBlock::Match ImplicitBlock::matchAt( const float* v )
{
	double pressError = 0.0, pressed = 0.0, rubError = 0.0, rubbed = 0.0;
	m_partErrors.assign( soft.size() + rigid.size(), PartError{} );
	for ( const BlockContact& contact : contacts )
	{
		const Vec3d u = relativeSpeed( contact, v );
		const double along = contact.normal.dot( u );
		const double press = std::max( 0.0, pressAt( contact, u ) ), limit = contact.friction * press;
		const Law law = lawAt( contact, u, press );
		const Vec3d error = directed( contact, law.held - law.tangentStiffness * ( u - along * contact.normal ) ) - contact.tangentImpulse;
		pressError += std::abs( press - contact.normalImpulse );
		rubError += error.norm();
		pressed += press;
		rubbed += limit;
		for ( int k = 0; k < 2; ++k )
		{
			const ContactSide& side = contact.side[k];
			if ( const int part = side.soft >= 0 ? side.soft : side.rigid >= 0 ? int( soft.size() ) + side.rigid : -1; part >= 0 )
			{
				m_partErrors[std::size_t( part )].rub += k == 0 ? error : Vec3d( -error );
				m_partErrors[std::size_t( part )].limit += limit;
			}
		}
	}
	const auto isFair = []( const PartError& part ) { return part.rub.norm() <= kPartError * part.limit; };
	return Match{ pressError <= kImpulseError * pressed && rubError <= kImpulseError * rubbed,
		std::all_of( m_partErrors.begin(), m_partErrors.end(), isFair ) };
}

// A pull of what still approaches brings energy in, and so does rubbing that holds what bounces against others. A little too much or too
// little rubbing, which is what most last passes end with, does not.
bool ImplicitBlock::isWild() const
{
	double pull = 0.0, press = 0.0, rub = 0.0, limit = 0.0;
	for ( const BlockContact& contact : contacts )
	{
		( contact.normalImpulse < 0.0 ? pull : press ) += std::abs( contact.normalImpulse );
		rub += contact.tangentImpulse.norm();
		limit += contact.friction * std::max( 0.0, contact.normalImpulse );
	}
	return pull > kImpulseError * press || rub > kLargestFrictionTorque * limit;
}

// With the law as it was linearised, not as it would be now: impulses that no solved system has carried would bring energy in.
void ImplicitBlock::readImpulses( const float* v )
{
	for ( BlockContact& contact : contacts )
	{
		const Vec3d u = relativeSpeed( contact, v );
		const double along = contact.normal.dot( u );
		contact.normalImpulse = contact.presses ? contact.pushed + contact.stiffness * ( contact.target - along ) : 0.0;
		const Vec3d rub = contact.held - contact.tangentStiffness * ( u - along * contact.normal );
		contact.tangentImpulse = contact.presses ? directed( contact, rub ) : Vec3d( Vec3d::Zero() );
	}
}

// The energy that is minimised, with friction's secants as they are, is convex and quadratic in pieces: the lowest point on the way, as a
// share of it.
//   slope( t ) = d.( M v - b ) + t d.M d - sum over contacts of ( jn n + jt ).u( d )
double ImplicitBlock::lowestFraction( double slope, double curvature ) const
{
	const auto slopeAt = [&]( double t ) {
		double sum = slope + t * curvature;
		for ( const Way& way : m_ways )
		{
			const double press = std::max( 0.0, way.pushed + way.stiffness * ( way.target - way.start - t * way.way ) );
			sum -= press * way.way + ( way.slideStart + t * way.slide );
		}
		return sum;
	};
	if ( slopeAt( 1.0 ) <= 0.0 )
	{
		return 1.0;
	}
	double low = 0.0, high = 1.0;
	for ( int k = 0; k < kLineSearchHalvings; ++k )
	{
		const double middle = 0.5 * ( low + high );
		( slopeAt( middle ) > 0.0 ? high : low ) = middle;
	}
	return low;
}

double ImplicitBlock::stepTowards()
{
	AlignedArray<float>&d = m_scratch, &change = m_rightSide; // of v, and of M v
	for ( int k = 0; k < m_size; ++k )
	{
		d[k] = m_next[k] - m_v[k];
		change[k] = m_free[k] - m_freeNext[k];
	}
	m_ways.clear();
	for ( const BlockContact& contact : contacts )
	{
		const Vec3d u = relativeSpeed( contact, m_v.data() ),
					way = speedOf( contact.side[0], contact.normal, d.data() ) - speedOf( contact.side[1], contact.normal, d.data() );
		const double un = contact.normal.dot( u ), dn = contact.normal.dot( way );
		const Vec3d ut = u - un * contact.normal, dt = way - dn * contact.normal, felt = directed( contact, dt );
		const double slideStart = contact.held.dot( felt ) - contact.tangentStiffness * ut.dot( felt ),
					 slide = -contact.tangentStiffness * dt.dot( felt );
		const bool presses = contact.presses;
		m_ways.push_back(
			Way{ un, dn, presses ? slideStart : 0.0, presses ? slide : 0.0, contact.pushed, contact.stiffness, contact.target } );
	}
	return lowestFraction( -dot( d.data(), m_free.data(), m_size ), dot( d.data(), change.data(), m_size ) );
}

} // namespace pliant
