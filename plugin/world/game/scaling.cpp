// Grows and shrinks a body at run time.

#include "lattice/attempt.h"
#include "world/bodies/placing.h"
#include "world/bodies/soft_body_impl.h"
#include "world/game/constants.h"
#include "world/step/soft_body_system.h"

#include <new>
#include <numeric>

namespace pliant {

namespace {

void checkScale( const SoftBody& body, btScalar scale )
{
	insist( body.impl().checkTime( "setScale" ) );
	const SoftBody::Impl& impl = body.impl();
	rejectIf( !( scale >= kSmallestBodyScale && scale <= kLargestBodyScale ), "setScale", "the scale must be within 0.001 to 1000." );
	rejectIf( impl.body->levels() || body.material().method != Method::Lattice || body.material().farLevels > 0, "setScale",
		"the body must have Method::Lattice, no levels of detail and no far levels." );
	rejectIf( impl.fractureVersion > 0 || impl.body->hasBrokenLinks(), "setScale", "the body has broken." );
}

} // namespace

Status SoftBody::setScale( btScalar scale )
{
	return attempt( [&]() {
		checkScale( *this, scale );
		Impl& impl = *m_impl;
		if ( impl.rigidProxy )
		{
			impl.system->deform( *this ); // a body outside of a world deforms
			impl.system->removeContacts( *this );
		}
		const std::shared_ptr<const BodyTemplate> whole = impl.unscaled ? impl.unscaled : impl.bodyTemplate;
		const std::shared_ptr<const Lattice> before = impl.bodyTemplate->sharedLattice();
		const std::shared_ptr<const BodyTemplate> made = insist( whole->scaled( float( scale ) ) );
		bool isScaled = false;
		try
		{
			impl.body->rescale( made->sharedLattice() );
			isScaled = true;
			const int count = nodeCount();
			std::vector<std::uint32_t> same( static_cast<std::size_t>( count ) );
			std::iota( same.begin(), same.end(), 0u );
			auto shape = std::make_unique<NodeShape>( *impl.body );
			auto self = impl.self ? std::make_unique<SelfCollision>() : nullptr;
			ContactProxyPool::renumber( *this, same, count ); // contacts read the nodes again
			impl.self = std::move( self );
			impl.previousShape = std::move( impl.shape );
			impl.shape = std::move( shape );
		}
		catch ( const std::bad_alloc& )
		{
			if ( isScaled )
			{
				impl.body->rescale( before );
			}
			reject( ResultCode::OutOfMemory, "Not enough memory to scale the body." );
		}
		impl.system ? impl.system->equationsChanged( *this ) : void();
		for ( ContactProxy* proxy : impl.touched )
		{
			proxy->setCollisionShape( impl.shape->sphereOfNode( proxy->node ) );
		}
		impl.unscaled = whole;
		impl.bodyTemplate = made;
		impl.scale = scale;
		impl.crackFamily.reset(); // prepared for the previous size
		impl.crackView.reset();
		if ( impl.forces )
		{
			impl.forces->boundary = BodyBoundary{};
		}
		impl.skin.nodesChanged();
		hasMoved();
	} );
}

btScalar SoftBody::scale() const
{
	return m_impl->scale;
}

} // namespace pliant
