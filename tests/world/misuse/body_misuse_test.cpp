// Misuse of soft bodies in every state: bad numbers, indices, settings, pointers.

#include "world/bodies/soft_body_impl.h"
#include "world/misuse/misuse.h"

namespace pliant::test {
namespace {

const btTransform kStill = btTransform::getIdentity();

btTransform scaledBy( btScalar factor )
{
	btTransform transform = kStill;
	transform.setBasis( transform.getBasis().scaled( btVector3( factor, factor, factor ) ) );
	return transform;
}

/// Calls `call` with invalid transforms, and with ones that lead too far away.
template <class Call>
Answers forBadTransforms( const Call& call )
{
	btTransform sheared = kStill, unknown = kStill;
	sheared.getBasis()[0][1] = btScalar( 0.5 );
	unknown.getBasis()[1][1] = kNan;
	return { call( at( kNan, 0, 0 ) ), call( at( 0, kInf, 0 ) ), call( at( 0, 0, btScalar( 2e9 ) ) ), call( scaledBy( 2 ) ),
		call( scaledBy( -1 ) ), call( sheared ), call( unknown ) };
}

Status madeWith( Scene& s, const Material& material, const Adaptivity& adaptivity = {}, const StiffnessField& field = {} )
{
	const auto shape = s.other->impl().bodyTemplate;
	return SoftBody::create( shape, kStill, material, adaptivity, field ).status;
}

const Misuse kMade[] = {
	{ "SoftBody::create", kBad,
		[]( Scene& s ) {
			const auto shape = s.other->impl().bodyTemplate;
			Answers all = forBadTransforms( [&]( const btTransform& bad ) { return SoftBody::create( shape, bad ).status; } );
			all.push_back( SoftBody::create( nullptr, kStill ).status );
			return all;
		} },
	{ "SoftBody::create", kBad,
		[]( Scene& s ) {
			StiffnessField none, unknown;
			none.fraction = []( const float*, void* ) { return 0.0f; };
			unknown.fraction = []( const float*, void* ) { return std::nanf( "" ); };
			return Answers{ madeWith( s, {}, {}, none ), madeWith( s, {}, {}, unknown ) };
		},
		"StiffnessField" },
	{ "SoftBody::create", ResultCode::BadMaterial,
		[]( Scene& s ) {
			return Answers{ madeWith( s, changed( Material{}, &Material::density, 0.0f ) ),
				madeWith( s, changed( Material{}, &Material::beta, 2.0f ) ) };
		},
		"Material::" },
	{ "SoftBody::create", ResultCode::BadSettings,
		[]( Scene& s ) {
			const Adaptivity coarse = changed( Adaptivity{}, &Adaptivity::coarseLevels, 1 );
			return Answers{ madeWith( s, {}, changed( Adaptivity{}, &Adaptivity::coarseLevels, 9 ) ),
				madeWith( s, changed( Material{}, &Material::method, Method::SingleCluster ), coarse ),
				madeWith( s, changed( Material{}, &Material::farLevels, 1 ), coarse ) };
		},
		"Adaptivity" },
	{ "SoftBody::upcast", ResultCode::Ok,
		[]( Scene& s ) {
			return Answers{ answers( SoftBody::upcast( static_cast<btCollisionObject*>( nullptr ) ) == nullptr ),
				answers( SoftBody::upcast( static_cast<btCollisionObject*>( s.box ) ) == nullptr ) };
		} },
	{ "SoftBody::upcast", ResultCode::Ok,
		[]( Scene& s ) {
			return Answers{ answers( SoftBody::upcast( static_cast<const btCollisionObject*>( nullptr ) ) == nullptr ),
				answers( SoftBody::upcast( static_cast<const btCollisionObject*>( s.loose.get() ) ) == nullptr ) };
		} },
};

#ifdef NDEBUG // with assertions these abort the program
const Misuse kNodes[] = {
	{ "SoftBody::nodePosition", ResultCode::Ok,
		[]( Scene& s ) {
			return forBadIndices( s.body->nodeCount(), [&]( int i ) { return answers( s.body->nodePosition( i ).isZero() ); } );
		} },
	{ "SoftBody::nodeVelocity", ResultCode::Ok,
		[]( Scene& s ) {
			return forBadIndices( s.body->nodeCount(), [&]( int i ) { return answers( s.body->nodeVelocity( i ).isZero() ); } );
		} },
	{ "SoftBody::nodeMass", ResultCode::Ok,
		[]( Scene& s ) { return forBadIndices( s.body->nodeCount(), [&]( int i ) { return answers( s.body->nodeMass( i ) == 0 ); } ); } },
	{ "SoftBody::nodeRadius", ResultCode::Ok,
		[]( Scene& s ) { return forBadIndices( s.body->nodeCount(), [&]( int i ) { return answers( s.body->nodeRadius( i ) == 0 ); } ); } },
	{ "SoftBody::nodeLevel", ResultCode::Ok,
		[]( Scene& s ) { return forBadIndices( s.body->nodeCount(), [&]( int i ) { return answers( s.body->nodeLevel( i ) == 0 ); } ); } },
};
#endif

const Misuse kIndices[] = {
	{ "SoftBody::nodeOfShapeIndex", ResultCode::Ok,
		[]( Scene& s ) { return forBadIndices( 1 << 20, [&]( int i ) { return answers( s.body->nodeOfShapeIndex( i ) == -1 ); } ); } },
	{ "SoftBody::nodeOfCell", ResultCode::Ok,
		[]( Scene& s ) { return forBadIndices( 64, [&]( int i ) { return answers( s.body->nodeOfCell( i ) == -1 ); } ); } },
	{ "SoftBody::cellOfNode", ResultCode::Ok,
		[]( Scene& s ) {
			return forBadIndices( s.body->nodeCount(), [&]( int i ) { return answers( s.body->cellOfNode( i ) == -1 ); } );
		} },
	{ "SoftBody::nearestNode", ResultCode::Ok,
		[]( Scene& s ) { return forBadVectors( [&]( const btVector3& v ) { return answers( s.body->nearestNode( v ) == 0 ); } ); } },
	{ "SoftBody::isPinned", ResultCode::Ok,
		[]( Scene& s ) { return forBadIndices( s.body->nodeCount(), [&]( int i ) { return answers( !s.body->isPinned( i ) ); } ); } },
	{ "SoftBody::gasPressure", ResultCode::Ok,
		[]( Scene& s ) { return forBadIndices( 0, [&]( int i ) { return answers( s.body->gasPressure( i ) == 0 ); } ); } },
	{ "SoftBody::gasVolume", ResultCode::Ok,
		[]( Scene& s ) { return forBadIndices( 0, [&]( int i ) { return answers( s.body->gasVolume( i ) == 0 ); } ); } },
};

const Misuse kSet[] = {
	{ "SoftBody::setMaterial", ResultCode::BadMaterial,
		[]( Scene& s ) {
			return Answers{ s.body->setMaterial( changed( Material{}, &Material::density, std::nanf( "" ) ) ),
				s.body->setMaterial( changed( Material{}, &Material::youngsModulus, -1.0f ) ),
				s.body->setMaterial( changed( Material{}, &Material::regionHalfWidth, 9 ) ),
				s.body->setMaterial( changed( Material{}, &Material::method, Method( 7 ) ) ),
				s.body->setMaterial( changed( Material{}, &Material::elasticity, Elasticity( -1 ) ) ) };
		},
		"Material::" },
	{ "SoftBody::setFracture", ResultCode::BadSettings,
		[]( Scene& s ) {
			return Answers{ s.body->setFracture( changed( Fracture{}, &Fracture::breakStrain, std::nanf( "" ) ) ),
				s.body->setFracture( changed( Fracture{}, &Fracture::maxPieces, 0 ) ),
				s.body->setFracture( changed( Fracture{}, &Fracture::rule, BreakRule( 9 ) ) ),
				s.body->setFracture( changed( Fracture{}, &Fracture::smallPieces, SmallPieces( 9 ) ) ) };
		},
		"Fracture::" },
	{ "SoftBody::setFracture", kBad,
		[]( Scene& s ) {
			const Fracture brittle = changed( Fracture{}, &Fracture::rule, BreakRule::Distance );
			ToughnessField none, unknown;
			none.fraction = []( const float*, const float*, void* ) { return 0.0f; };
			unknown.fraction = []( const float*, const float*, void* ) { return std::nanf( "" ); };
			return Answers{ s.body->setFracture( brittle, none ), s.body->setFracture( brittle, unknown ) };
		},
		"ToughnessField" },
	{ "SoftBody::setFracture", kBad,
		[]( Scene& s ) {
			const Fracture shards = changed( Fracture{}, &Fracture::rule, BreakRule::Shards );
			const float unknown[6] = { 0, 0, 0, std::nanf( "" ), 0, 0 }, good[6] = { 0, 0, 0, 1, 0, 0 };
			const int negative[2] = { 0, -1 };
			return Answers{ s.body->setFracture( shards, {}, { unknown, 2, nullptr } ),
				s.body->setFracture( shards, {}, { good, 1, nullptr } ), s.body->setFracture( shards, {}, { good, -2, nullptr } ),
				s.body->setFracture( shards, {}, { nullptr, 2, nullptr } ), s.body->setFracture( shards, {}, { good, 2, negative } ) };
		},
		"ShardCentres" },
	{ "SoftBody::setGas", ResultCode::BadSettings,
		[]( Scene& s ) {
			return Answers{ s.body->setGas( Gas{ GasLaw::Constant, kNan, 1 } ),
				s.body->setGas( Gas{ GasLaw::Constant, btScalar( 2e9 ), 1 } ), s.body->setGas( Gas{ GasLaw::Ideal, 1, -1 } ),
				s.body->setGas( Gas{ GasLaw::Ideal, -2, 1 } ), s.body->setGas( Gas{ GasLaw( 7 ), 1, 1 } ),
				s.body->setGas( Gas{ GasLaw::None, kNan, 1 } ) };
		} },
	{ "SoftBody::setGas", kBad,
		[]( Scene& s ) {
			return Answers{ s.body->setGas( Gas{ GasLaw::Constant, 1, 1 } ) };
		} }, // not hollow
	{ "SoftBody::setScale", kBad,
		[]( Scene& s ) {
			return Answers{ s.body->setScale( 0 ), s.body->setScale( -1 ), s.body->setScale( btScalar( 1001 ) ), s.body->setScale( kNan ),
				s.body->setScale( kInf ) };
		} },
	{ "SoftBody::setSurfaceTolerance", ResultCode::Ok,
		[]( Scene& s ) {
			Answers all;
			for ( const btScalar bad : { kNan, btScalar( -1 ), -kInf, kInf } )
			{
				s.body->setSurfaceTolerance( bad ); // counts as 0, which it is in the scene
				all.push_back( answers( s.body->surfaceTolerance() == 0 ) );
			}
			return all;
		} },
	{ "SoftBody::requestRefinement", ResultCode::Ok,
		[]( Scene& s ) {
			return forBadVectors( [&]( const btVector3& v ) {
				s.body->requestRefinement( v, btVector3( 9, 9, 9 ) );
				s.body->requestRefinement( btVector3( -9, -9, -9 ), v );
				s.body->requestRefinement( btVector3( 9, 9, 9 ), btVector3( -9, -9, -9 ) ); // corners in the wrong order
				return answers( true );
			} );
		} },
	{ "SoftBody::setFinestLevel", ResultCode::Ok,
		[]( Scene& s ) {
			s.body->setFinestLevel( INT_MIN );
			return Answers{ answers( s.body->finestLevel() == 0 ) };
		} },
};

const Misuse kCuts[] = {
	{ "SoftBody::cutPlane", ResultCode::Ok,
		[]( Scene& s ) {
			const btVector3 middle = s.body->massCentre(), up( 0, 1, 0 );
			Answers all = forBadVectors(
				[&]( const btVector3& v ) { return answers( s.body->cutPlane( v, up ) + s.body->cutPlane( middle, v ) == 0 ); } );
			for ( const btScalar radius : { kNan, btScalar( 0 ), btScalar( -1 ), -kInf } )
			{
				all.push_back( answers( s.body->cutPlane( middle, up, radius ) == 0 ) );
			}
			all.push_back( answers( s.body->cutPlane( middle, btVector3( 0, 0, 0 ) ) == 0 ) );
			return all;
		} },
	{ "SoftBody::cutSphere", ResultCode::Ok,
		[]( Scene& s ) {
			Answers all = forBadVectors( [&]( const btVector3& v ) { return answers( s.body->cutSphere( v, 1 ) == 0 ); } );
			for ( const btScalar radius : { kNan, kInf, btScalar( 0 ), btScalar( -0.1 ) } )
			{
				all.push_back( answers( s.body->cutSphere( s.body->massCentre(), radius ) == 0 ) );
			}
			return all;
		} },
	{ "SoftBody::cutSweep", ResultCode::Ok,
		[]( Scene& s ) {
			const btVector3 good = s.body->massCentre();
			Answers all = forBadVectors( [&]( const btVector3& v ) {
				return answers( s.body->cutSweep( v, good, good, good ) + s.body->cutSweep( good, v, good, good ) +
						s.body->cutSweep( good, good, v, good ) + s.body->cutSweep( good, good, good, v ) ==
					0 );
			} );
			all.push_back( answers( s.body->cutSweep( good, good, good, good ) == 0 ) );
			return all;
		} },
	{ "SoftBody::heal", ResultCode::Ok,
		[]( Scene& s ) {
			return Answers{ answers( s.body->heal( kNan ) == 0 ), answers( s.body->heal( kInf ) == 0 ),
				answers( s.body->heal( btScalar( -1 ) ) == 0 ), answers( s.body->heal( 0 ) == 0 ) };
		} },
};

const Misuse kMotion[] = {
	{ "SoftBody::setLinearVelocity", kBad,
		[]( Scene& s ) {
			Answers all = forBadVectors( [&]( const btVector3& v ) { return s.body->setLinearVelocity( v ); } );
			all.push_back( s.body->setLinearVelocity( btVector3( btScalar( 2e5 ), 0, 0 ) ) );
			return all;
		} },
	{ "SoftBody::setVelocities", kBad,
		[]( Scene& s ) {
			const btVector3 zero( 0, 0, 0 );
			Answers all = forBadVectors( [&]( const btVector3& v ) { return s.body->setVelocities( v, zero ); } );
			for ( const Status& more : forBadVectors( [&]( const btVector3& v ) { return s.body->setVelocities( zero, v ); } ) )
			{
				all.push_back( more );
			}
			all.push_back( s.body->setVelocities( btVector3( btScalar( 2e5 ), 0, 0 ), zero ) );
			return all;
		} },
	{ "SoftBody::applyCentralForce", kBad,
		[]( Scene& s ) {
			Answers all = forBadVectors( [&]( const btVector3& v ) { return s.body->applyCentralForce( v ); } );
			all.push_back( s.body->applyCentralForce( btVector3( btScalar( 1e30 ), 0, 0 ) ) );
			return all;
		} },
	{ "SoftBody::applyForce", kBad,
		[]( Scene& s ) {
			Answers all = forBadVectors( [&]( const btVector3& v ) { return s.body->applyForce( v, 0 ); } );
			for ( const Status& more :
				forBadIndices( s.body->nodeCount(), [&]( int i ) { return s.body->applyForce( btVector3( 1, 0, 0 ), i ); } ) )
			{
				all.push_back( more );
			}
			all.push_back( s.body->applyForce( btVector3( btScalar( 1e30 ), 0, 0 ), 0 ) );
			return all;
		} },
	{ "SoftBody::applyCentralImpulse", kBad,
		[]( Scene& s ) { return forBadVectors( [&]( const btVector3& v ) { return s.body->applyCentralImpulse( v ); } ); } },
	{ "SoftBody::applyImpulse", kBad,
		[]( Scene& s ) {
			Answers all = forBadVectors( [&]( const btVector3& v ) { return s.body->applyImpulse( v, 0 ); } );
			for ( const Status& more :
				forBadIndices( s.body->nodeCount(), [&]( int i ) { return s.body->applyImpulse( btVector3( 1, 0, 0 ), i ); } ) )
			{
				all.push_back( more );
			}
			return all;
		} },
	{ "SoftBody::setGravity", kBad,
		[]( Scene& s ) {
			Answers all = forBadVectors( [&]( const btVector3& v ) { return s.body->setGravity( v ); } );
			all.push_back( s.body->setGravity( btVector3( 0, btScalar( 1e8 ), 0 ) ) );
			return all;
		} },
	{ "SoftBody::teleport", kBad,
		[]( Scene& s ) { return forBadTransforms( [&]( const btTransform& bad ) { return s.body->teleport( bad ); } ); } },
	{ "SoftBody::reset", kBad,
		[]( Scene& s ) { return forBadTransforms( [&]( const btTransform& bad ) { return s.body->reset( bad ); } ); } },
};

const Misuse kPins[] = {
	{ "SoftBody::pinNode", kBad,
		[]( Scene& s ) { return forBadIndices( s.body->nodeCount(), [&]( int i ) { return s.body->pinNode( i ); } ); } },
	{ "SoftBody::pinNodeToBody", kBad,
		[]( Scene& s ) {
			Answers all = forBadIndices( s.body->nodeCount(), [&]( int i ) { return s.body->pinNodeToBody( i, s.box ); } );
			all.push_back( s.body->pinNodeToBody( 0, nullptr ) );
			all.push_back( s.body->pinNodeToBody( 0, s.loose.get() ) );
			return all;
		} },
	{ "SoftBody::driveNode", kBad,
		[]( Scene& s ) {
			Answers all = forBadVectors( [&]( const btVector3& v ) { return s.body->driveNode( 0, v ); } );
			for ( const Status& more :
				forBadIndices( s.body->nodeCount(), [&]( int i ) { return s.body->driveNode( i, s.body->massCentre() ); } ) )
			{
				all.push_back( more );
			}
			all.push_back( s.body->driveNode( 0, btVector3( btScalar( 1e30 ), 0, 0 ) ) );
			return all;
		} },
	{ "SoftBody::releaseNode", ResultCode::Ok,
		[]( Scene& s ) {
			Answers all = forBadIndices( s.body->nodeCount(), [&]( int i ) {
				s.body->releaseNode( i );
				return answers( true );
			} );
			s.body->releaseNode( 7 ); // not pinned
			return all;
		} },
	{ "SoftBody::pinNodesInside", ResultCode::Ok,
		[]( Scene& s ) {
			const btVector3 low( -99, -99, -99 ), high( 99, 99, 99 );
			Answers all = forBadVectors( [&]( const btVector3& v ) {
				return answers( s.body->pinNodesInside( v, high ) + s.body->pinNodesInside( low, v ) == 0 );
			} );
			all.push_back( answers( s.body->pinNodesInside( btVector3( -kInf, -kInf, -kInf ), btVector3( kInf, kInf, kInf ) ) == 0 ) );
			all.push_back( answers( s.body->pinNodesInside( high, low ) == 0 ) );
			return all;
		} },
};

class MisuseOfBody : public testing::TestWithParam<BodyState>
{};

TEST_P( MisuseOfBody, IsRefusedAndChangesNothing )
{
	expectNothingChanges( GetParam(), kMade );
#ifdef NDEBUG
	expectNothingChanges( GetParam(), kNodes );
#endif
	expectNothingChanges( GetParam(), kIndices );
	expectNothingChanges( GetParam(), kSet );
	expectNothingChanges( GetParam(), kCuts );
	expectNothingChanges( GetParam(), kMotion );
	expectNothingChanges( GetParam(), kPins );
}

INSTANTIATE_TEST_SUITE_P( States, MisuseOfBody, testing::ValuesIn( kBodyStates ) );

} // namespace
} // namespace pliant::test
