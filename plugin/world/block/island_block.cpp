#include "world/block/island_block.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <algorithm>

namespace pliant {

void IslandBlock::clear()
{
	soft.clear();
	rigid.clear();
	linked.clear();
	contacts.clear();
	frictionScales.clear();
}

Vec3d IslandBlock::velocityOf( const ContactSide& side, const Vec3d& normal, const float* v ) const
{
	if ( side.soft >= 0 )
	{
		const SoftPart& part = soft[std::size_t( side.soft )];
		const int padded = part.motion->padded();
		return side.shared.velocity( normal, [&]( int node ) {
			const float* const at = v + part.offset + node;
			return Vec3d( double( at[0] ), double( at[padded] ), double( at[2 * padded] ) );
		} );
	}
	if ( side.rigid >= 0 )
	{
		const Eigen::Map<const Eigen::Matrix<float, 6, 1>> at( v + rigid[std::size_t( side.rigid )].offset );
		const Vec3d turn = at.tail<3>().cast<double>();
		return at.head<3>().cast<double>() + turn.cross( side.arm );
	}
	return Vec3d::Zero();
}

Vec3d IslandBlock::changeAt( const BlockContact& contact, const float* v ) const
{
	return velocityOf( contact.side[0], contact.normal, v ) - velocityOf( contact.side[1], contact.normal, v );
}

Vec3d IslandBlock::relativeVelocity( const BlockContact& contact, const float* v ) const
{
	return ( velocityOf( contact.side[0], contact.normal, v ) + contact.side[0].prescribedVelocity ) -
		( velocityOf( contact.side[1], contact.normal, v ) + contact.side[1].prescribedVelocity );
}

void IslandBlock::addImpulse( const ContactSide& side, const Vec3d& normal, const Vec3d& impulse, float* to ) const
{
	if ( side.soft >= 0 )
	{
		const SoftPart& part = soft[std::size_t( side.soft )];
		const int padded = part.motion->padded();
		side.shared.share( normal, impulse, [&]( int node, const Vec3d& own ) {
			float* const at = to + part.offset + node;
			for ( int k = 0; k < 3; ++k )
			{
				at[k * padded] += float( own[k] );
			}
		} );
	}
	else if ( side.rigid >= 0 )
	{
		const RigidPart& part = rigid[std::size_t( side.rigid )];
		float* const at = to + part.offset;
		const Vec3d turn = side.arm.cross( impulse );
		for ( int k = 0; k < 3; ++k )
		{
			at[k] += part.moves[k] ? float( impulse[k] ) : 0.0f;
			at[3 + k] += part.turns[k] ? float( turn[k] ) : 0.0f;
		}
	}
}

void IslandBlock::addPair( const BlockContact& contact, const Vec3d& impulse, float* to ) const
{
	addImpulse( contact.side[0], contact.normal, impulse, to );
	addImpulse( contact.side[1], contact.normal, -impulse, to );
}

void IslandBlock::applyMasses( const float* v, float* to )
{
	for ( const SoftPart& part : soft )
	{
		part.motion->apply( v + part.offset, to + part.offset, m_runner );
	}
	for ( const RigidPart& part : rigid )
	{
		const float* from = v + part.offset;
		if ( part.linked >= 0 )
		{
			Eigen::Map<Eigen::Matrix<float, 6, 1>>( to + part.offset ) = linkMomentum( part, [v]( const RigidPart& link ) {
				return Vector6( Eigen::Map<const Eigen::Matrix<float, 6, 1>>( v + link.offset ).cast<double>() );
			} ).cast<float>();
			continue;
		}
		const Vec3d spin = part.inertia * Vec3d( double( from[3] ), double( from[4] ), double( from[5] ) );
		for ( int k = 0; k < 3; ++k )
		{
			to[part.offset + k] = part.moves[k] ? float( part.mass * double( from[k] ) ) : 0.0f;
			to[part.offset + 3 + k] = part.turns[k] ? float( spin[k] ) : 0.0f;
		}
	}
	const int used = rigid.empty() ? ( soft.empty() ? 0 : soft.back().offset + soft.back().motion->size() ) : rigid.back().offset + 6;
	std::fill( to + used, to + m_size, 0.0f );
}

ActiveContact::Side IslandBlock::flatSide( const ContactSide& side ) const
{
	ActiveContact::Side own;
	own.stride = side.soft >= 0 ? soft[std::size_t( side.soft )].motion->padded() : 0;
	own.count = side.soft >= 0 ? side.shared.count : side.rigid >= 0 ? 1 : 0;
	own.index[0] = side.rigid >= 0 ? rigid[std::size_t( side.rigid )].offset : -1;
	for ( int j = 0; side.soft >= 0 && j < own.count; ++j )
	{
		own.index[j] = soft[std::size_t( side.soft )].offset + side.shared.node[j];
		own.rub[j] = side.shared.rub[j];
		own.excess[j] = side.shared.press[j] - side.shared.rub[j];
	}
	Eigen::Map<Vec3d>( own.arm ) = side.arm;
	return own;
}

void IslandBlock::listActive()
{
	m_active.clear();
	for ( const BlockContact& contact : contacts )
	{
		if ( !contact.isActive )
		{
			continue;
		}
		ActiveContact flat;
		flat.side[0] = flatSide( contact.side[0] );
		flat.side[1] = flatSide( contact.side[1] );
		Eigen::Map<Vec3d>( flat.normal ) = contact.normal;
		flat.along = contact.stiffness - ( contact.frictionScale < 0 ? contact.tangentStiffness : 0.0 );
		flat.across = contact.tangentStiffness;
		flat.frictionScale = contact.frictionScale;
		m_active.push_back( flat );
	}
}

namespace {

void addForce( const ActiveContact::Side& side, const double ( &normal )[3], const double ( &f )[3], double sign, float* to )
{
	if ( side.stride > 0 )
	{
		const double along = ( normal[0] * f[0] + normal[1] * f[1] ) + normal[2] * f[2];
		for ( int j = 0; j < side.count; ++j )
		{
			float* const at = to + side.index[j];
			const double rub = sign * side.rub[j], excess = sign * side.excess[j] * along;
			for ( int k = 0; k < 3; ++k )
			{
				at[k * side.stride] += float( rub * f[k] + excess * normal[k] );
			}
		}
		return;
	}
	float* const at = to + side.index[0];
	const double* const r = side.arm;
	for ( int k = 0; k < 3; ++k )
	{
		at[k] += float( sign * f[k] );
	}
	at[3] += float( sign * ( r[1] * f[2] - r[2] * f[1] ) );
	at[4] += float( sign * ( r[2] * f[0] - r[0] * f[2] ) );
	at[5] += float( sign * ( r[0] * f[1] - r[1] * f[0] ) );
}

} // namespace

void IslandBlock::apply( const float* v, float* to )
{
	applyMasses( v, m_massProduct.data() );
	std::copy( m_massProduct.begin(), m_massProduct.begin() + m_size, to );
	for ( const ActiveContact& c : m_active )
	{
		double u[3] = {};
		for ( int side = 0; side < 2; ++side )
		{
			if ( c.side[side].count > 0 )
			{
				addVelocity( c.side[side], c.normal, v, side == 0 ? 1.0 : -1.0, u );
			}
		}
		const double along = c.along * ( ( c.normal[0] * u[0] + c.normal[1] * u[1] ) + c.normal[2] * u[2] );
		if ( c.frictionScale >= 0 )
		{
			Eigen::Map<Vec3d> across( u );
			across = ( frictionScales[std::size_t( c.frictionScale )] * across ).eval();
		}
		const double f[3] = {
			along * c.normal[0] + c.across * u[0], along * c.normal[1] + c.across * u[1], along * c.normal[2] + c.across * u[2] };
		for ( int side = 0; side < 2; ++side )
		{
			if ( c.side[side].count > 0 )
			{
				addForce( c.side[side], c.normal, f, side == 0 ? 1.0 : -1.0, to );
			}
		}
	}
	for ( const RigidPart& part : rigid ) // locked axes stay 0
	{
		for ( int k = 0; k < 3; ++k )
		{
			to[part.offset + k] = part.moves[k] ? to[part.offset + k] : 0.0f;
			to[part.offset + 3 + k] = part.turns[k] ? to[part.offset + 3 + k] : 0.0f;
		}
	}
}

// The contact terms of a product grow with stiffness and cancel each other, so the residual without contacts is kept separately.
void IslandBlock::moved( float by )
{
	for ( int k = 0; k < m_size; ++k )
	{
		m_freeNext[k] -= by * m_massProduct[k];
	}
}

bool IslandBlock::isIdle() const
{
	return contacts.empty() && rigid.empty() &&
		std::none_of( soft.begin(), soft.end(), []( const SoftPart& part ) { return part.motion->isElastic(); } );
}

BlockCount IslandBlock::solve( TaskRunner* runner )
{
	BlockCount count;
	if ( isIdle() )
	{
		return count;
	}
	m_runner = runner;
	layOut();
	reconcileTargets();
	chooseStiffness();
	solveLaw( count );
	limitEnergy( count );
	completeBounce();
	carryImpulses();
	bounceAsRigid(); // the next substep starts from the impulses that stopped the nodes
	readSolution();
	restoreMomentum();
	return count;
}

void IslandBlock::beginResponses( TaskRunner* runner )
{
	m_runner = runner;
	layOut();
	fillPreconditioner();
}

// Accurate to a fraction of the response itself, not of the initial error of a good guess.
void IslandBlock::respond( const float* impulse, float* velocity, double fraction )
{
	const int size = soft.front().motion->size();
	std::fill( m_rightSide.begin(), m_rightSide.end(), 0.0f );
	std::copy( impulse, impulse + size, m_rightSide.begin() );
	std::fill( m_v.begin(), m_v.end(), 0.0f );
	std::copy( velocity, velocity + size, m_v.begin() );
	precondition( m_rightSide.data(), m_next.data() );
	const double whole = dot( m_rightSide.data(), m_next.data(), m_size );
	m_gradients.solve( *this, m_rightSide.data(), m_v.data(), GradientLimits{ 0.0, fraction * whole, kMostGradients } );
	std::copy( m_v.begin(), m_v.begin() + size, velocity );
}

// A pass is solved to full accuracy only once it is known to be the last: which contacts change is known long before convergence. After
// sweeps passes start from their velocities and impulses.
void IslandBlock::solveLaw( BlockCount& count )
{
	m_isUnsettled = false;
	const bool isSwept = canSweep();
	if ( isSwept && sweepContacts( count ) )
	{
		return;
	}
	int passes = 0;
	linearise( m_v.data(), isSwept ? 1 : 0 );
	fillFree();
	++count.products;
	while ( true )
	{
		fillPreconditioner();
		m_next = m_v;
		m_freeNext = m_free;
		beginIteration();
		++passes;
		iterate( passes < kMostPasses ? kPassFraction : kLatePassFraction, count );
		bool isLast = mayStop( passes );
		if ( isLast )
		{
			beginIteration();
			iterate( 0.0, count );
			isLast = mayStop( passes );
		}
		if ( isLast )
		{
			break;
		}
		// The first step is taken in full: it adds the forces that the initial guess lacks.
		const float t = passes == 1 ? 1.0f : float( stepTowards() );
		for ( int k = 0; k < m_size; ++k )
		{
			m_v[k] += t * ( m_next[k] - m_v[k] );
			m_free[k] += t * ( m_freeNext[k] - m_free[k] );
		}
		linearise( m_v.data(), passes );
	}
	m_v = m_next;
	m_isUnsettled = passes >= kMostHardPasses;
	count.passes += passes;
}

bool IslandBlock::mayStop( int passes )
{
	const Match match = matchAt( m_next.data() );
	const bool isSettled = match.all && match.each;
	return isSettled || passes >= kMostHardPasses ||
		( passes >= kMostPasses && !isUnphysical() && !leavesApproach() && ( match.each || passes >= kMostFairPasses ) );
}

void IslandBlock::readSolution()
{
	for ( SoftPart& part : soft )
	{
		part.motion->setNodeVelocities( m_v.data() + part.offset );
	}
	for ( RigidPart& part : rigid )
	{
		for ( int k = 0; k < 6; ++k )
		{
			part.velocity[k] = double( m_v[std::size_t( part.offset + k )] );
		}
	}
}

} // namespace pliant
