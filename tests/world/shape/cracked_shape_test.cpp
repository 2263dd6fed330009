// The spheres of a cracking body: its shape is kept unless many nodes leave it, and equals a newly built one.

#include "support/explicit_material.h"
#include "world/test_world.h"

#include "support/block_lattice.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/shape/node_shape.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

void expectSpheresOfANewOne( const SoftBody& soft )
{
	NodeShape& now = *soft.impl().shape;
	now.freshen();
	const NodeShape fresh( *soft.impl().body );
	ASSERT_EQ( now.getNumChildShapes(), fresh.getNumChildShapes() );
	for ( int node = 0; node < soft.nodeCount(); ++node )
	{
		EXPECT_EQ( now.childOfNode( node ) >= 0, fresh.childOfNode( node ) >= 0 );
		EXPECT_EQ( now.sphereOfNode( node )->getRadius(), fresh.sphereOfNode( node )->getRadius() );
	}
	for ( int child = 0; child < now.getNumChildShapes(); ++child )
	{
		const btDbvtNode* const leaf = now.getChildList()[child].m_node;
		EXPECT_EQ( leaf->dataAsInt, child );
		EXPECT_EQ( now.getChildList()[child].m_childShape, now.sphereOfNode( now.nodeOfChild( child ) ) );
		const btVector3 positions = soft.nodePosition( now.nodeOfChild( child ) ) - soft.getWorldTransform().getOrigin();
		EXPECT_LT( positions.distance( now.getChildList()[child].m_transform.getOrigin() ), btScalar( 1e-4 ) );
		EXPECT_TRUE( now.tree().m_root->volume.Contain( leaf->volume ) );
	}
	std::vector<int> inRows( std::size_t( soft.nodeCount() ), 0 );
	now.rows().visitPositions( 0, now.rows().count(), [&]( int node, const btVector3& position ) {
		++inRows[std::size_t( node )];
		EXPECT_LT( position.distance( soft.nodePosition( node ) - soft.getWorldTransform().getOrigin() ), btScalar( 1e-4 ) );
	} );
	for ( int node = 0; node < soft.nodeCount(); ++node )
	{
		EXPECT_EQ( inRows[std::size_t( node )], now.childOfNode( node ) >= 0 ? 1 : 0 );
	}
}

// r = ( d / 2 ) cbrt( fill ) to half a radius step, for runs of equal cells and for single ones.
TEST( NodeSpheres, GrowWithTheFillOfTheirCells )
{
	auto lattice = std::make_shared<Lattice>( makeBlockLattice( 6, 4, 3, 0.1f ) );
	for ( std::size_t i = 0; i < lattice->fill.size(); ++i )
	{
		lattice->fill[i] = i < 30 ? 1.0f : 0.25f * float( 1 + i / 2 % 3 );
	}
	const std::unique_ptr<Body> body = std::move( Body::create( lattice, test::explicitMaterial(), {} ).value );
	const NodeShape shape( *body );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		const double wanted = 0.05 * std::cbrt( double( lattice->fill[std::size_t( i )] ) );
		EXPECT_NEAR( std::log2( double( shape.sphereOfNode( i )->getRadius() ) / wanted ), 0.0, 0.501 / kRadiusStepsPerOctave ) << i;
	}
}

/// A cube in free flight, of finest nodes throughout.
class CrackedShape : public testing::TestWithParam<int>
{
protected:
	CrackedShape()
	{
		test.world.setGravity( btVector3( 0, 0, 0 ) );
		Adaptivity levels;
		levels.coarseLevels = GetParam();
		levels.mergeDelay = 60.0f;
		soft = test.addSoft( block( 9, 9, 9, 0.1f ), at( 0, 2, 0 ), test::stiff( 1e5f ), levels );
		soft->requestRefinement( btVector3( -1, 1, -1 ), btVector3( 1, 3, 1 ) );
		test.run( 4 );
	}

	TestWorld test;
	SoftBody* soft;
};

/// On one level, and on three: nodes with a cell within as many links of the surface as the node is cells wide.
TEST_P( CrackedShape, HasSpheresAtTheSurfaceAndOneLayerBelow )
{
	for ( int k = 0; k < 2; ++k )
	{
		soft->requestRefinement( btVector3( -1, 1, -1 ), btVector3( 0, 3, 1 ) ); // the rest remains as it is
		test.run( 2 );
	}
	const Body& body = *soft->impl().body;
	std::vector<int> layer( std::size_t( body.nodeCount() ), 9 );
	for ( int cell = 0; cell < body.lattice().cellCount(); ++cell )
	{
		const Eigen::Vector3i at = body.lattice().coordinate[std::size_t( cell )].cast<int>();
		int& own = layer[std::size_t( body.nodeOfCell( std::uint32_t( cell ) ) )];
		own = std::min( { own, at.minCoeff(), 8 - at.maxCoeff() } );
	}
	for ( int node = 0; node < body.nodeCount(); ++node )
	{
		EXPECT_EQ( soft->impl().shape->childOfNode( node ) >= 0, layer[std::size_t( node )] <= 1 << soft->nodeLevel( node ) );
	}
}

TEST_P( CrackedShape, EqualsANewShape )
{
	int kept = 0, added = 0;
	for ( int cut = 0; cut < 12; ++cut )
	{
		const NodeShape* const before = soft->impl().shape.get();
		const int spheres = before->getNumChildShapes();
		// The disc of a cut that ends inside: the body stays connected.
		const btVector3 middle( btScalar( 0.07 * ( cut - 6 ) ), btScalar( 2 + 0.02 * cut ), 0 ),
			normal( 1, btScalar( 0.3 ), btScalar( 0.1 * cut ) );
		ASSERT_GT( soft->cutPlane( middle, normal, btScalar( 0.16 ) ), 0 );
		test.run( 1 );
		ASSERT_EQ( test.world.softBodyCount(), 1 );
		const NodeShape& now = *soft->impl().shape;
		kept += &now == before ? 1 : 0;
		added += now.getNumChildShapes() - spheres;
		expectSpheresOfANewOne( *soft );
	}
	std::printf( "kept %d of 12 times, %d spheres came to it\n", kept, added );
	EXPECT_GT( kept, 4 );
	EXPECT_GT( added, 20 );
}

// Corners are cut off one after the other, then half of the rest.
TEST_P( CrackedShape, DropsNodesThatLeave )
{
	int kept = 0;
	for ( int corner = 0; corner < 8; ++corner )
	{
		const NodeShape* const before = soft->impl().shape.get();
		const btVector3 direction( btScalar( corner & 1 ? 1 : -1 ), btScalar( corner & 2 ? 1 : -1 ), btScalar( corner & 4 ? 1 : -1 ) );
		ASSERT_GT( soft->cutPlane( btVector3( 0, 2, 0 ) + btScalar( 0.33 ) * direction, direction ), 0 );
		test.run( 1 );
		ASSERT_EQ( test.world.softBodyCount(), corner + 2 );
		kept += soft->impl().shape.get() == before ? 1 : 0;
		expectSpheresOfANewOne( *soft );
	}
	EXPECT_GT( kept, 4 );
	const NodeShape* const before = soft->impl().shape.get();
	ASSERT_GT( soft->cutPlane( btVector3( 0, 2, 0 ), btVector3( 1, 0, 0 ) ), 0 );
	test.run( 1 );
	EXPECT_NE( soft->impl().shape.get(), before );
	expectSpheresOfANewOne( *soft );
}

INSTANTIATE_TEST_SUITE_P( Levels, CrackedShape, testing::Values( 0, 2 ) );

} // namespace
} // namespace pliant
