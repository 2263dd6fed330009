#include "world/touch/touched_part.h"

#include "world/constants.h"
#include "world/shape/contact_proxy.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>

namespace pliant {

namespace {

/// The simple shape of index `left`, which is counted down; `at` becomes its transform. Null where there are fewer.
const btCollisionShape* findLeaf( const btCollisionShape& shape, int& left, btTransform& at )
{
	if ( !shape.isCompound() )
	{
		return left-- == 0 ? &shape : nullptr;
	}
	const btTransform whole = at;
	const auto& compound = static_cast<const btCompoundShape&>( shape );
	for ( int child = 0; child < compound.getNumChildShapes(); ++child )
	{
		at = whole * compound.getChildTransform( child );
		if ( const btCollisionShape* const found = findLeaf( *compound.getChildShape( child ), left, at ) )
		{
			return found;
		}
	}
	return nullptr;
}

struct FindTriangle : btTriangleCallback
{
	void processTriangle( btVector3* triangle, int triangleOfPart, int triangleIndex ) override
	{
		if ( triangleOfPart == part && triangleIndex == index )
		{
			found.init( triangle );
		}
	}

	struct Found
	{
		btVector3 corner[3];
		bool isAny = false;

		void init( const btVector3* triangle )
		{
			isAny = true;
			for ( int k = 0; k < 3; ++k )
			{
				corner[k] = triangle[k];
			}
		}
	} found;
	int part = 0, index = 0;
};

} // namespace

TouchedPart::TouchedPart( const btCollisionObject& object, int leaf, int part, int index, const btVector3& at ) :
	m_shape( object.getCollisionShape() ), m_transform( object.getWorldTransform() )
{
	if ( ownerOfContactProxy( &object ) )
	{
		return; // a proxy has only its node's sphere
	}
	btTransform ofLeaf = m_transform;
	if ( const btCollisionShape* const found = findLeaf( *m_shape, leaf, ofLeaf ) )
	{
		m_shape = found;
		m_transform = ofLeaf;
	}
	const int type = m_shape->getShapeType();
	if ( m_shape->isConcave() && type != STATIC_PLANE_PROXYTYPE && type != SDF_SHAPE_PROXYTYPE )
	{
		findTriangle( part, index, at );
	}
}

// Meshes and terrains produce their triangles on request for a box.
void TouchedPart::findTriangle( int part, int index, const btVector3& at )
{
	const btVector3 there = m_transform.invXform( at );
	btVector3 low, high;
	m_shape->getAabb( btTransform::getIdentity(), low, high );
	const btVector3 margin = ( ( high - low ) * kTriangleMargin ) +
		btVector3( m_shape->getMargin(), m_shape->getMargin(), m_shape->getMargin() );
	FindTriangle find;
	find.part = part;
	find.index = index;
	static_cast<const btConcaveShape*>( m_shape )->processAllTriangles( &find, there - margin, there + margin );
	if ( find.found.isAny )
	{
		m_triangle = btTriangleShape( find.found.corner[0], find.found.corner[1], find.found.corner[2] );
		m_triangle.setMargin( m_shape->getMargin() );
		m_shape = &m_triangle;
	}
}

} // namespace pliant
