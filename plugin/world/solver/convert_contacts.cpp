// Converts manifolds to ContactSolver's rows, in Bullet's order of evaluation, without its products with zero.

#include "world/solver/convert_contacts.h"

#include "world/bodies/prefetch.h"
#include "world/shape/contact_proxy.h"

#include <algorithm>

namespace pliant {

namespace {

/// Prefetch distances of manifolds, and of bodies and points.
constexpr int kManifoldsAhead = 16, kBodiesAhead = 8;

void prefetchContact( const btPersistentManifold& manifold )
{
	const btManifoldPoint& point = manifold.getContactPoint( 0 );
	const char* const from = reinterpret_cast<const char*>( &point.m_normalWorldOnB );
	prefetch( from, std::size_t( reinterpret_cast<const char*>( &point + 1 ) - from ) );
	for ( const btCollisionObject* object : { manifold.getBody0(), manifold.getBody1() } )
	{
		prefetchAll( *object );
		prefetch( &static_cast<const btRigidBody*>( object )->getLinearVelocity(), 3 * sizeof( btVector3 ) );
	}
}

/// Compliance of a contact:   cfm / h,  erp
struct Softness
{
	btScalar cfm, erp;
};

Softness softnessOf( const btManifoldPoint& point, const btContactSolverInfo& info )
{
	const int flags = point.m_contactPointFlags;
	Softness soft{ info.m_globalCfm, info.m_erp2 };
	if ( flags & ( BT_CONTACT_FLAG_HAS_CONTACT_CFM | BT_CONTACT_FLAG_HAS_CONTACT_ERP ) )
	{
		soft.cfm = flags & BT_CONTACT_FLAG_HAS_CONTACT_CFM ? point.m_contactCFM : soft.cfm;
		soft.erp = flags & BT_CONTACT_FLAG_HAS_CONTACT_ERP ? point.m_contactERP : soft.erp;
	}
	else if ( flags & BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING )
	{
		const btScalar all = info.m_timeStep * point.m_combinedContactStiffness1 + point.m_combinedContactDamping1;
		const btScalar whole = all < SIMD_EPSILON ? btScalar( SIMD_EPSILON ) : all;
		soft = { btScalar( 1 ) / whole, ( info.m_timeStep * point.m_combinedContactStiffness1 ) / whole };
	}
	soft.cfm *= btScalar( 1 ) / info.m_timeStep;
	return soft;
}

} // namespace

/// False where a proxy has forces set by the game: Bullet solves such an island.
bool ContactSolver::Conversion::findSide( btCollisionObject& object, Side& side )
{
	side = Side{ &object, 0, 0, nullptr, nullptr };
	if ( object.internalGetExtensionPointer() == &kContactProxyMark )
	{
		auto& body = static_cast<ContactProxy&>( object );
		if ( body.getInvMass() != 0 || body.isKinematicObject() )
		{
			side.point = body.getCompanionId();
			if ( side.point < 0 )
			{
				side.point = rows.addPoint( body );
				body.setCompanionId( side.point );
			}
			// Forces lie in a cache line that nothing else uses.
			side.angularVelocity = body.getAngularVelocity().isZero() ? nullptr : &body.getAngularVelocity();
			return !hasContactCallback() || body.getTotalForce().isZero();
		}
	}
	side.solverBody = solver.getOrInitSolverBody( object, info.m_timeStep );
	return true;
}

bool ContactSolver::Conversion::isHeld( const Side& side ) const
{
	const btScalar inverse = pointOf( side ).inverseMass;
	return ( side.point > 0 ? btVector3( inverse, inverse, inverse ) : solver.m_tmpSolverBodyPool[side.solverBody].m_invMass ).fuzzyZero();
}

bool ContactSolver::Conversion::convert( btPersistentManifold& manifold )
{
	auto& object0 = const_cast<btCollisionObject&>( *manifold.getBody0() );
	auto& object1 = const_cast<btCollisionObject&>( *manifold.getBody1() );
	if ( !findSide( object0, a ) || !findSide( object1, b ) )
	{
		return false;
	}
	if ( a.point == 0 && b.point == 0 )
	{
		convertBulletContact( manifold );
		return true;
	}
	if ( isHeld( a ) && isHeld( b ) )
	{
		return true;
	}
	for ( Side* side : { &a, &b } )
	{
		btSolverBody* const body = side->point > 0 ? nullptr : &solver.m_tmpSolverBodyPool[side->solverBody];
		side->body = body && body->m_originalBody ? body : nullptr;
	}
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		point = &manifold.getContactPoint( k );
		if ( point->getDistance() > manifold.getContactProcessingThreshold() )
		{
			continue;
		}
		if ( point->m_combinedRollingFriction > 0 )
		{
			return false;
		}
		convertPoint();
	}
	return true;
}

void ContactSolver::Conversion::convertBulletContact( btPersistentManifold& manifold )
{
	const btConstraintArray& pool = solver.m_tmpSolverContactConstraintPool;
	const int first = pool.size();
	solver.convertContact( &manifold, info );
	for ( int k = first; k < pool.size(); ++k )
	{
		rows.addStep( RowKind::Bullet, k );
		if ( pool[k].m_rhsPenetration != 0 )
		{
			rows.deep.push_back( ContactRows::Deep{ RowPosition{ RowKind::Bullet, k }, 0, 0 } );
		}
	}
}

/// Velocity at the contact point, m/s, including the forces of this step.
btVector3 ContactSolver::Conversion::velocityOf( const Side& side ) const
{
	btVector3 velocity = side.point > 0 ? pointOf( side ).velocity : btVector3( 0, 0, 0 );
	if ( side.angularVelocity )
	{
		velocity += side.angularVelocity->cross( armOf( side ) );
	}
	if ( side.body )
	{
		side.body->getVelocityInLocalPointNoDelta( arm, velocity );
	}
	return velocity;
}

void ContactSolver::Conversion::findLever( const btVector3& normal, Lever& lever ) const
{
	const Side* const rotating = rotatingSide();
	if ( !rotating )
	{
		setWhole( lever.axis, a.point > 0 ? normal : -normal );
		lever.inverse = pointOf( a ).inverseMass + pointOf( b ).inverseMass;
		return;
	}
	const btRigidBody& body = *rotating->body->m_originalBody;
	setWhole( lever.axis, rotating == &a ? normal : -normal );
	setWhole( lever.cross, arm.cross( lever.axis ) );
	lever.angular = body.getInvInertiaTensorWorld() * lever.cross * body.getAngularFactor();
	lever.inverse = body.getInvMass() + lever.axis.dot( lever.angular.cross( arm ) ) + pointOf( rotating == &a ? b : a ).inverseMass;
}

/// Velocity of separation along a row, m/s.
btScalar ContactSolver::Conversion::approach( const Lever& lever, bool withTorque ) const
{
	const Side* const rotating = rotatingSide();
	if ( !rotating )
	{
		return along( a.point > 0 ? a : b, lever.axis ) - ( a.point > 0 && b.point > 0 ? along( b, lever.axis ) : btScalar( 0 ) );
	}
	const btSolverBody& body = *rotating->body;
	const btVector3 turn = withTorque ? body.m_angularVelocity + body.m_externalTorqueImpulse : body.m_angularVelocity;
	const btScalar ofBody = lever.axis.dot( body.m_linearVelocity + body.m_externalForceImpulse ) + lever.cross.dot( turn );
	return ofBody - along( rotating == &a ? b : a, lever.axis );
}

/// Restitution velocity of a contact, m/s: from the bodies' velocities without forces.
btScalar ContactSolver::Conversion::bounce() const
{
	if ( point->m_combinedRestitution == 0 )
	{
		return 0;
	}
	const auto velocity = [this]( const Side& side ) {
		return side.body ? side.body->m_originalBody->getVelocityInLocalPoint( arm ) : velocityOf( side );
	};
	const btScalar parting = point->m_normalWorldOnB.dot( velocity( a ) - velocity( b ) );
	const btScalar back = solver.restitutionCurve( parting, point->m_combinedRestitution, info.m_restitutionVelocityThreshold );
	return back <= 0 ? btScalar( 0 ) : back;
}

void ContactSolver::Conversion::warmStart( const Lever& lever, btScalar impulse )
{
	const Side* const rotating = rotatingSide();
	const std::size_t first = std::size_t( firstPoint() ), second = rotating ? first : std::size_t( secondPoint() );
	if ( rotating )
	{
		rotating->body->internalApplyImpulse( lever.axis * rotating->body->internalGetInvMass(), lever.angular, impulse );
	}
	else
	{
		rows.change[first] += lever.axis * rows.points[first].inverseMass * impulse;
	}
	rows.change[second] -= lever.axis * rows.points[second].inverseMass * impulse; // the placeholder's stays zero
}

/// `which`: -1 for the normal row, else the friction direction.
void ContactSolver::Conversion::write( const Lever& lever, RowData data, int which )
{
	data.normal = lever.axis;
	if ( const Side* const rotating = rotatingSide() )
	{
		const int node = rotating == &a ? b.point : a.point;
		( which < 0 ? rows.rotatingNormalRows[std::size_t( position.at )]
					: rows.rotatingFrictionRows[std::size_t( position.at * rows.directions + which )] ) = RotatingRow{ lever.axis,
			lever.cross, lever.angular, data.effectiveMass, data.rhs, data.cfm, data.impulse, data.friction,
			rows.points[std::size_t( node )].inverseMass, node, rotating->solverBody, rotating == &a, 1. / data.effectiveMass };
		return;
	}
	const int first = firstPoint(), second = secondPoint(), four = position.at / kRowLanes, kind = int( position.kind );
	FourRows& row = which < 0 ? rows.normalRows[kind][std::size_t( four )]
							  : rows.frictionRows[kind][std::size_t( four * rows.directions + which )];
	row.set( position.at % kRowLanes, data, first, rows.points[std::size_t( first )].inverseMass, second,
		rows.points[std::size_t( second )].inverseMass );
}

void ContactSolver::Conversion::convertPoint()
{
	if ( const Side* const rotating = rotatingSide() )
	{
		arm = armOf( *rotating );
	}
	const Softness soft = softnessOf( *point, info );
	Lever lever;
	findLever( point->m_normalWorldOnB, lever );
	const btScalar perSecond = btScalar( 1 ) / info.m_timeStep, depth = point->getDistance() + info.m_linearSlop;
	RowData data;
	data.effectiveMass = info.m_sor / ( lever.inverse + soft.cfm );
	data.friction = point->m_combinedFriction;
	data.impulse = info.m_solverMode & SOLVER_USE_WARMSTARTING ? point->m_appliedImpulse * info.m_warmstartingFactor : btScalar( 0 );
	data.cfm = soft.cfm * data.effectiveMass;
	// A gap may close; a penetration is pushed out, by split impulse where it is deep enough.
	btScalar off = bounce() - approach( lever, true );
	off -= depth > 0 ? depth * perSecond : btScalar( 0 );
	const btScalar out = ( depth > 0 ? btScalar( 0 ) : -depth * soft.erp * perSecond ) * data.effectiveMass;
	const bool isSplit = info.m_splitImpulse && !( depth > info.m_splitImpulsePenetrationThreshold );
	data.rhs = isSplit ? off * data.effectiveMass : out + off * data.effectiveMass;

	position = rows.allocate( rotatingSide() ? RowKind::Rotating
			: a.point > 0 && b.point > 0     ? RowKind::Pair
											 : RowKind::Static,
		firstPoint(), secondPoint() );
	write( lever, data, -1 );
	rows.contacts.push_back( ContactRows::Contact{ point, position } );
	if ( isSplit && out != 0 )
	{
		rows.deep.push_back( ContactRows::Deep{ position, out, 0 } );
	}
	if ( info.m_solverMode & SOLVER_USE_WARMSTARTING )
	{
		warmStart( lever, data.impulse );
	}
	const bool areDirectionsGiven = ( info.m_solverMode & SOLVER_ENABLE_FRICTION_DIRECTION_CACHING ) &&
		( point->m_contactPointFlags & BT_CONTACT_FLAG_LATERAL_FRICTION_INITIALIZED );
	if ( !areDirectionsGiven )
	{
		chooseDirections();
	}
	addFrictionRow( point->m_lateralFrictionDir1, 0, areDirectionsGiven ? point->m_contactMotion1 : btScalar( 0 ),
		areDirectionsGiven ? point->m_frictionCFM : btScalar( 0 ) );
	if ( rows.directions > 1 )
	{
		addFrictionRow( point->m_lateralFrictionDir2, 1, areDirectionsGiven ? point->m_contactMotion2 : btScalar( 0 ),
			areDirectionsGiven ? point->m_frictionCFM : btScalar( 0 ) );
	}
}

/// Along the slip velocity, or any tangential direction without slip.
void ContactSolver::Conversion::chooseDirections()
{
	const btVector3 &normal = point->m_normalWorldOnB, velocity = velocityOf( a ) - velocityOf( b );
	btVector3 &first = point->m_lateralFrictionDir1, &second = point->m_lateralFrictionDir2;
	const bool hasTwo = rows.directions > 1, isFixed = ( info.m_solverMode & SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION ) != 0;
	const auto scale = [this]( btVector3& direction ) {
		for ( const Side* side : { &a, &b } )
		{
			if ( side->object->hasAnisotropicFriction( btCollisionObject::CF_ANISOTROPIC_FRICTION ) )
			{
				applyAnisotropicFriction( side->object, direction, btCollisionObject::CF_ANISOTROPIC_FRICTION );
			}
		}
	};
	first = velocity - normal * normal.dot( velocity );
	const btScalar slip2 = first.length2();
	if ( !isFixed && slip2 > SIMD_EPSILON )
	{
		first *= btScalar( 1 ) / btSqrt( slip2 );
		scale( first );
		if ( hasTwo )
		{
			second = first.cross( normal );
			second.normalize();
			scale( second );
		}
		return;
	}
	btPlaneSpace1( normal, first, second );
	scale( first );
	if ( hasTwo )
	{
		scale( second );
		point->m_contactPointFlags |= isFixed ? int( BT_CONTACT_FLAG_LATERAL_FRICTION_INITIALIZED ) : 0;
	}
}

void ContactSolver::Conversion::addFrictionRow( const btVector3& direction, int which, btScalar wanted, btScalar cfm )
{
	Lever lever;
	findLever( direction, lever );
	RowData data;
	data.effectiveMass = info.m_sor / lever.inverse;
	data.friction = point->m_combinedFriction;
	data.impulse = 0;
	data.cfm = cfm;
	data.rhs = ( wanted - approach( lever, false ) ) * data.effectiveMass;
	if ( point->m_contactPointFlags & BT_CONTACT_FLAG_FRICTION_ANCHOR )
	{
		const btScalar apart = ( point->getPositionWorldOnA() - point->getPositionWorldOnB() ).dot( direction );
		data.rhs = ( -apart * info.m_frictionERP / info.m_timeStep ) * data.effectiveMass + data.rhs;
	}
	write( lever, data, which );
}

/// Undoes the conversion.
void ContactSolver::Conversion::revert()
{
	for ( std::size_t i = 1; i < rows.points.size(); ++i )
	{
		rows.points[i].body->setCompanionId( -1 );
	}
	for ( int i = 0; i < solver.m_tmpSolverBodyPool.size(); ++i )
	{
		solver.m_tmpSolverBodyPool[i].m_deltaLinearVelocity.setZero();
		solver.m_tmpSolverBodyPool[i].m_deltaAngularVelocity.setZero();
	}
	solver.m_tmpSolverContactConstraintPool.resizeNoInitialize( 0 );
	solver.m_tmpSolverContactFrictionConstraintPool.resizeNoInitialize( 0 );
	solver.m_tmpSolverContactRollingFrictionConstraintPool.resizeNoInitialize( 0 );
}

// Manifolds and bodies are scattered in memory, and prefetched.
void ContactSolver::convertContacts( btPersistentManifold** manifolds, int count, const btContactSolverInfo& info )
{
	m_isInUse = isPlain( info );
	m_rows->clear( info.m_solverMode & SOLVER_USE_2_FRICTION_DIRECTIONS ? 2 : 1 );
	Conversion conversion{ *this, *m_rows, info };
	for ( int m = 0; m_isInUse && m < count; ++m )
	{
		if ( m + kManifoldsAhead < count )
		{
			prefetchManifold( *manifolds[m + kManifoldsAhead] );
		}
		if ( m + kBodiesAhead < count )
		{
			prefetchContact( *manifolds[m + kBodiesAhead] );
		}
		m_isInUse = conversion.convert( *manifolds[m] );
		if ( !m_isInUse )
		{
			conversion.revert();
		}
	}
	if ( !m_isInUse )
	{
		btSequentialImpulseConstraintSolver::convertContacts( manifolds, count, info );
	}
}

} // namespace pliant
