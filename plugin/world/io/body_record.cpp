#include "world/io/body_record.h"

#include <algorithm>

namespace pliant {

void BodyRecord::StoredPin::archive( Archive& archive )
{
	archive( node, object, point, hasTarget );
	archive.choice( kind, PinKind::Driven );
}

BodyRecord BodyRecord::of( const SoftBody& body )
{
	const SoftBody::Impl& impl = body.impl();
	BodyRecord record;
	record.serial = impl.serial;
	record.isDrawn = impl.isDrawn();
	record.isRigid = impl.rigidProxy != nullptr;
	record.motion = ObjectState::of( body );
	record.settings = ObjectSettings::of( body );
	if ( const btBroadphaseProxy* const proxy = body.getBroadphaseHandle() )
	{
		record.group = proxy->m_collisionFilterGroup;
		record.mask = proxy->m_collisionFilterMask;
	}
	for ( const Pin& pin : impl.pins )
	{
		const PinKind kind = pin.kind;
		record.pins.push_back( StoredPin{ pin.node, pin.body ? pin.body->getWorldArrayIndex() : -1, kind, pin.point, pin.hasTarget } );
	}
	return record;
}

void BodyRecord::archive( Archive& archive )
{
	archive( serial, bodyTemplate, group, mask, family, cuts, isDrawn, isRigid, motion, settings, pins );
}

void BodyRecord::write( Archive& archive, const SoftBody& body, BodyRecord& record )
{
	auto& impl = const_cast<SoftBody::Impl&>( body.impl() ); // a description for both directions reads it only
	archive( record );
	const std::size_t make = archive.open();
	impl.archiveMake( archive );
	archive.close( make );
	const std::size_t rest = archive.open();
	impl.archiveState( archive );
	archive.close( rest );
}

namespace {

/// Whether a body is made from the data of this part: its state can then be read in place.
bool isMadeOf( SoftBody& body, const Archive& part )
{
	thread_local std::vector<std::byte> own;
	Archive writer( own );
	body.impl().archiveMake( writer );
	writer.finish();
	return own.size() == part.left() && std::equal( own.begin(), own.end(), part.data() );
}

} // namespace

void BodyRecord::read( Archive& archive, const std::vector<std::shared_ptr<const BodyTemplate>>& templates, SoftBody* live )
{
	archive( *this );
	Archive make = archive.part();
	state = archive.part();
	if ( !archive.require( bodyTemplate >= 0 && std::size_t( bodyTemplate ) < templates.size(), "A body has no template." ) )
	{
		return;
	}
	const std::shared_ptr<const BodyTemplate>& stored = templates[std::size_t( bodyTemplate )];
	const bool isSame = live && live->impl().bodyTemplate->fingerprint() == stored->fingerprint();
	const std::shared_ptr<const BodyTemplate> of = isSame ? live->impl().bodyTemplate : stored; // a body keeps its own
	if ( isSame && archive.isTrusted() && isMadeOf( *live, make ) )
	{
		return;
	}
	made = std::make_unique<SoftBody::Impl>();
	made->bodyTemplate = of;
	made->archiveMake( make );
	archive.require( make.isSound(), make.problem() );
	archive.require( !make.isSound() || make.left() == 0, "A body has more parts than it is made of." );
	if ( !archive.isSound() )
	{
		return;
	}
	made->archiveState( state );
	archive.require( state.isSound(), state.problem() );
	archive.require( !state.isSound() || state.left() == 0, "A body has more state than it needs." );
	archive.require(
		!archive.isSound() || isRigid == ( made->body->rigidState() != nullptr ), "A body's rigid state is not what it says." );
	const int count = archive.isSound() ? made->body->nodeCount() : 0;
	for ( const StoredPin& pin : pins )
	{
		archive.require( pin.node >= 0 && pin.node < count, "A pin holds a node that does not exist." );
	}
	archive.require( std::adjacent_find( pins.begin(), pins.end(),
						 []( const StoredPin& a, const StoredPin& b ) { return a.node >= b.node; } ) == pins.end(),
		"Pins are not in order." );
	made->wasDrawn = isDrawn;
}

void BodyRecord::applyTo( SoftBody& body )
{
	if ( made )
	{
		SoftBody::Impl::install( body, std::move( made ) );
	}
	else
	{
		body.impl().archiveState( state );
	}
	body.impl().followRigidState( body );
	settings.applyTo( body );
	body.setWorldTransform( motion.transform );
	body.setInterpolationWorldTransform( motion.interpolation );
	body.forceActivationState( motion.activation );
	body.setDeactivationTime( motion.deactivationTime );
	motion.applyTag( body );
	SoftBody::Impl& impl = body.impl();
	impl.block = impl.blockPart = -1;
	impl.contactSurface = ContactSurface();
	impl.previousShape.reset();
}

void checkCuts( Archive& archive, const std::vector<CutTrace>& cuts, std::uint32_t cells )
{
	for ( const CutTrace& cut : cuts )
	{
		archive.require( cut.link.a < cut.link.b && cut.link.b < cells, "A cut is of cells that do not exist." );
	}
}

} // namespace pliant
