#include "world/io/child_contacts.h"

#include "world/io/object_state.h"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btCompoundCompoundCollisionAlgorithm.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

namespace pliant {

namespace {

/// Has an algorithm make its manifolds, and takes no points.
class NoPoints : public btManifoldResult
{
public:
	using btManifoldResult::btManifoldResult;
	void addContactPoint( const btVector3&, const btVector3&, btScalar ) override {}
};

/// Bullet's algorithms for a compound and another object, by child; null: none.
class OneCompound : public btCompoundCollisionAlgorithm
{
public:
	static btAlignedObjectArray<btCollisionAlgorithm*>& children( btCompoundCollisionAlgorithm& of )
	{
		return of.*( &OneCompound::m_childCollisionAlgorithms );
	}
	static bool isSwapped( const btCompoundCollisionAlgorithm& of ) { return of.*( &OneCompound::m_isSwapped ); }
};

// Bullet gives no access to its algorithms for two compounds. An explicit instantiation may name a private member.
btHashedSimplePairCache*& pairsOf( btCompoundCompoundCollisionAlgorithm& of );
template <btHashedSimplePairCache* btCompoundCompoundCollisionAlgorithm::*Member>
struct TwoCompounds
{
	friend btHashedSimplePairCache*& pairsOf( btCompoundCompoundCollisionAlgorithm& of ) { return of.*Member; }
};
template struct TwoCompounds<&btCompoundCompoundCollisionAlgorithm::m_childCollisionAlgorithmCache>;

const btCompoundShape& compoundOf( const btCollisionObjectWrapper& of )
{
	return *static_cast<const btCompoundShape*>( of.getCollisionShape() );
}

/// An algorithm of each class, of compounds without children.
struct KnownAlgorithms
{
	btCompoundShape shape;
	btCollisionObject object;
	btCollisionObjectWrapper wrapped{ nullptr, &shape, &object, btTransform::getIdentity(), -1, -1 };
	btCompoundCollisionAlgorithm one{ btCollisionAlgorithmConstructionInfo( nullptr, 0 ), &wrapped, &wrapped, false };
	btCompoundCompoundCollisionAlgorithm two{ btCollisionAlgorithmConstructionInfo( nullptr, 0 ), &wrapped, &wrapped, false };

	static const KnownAlgorithms& all()
	{
		static const KnownAlgorithms known;
		return known;
	}
};

btCompoundCompoundCollisionAlgorithm* asTwoCompounds( btCollisionAlgorithm& algorithm )
{
	const bool isOne = isSameClass( algorithm, KnownAlgorithms::all().two );
	return isOne ? static_cast<btCompoundCompoundCollisionAlgorithm*>( &algorithm ) : nullptr;
}

btCompoundCollisionAlgorithm* asOneCompound( btCollisionAlgorithm& algorithm )
{
	const bool isOne = isSameClass( algorithm, KnownAlgorithms::all().one );
	return isOne ? static_cast<btCompoundCollisionAlgorithm*>( &algorithm ) : nullptr;
}

bool hasChild( const btCollisionObjectWrapper& object, int child )
{
	return object.getCollisionShape()->isCompound() && child >= 0 && child < compoundOf( object ).getNumChildShapes();
}

btCollisionObjectWrapper childOf( const btCollisionObjectWrapper& object, int child )
{
	const btCompoundShape& compound = compoundOf( object );
	return btCollisionObjectWrapper( &object, compound.getChildShape( child ), object.getCollisionObject(),
		object.getWorldTransform() * compound.getChildTransform( child ), -1, child );
}

} // namespace

WrappedPair::WrappedPair( const btCollisionObject& a, const btCollisionObject& b ) :
	first( nullptr, a.getCollisionShape(), &a, a.getWorldTransform(), -1, -1 ),
	second( nullptr, b.getCollisionShape(), &b, b.getWorldTransform(), -1, -1 )
{}

std::vector<ChildPair> childrenOf( btCollisionAlgorithm& algorithm )
{
	std::vector<ChildPair> children;
	if ( auto* const two = asTwoCompounds( algorithm ) )
	{
		const btSimplePairArray& pairs = pairsOf( *two )->getOverlappingPairArray();
		for ( int k = 0; k < pairs.size(); ++k )
		{
			children.push_back( ChildPair{ pairs[k].m_indexA, pairs[k].m_indexB } );
		}
	}
	else if ( auto* const one = asOneCompound( algorithm ) )
	{
		const btAlignedObjectArray<btCollisionAlgorithm*>& algorithms = OneCompound::children( *one );
		for ( int k = 0; k < algorithms.size(); ++k )
		{
			algorithms[k] ? children.push_back( ChildPair{ k, -1 } ) : void();
		}
	}
	return children;
}

void makeManifolds( btCollisionAlgorithm& algorithm, const std::vector<ChildPair>& children, const WrappedPair& pair,
	btDispatcher& dispatcher, const btDispatcherInfo& info )
{
	const auto processChild = [&]( btCollisionAlgorithm& child, const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b ) {
		NoPoints result( &a, &b );
		child.processCollision( &a, &b, info, &result );
	};
	if ( auto* const two = asTwoCompounds( algorithm ) )
	{
		for ( const ChildPair& child : children )
		{
			if ( hasChild( pair.first, child.first ) && hasChild( pair.second, child.second ) &&
				!pairsOf( *two )->findPair( child.first, child.second ) )
			{
				const btCollisionObjectWrapper a = childOf( pair.first, child.first ), b = childOf( pair.second, child.second );
				btCollisionAlgorithm* const made = dispatcher.findAlgorithm( &a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS );
				pairsOf( *two )->addOverlappingPair( child.first, child.second )->m_userPointer = made;
				processChild( *made, a, b );
			}
		}
	}
	else if ( auto* const one = asOneCompound( algorithm ) )
	{
		btAlignedObjectArray<btCollisionAlgorithm*>& algorithms = OneCompound::children( *one );
		const bool isSwapped = OneCompound::isSwapped( *one );
		const btCollisionObjectWrapper &compound = isSwapped ? pair.second : pair.first, &other = isSwapped ? pair.first : pair.second;
		for ( const ChildPair& child : children )
		{
			if ( hasChild( compound, child.first ) && child.first < algorithms.size() )
			{
				const btCollisionObjectWrapper own = childOf( compound, child.first );
				btCollisionAlgorithm*& made = algorithms[child.first];
				made = made ? made : dispatcher.findAlgorithm( &own, &other, nullptr, BT_CONTACT_POINT_ALGORITHMS );
				processChild( *made, own, other );
			}
		}
	}
	else
	{
		processChild( algorithm, pair.first, pair.second );
	}
}

} // namespace pliant
