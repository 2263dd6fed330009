// Grows and shrinks a body at run time.

#include "world/bodies/placing.h"
#include "world/bodies/soft_body_impl.h"
#include "world/game/constants.h"
#include "world/step/soft_body_system.h"

#include <new>
#include <numeric>

namespace pliant {

namespace {

Status checkScale( const SoftBody& body, btScalar scale )
{
	if ( Status status = body.impl().checkTime( "setScale" ); !status.ok() )
	{
		return status;
	}
	const SoftBody::Impl& impl = body.impl();
	if ( !( scale >= kSmallestBodyScale && scale <= kLargestBodyScale ) )
	{
		return refused( "setScale", "the scale must be within 0.001 to 1000." );
	}
	if ( impl.body->levels() || body.material().method != Method::Lattice || body.material().farLevels > 0 )
	{
		return refused( "setScale", "the body must have Method::Lattice, no levels of detail and no far levels." );
	}
	if ( impl.fractureVersion > 0 || impl.body->hasBrokenLinks() )
	{
		return refused( "setScale", "the body has broken." );
	}
	return {};
}

} // namespace

Status SoftBody::setScale( btScalar scale )
{
	if ( Status status = checkScale( *this, scale ); !status.ok() )
	{
		return status;
	}
	Impl& impl = *m_impl;
	if ( impl.rigidProxy )
	{
		impl.system->deform( *this ); // a body outside of a world deforms
		impl.system->removeContacts( *this );
	}
	const std::shared_ptr<const BodyTemplate> whole = impl.unscaled ? impl.unscaled : impl.bodyTemplate;
	const std::shared_ptr<const Lattice> before = impl.bodyTemplate->sharedLattice();
	Result<std::shared_ptr<const BodyTemplate>> made = whole->scaled( float( scale ) );
	if ( !made )
	{
		return made.status;
	}
	bool isScaled = false;
	try
	{
		impl.body->rescale( made.value->sharedLattice() );
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
		return Status{ ResultCode::OutOfMemory, "Not enough memory to scale the body." };
	}
	impl.system ? impl.system->equationsChanged( *this ) : void();
	for ( ContactProxy* proxy : impl.touched )
	{
		proxy->setCollisionShape( impl.shape->sphereOfNode( proxy->node ) );
	}
	impl.unscaled = whole;
	impl.bodyTemplate = std::move( made.value );
	impl.scale = scale;
	impl.crackFamily.reset(); // prepared for the previous size
	impl.crackView.reset();
	if ( impl.forces )
	{
		impl.forces->boundary = BodyBoundary{};
	}
	impl.skin.nodesChanged();
	hasMoved();
	return {};
}

btScalar SoftBody::scale() const
{
	return m_impl->scale;
}

} // namespace pliant
