// Reads the state of a world and checks it, without changing the world.

#include "world/io/world_snapshot.h"

#include "world/io/snapshot_format.h"

#include <algorithm>

namespace pliant {

void WorldSnapshot::read( Archive& archive, const LoadSettings& settings )
{
	m_movesRigid = settings.withRigidBodies;
	readTemplates( archive, settings );
	archive( m_entries, m_familySizes, m_cuts );
	if ( archive.isSound() )
	{
		findObjects( archive, settings );
	}
	if ( archive.isSound() )
	{
		readBodies( archive );
	}
	archive( m_touched, m_attachments, m_frames, m_values );
	m_group.archive( archive );
	m_broadphase.archive( archive, int( m_entries.size() ) );
	archive( m_ghosts, m_pairs );
	readManifolds( archive );
	archive.require( !archive.isSound() || archive.left() == 0, "The snapshot has more data than it needs." );
	if ( archive.isSound() )
	{
		checkReferences( archive );
	}
}

std::shared_ptr<const BodyTemplate> WorldSnapshot::templateOf( std::uint64_t fingerprint, const LoadSettings& settings ) const
{
	for ( const SoftBody* const body : m_bodies.bodies() )
	{
		if ( body->impl().bodyTemplate->fingerprint() == fingerprint )
		{
			return body->impl().bodyTemplate;
		}
	}
	const auto listed = std::find_if( settings.templates.begin(), settings.templates.end(),
		[fingerprint]( const std::shared_ptr<const BodyTemplate>& each ) { return each && each->fingerprint() == fingerprint; } );
	return listed == settings.templates.end() ? nullptr : *listed;
}

void WorldSnapshot::readTemplates( Archive& archive, const LoadSettings& settings )
{
	std::uint64_t count = 0;
	archive( count );
	for ( std::uint64_t k = 0; k < count && archive.isSound(); ++k )
	{
		std::uint64_t fingerprint = 0;
		bool isStored = false;
		archive( fingerprint, isStored );
		std::shared_ptr<const BodyTemplate> known = templateOf( fingerprint, settings );
		Archive part = isStored ? archive.part() : Archive( nullptr, std::size_t( 0 ) );
		if ( !known && isStored && archive.isSound() )
		{
			const std::shared_ptr<BodyTemplate> made = BodyTemplate::blank();
			made->archive( part );
			archive.require( part.isSound(), part.problem() );
			known = made;
		}
		archive.require( known != nullptr, "A template is neither stored in the snapshot nor listed in LoadSettings::templates." );
		m_templates.push_back( std::move( known ) );
	}
}

/// Finds the world's objects that are no soft bodies.
void WorldSnapshot::findObjects( Archive& archive, const LoadSettings& settings )
{
	std::vector<btCollisionObject*> others;
	const btCollisionObjectArray& objects = m_step.m_parts.objects;
	for ( int k = 0; k < objects.size(); ++k )
	{
		asSoftBody( objects[k] ) ? void() : others.push_back( objects[k] );
	}
	std::size_t found = 0;
	for ( Entry& entry : m_entries )
	{
		if ( entry.record >= 0 )
		{
			continue;
		}
		++found;
		const bool isIndex = entry.id >= 0 && std::size_t( entry.id ) < others.size();
		btCollisionObject* const object = settings.objectOf ? settings.objectOf( entry.id, settings.context )
			: isIndex                                       ? others[std::size_t( entry.id )]
															: nullptr;
		const auto place = std::find( others.begin(), others.end(), object );
		if ( !archive.require( object && place != others.end(), "The world lacks an object of the snapshot." ) )
		{
			return;
		}
		const btCollisionShape* const shape = object->getCollisionShape();
		archive.require( object->getInternalType() == entry.type && ( shape ? shape->getShapeType() : -1 ) == entry.shape,
			"An object of the world is of another kind than in the snapshot: give ids (SaveSettings::idOf)." );
		const bool isTaken = std::any_of(
			m_entries.begin(), m_entries.end(), [&]( const Entry& other ) { return &other != &entry && other.object == object; } );
		archive.require( !isTaken, "Two objects of the snapshot are the same object of the world." );
		entry.object = object;
	}
	archive.require( found == others.size(), "The world has an object that it did not have when it was saved." );
}

void WorldSnapshot::readBodies( Archive& archive )
{
	std::uint64_t count = 0;
	archive( count );
	archive.require( count <= m_entries.size(), "The snapshot has more bodies than objects." );
	std::vector<int> uses( archive.isSound() ? std::size_t( count ) : 0, 0 );
	for ( const Entry& entry : m_entries )
	{
		if ( entry.record >= 0 && archive.require( std::size_t( entry.record ) < uses.size(), "An object is a body that is not there." ) )
		{
			++uses[std::size_t( entry.record )];
		}
	}
	archive.require( std::all_of( uses.begin(), uses.end(), []( int n ) { return n == 1; } ), "A body is not an object of its own." );
	unsigned before = 0;
	for ( std::uint64_t k = 0; k < count && archive.isSound(); ++k )
	{
		// The serial comes first in a record: the body that has it now becomes the recorded one.
		Archive ahead = archive;
		unsigned serial = 0;
		ahead( serial );
		archive.require( serial > before, "Bodies are not in order." );
		before = serial;
		SoftBody* live = serial > 0 ? m_bodies.bodyAfter( serial - 1 ) : nullptr;
		live = live && live->impl().serial == serial ? live : nullptr;
		m_records.emplace_back();
		m_records.back().read( archive, m_templates, live );
		const bool isSame = archive.isSound() && live &&
			live->impl().bodyTemplate->fingerprint() == m_templates[std::size_t( m_records.back().bodyTemplate )]->fingerprint();
		m_live.push_back( isSame ? live : nullptr );
	}
}

bool WorldSnapshot::isBodyNode( int object, int node ) const
{
	if ( !isObject( object ) || !isSoft( object ) )
	{
		return false;
	}
	const auto record = std::size_t( m_entries[std::size_t( object )].record );
	const SoftBody::Impl* const made = m_records[record].made.get();
	return node >= 0 && node < ( made ? made->body->nodeCount() : m_live[record]->nodeCount() );
}

/// A body in its rigid state is touched as a rigid one.
bool WorldSnapshot::hasNodes( int object ) const
{
	return isSoft( object ) && !m_records[std::size_t( m_entries[std::size_t( object )].record )].isRigid;
}

void WorldSnapshot::readManifolds( Archive& archive )
{
	for ( const PairRecord& pair : m_pairs )
	{
		for ( int k = 0; k < pair.contacts && archive.isSound(); ++k )
		{
			m_contacts.emplace_back().archive( archive );
		}
	}
}

void WorldSnapshot::checkPair( Archive& archive, const PairRecord& pair ) const
{
	archive.require( pair.contacts >= 0, "A pair has a negative number of contacts." );
	archive.require( isObject( pair.first ) && isObject( pair.second ), "A pair has an object that is not there." );
	archive.require( pair.first != pair.second || pair.isSoft, "An object that is no soft body touches itself." );
	if ( !archive.isSound() || !pair.isSoft )
	{
		return;
	}
	const bool isSelf = pair.first == pair.second;
	const int soft = hasNodes( pair.first ) ? pair.first : pair.second, other = soft == pair.first ? pair.second : pair.first;
	archive.require( hasNodes( soft ) && std::size_t( pair.contacts ) == pair.soft.keys.size(), "A contact has no body." );
	for ( const std::uint64_t key : pair.soft.keys )
	{
		archive.require(
			isBodyNode( soft, int( key >> 32 ) ) && ( ( !isSelf && !hasNodes( other ) ) || isBodyNode( other, int( key & 0xffffffffu ) ) ),
			"A contact is of a node that does not exist." );
	}
	archive.require( std::adjacent_find( pair.soft.keys.begin(), pair.soft.keys.end(), std::greater_equal<>() ) == pair.soft.keys.end(),
		"Contacts are not in order." );
}

void WorldSnapshot::checkReferences( Archive& archive )
{
	archive.require(
		m_touched.size() == m_records.size() && std::all_of( m_familySizes.begin(), m_familySizes.end(), []( int n ) { return n > 0; } ),
		"The families of bodies are not valid." );
	for ( const BodyRecord& record : m_records )
	{
		archive.require( record.family >= -1 && record.family < int( m_familySizes.size() ) && record.cuts >= -1 &&
				record.cuts < int( m_cuts.size() ) && record.serial <= m_values.serials,
			"A body refers to a family that is not there." );
		if ( archive.isSound() && record.cuts >= 0 )
		{
			checkCuts( archive, m_cuts[std::size_t( record.cuts )],
				std::uint32_t( m_templates[std::size_t( record.bodyTemplate )]->cellCount() ) );
		}
		for ( const BodyRecord::StoredPin& pin : record.pins )
		{
			const bool follows = pin.kind == PinKind::FollowsBody;
			archive.require( !follows ||
					( isObject( pin.object ) && !isSoft( pin.object ) &&
						btRigidBody::upcast( m_entries[std::size_t( pin.object )].object ) ),
				"A pin follows an object that is no rigid body." );
		}
	}
	const auto isPoint = [this]( int object, const SharedNodes& nodes ) {
		bool isRight = nodes.count >= 1 && nodes.count <= SharedNodes::kMost;
		for ( int k = 0; isRight && k < nodes.count; ++k )
		{
			isRight = isBodyNode( object, nodes.node[k] );
		}
		return isRight;
	};
	int before = -1;
	for ( const AttachmentRecord& record : m_attachments )
	{
		const Attachment& attachment = record.attachment;
		const bool isRigid = record.second < 0;
		archive.require( attachment.id > before && attachment.id < m_values.nextAttachment &&
				isPoint( record.first, attachment.first.nodes ) &&
				( isRigid ? isObject( record.rigid ) && !isSoft( record.rigid ) : isPoint( record.second, attachment.second.nodes ) ),
			"An attachment holds something that is not there." );
		before = attachment.id;
	}
	for ( const std::vector<OutsideRecord>& outside : m_values.outside )
	{
		archive.require( std::all_of( outside.begin(), outside.end(), [this]( const OutsideRecord& o ) { return isObject( o.object ); } ),
			"An impulse acts on an object that is not there." );
	}
	checkFrames( archive );
	checkGhosts( archive );
	for ( const PairRecord& pair : m_pairs )
	{
		checkPair( archive, pair );
	}
}

} // namespace pliant
