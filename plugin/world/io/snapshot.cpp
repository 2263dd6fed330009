#include "pliant/io/snapshot.h"

#include "lattice/attempt.h"
#include "lattice/features.h"
#include "world/bodies/placing.h"
#include "world/io/snapshot_format.h"
#include "world/io/world_snapshot.h"

#include <algorithm>

namespace pliant {

namespace {

Status checkIds( const SoftBodyHost& world, const SaveSettings& settings )
{
	std::vector<std::int64_t> ids;
	const btCollisionObjectArray& objects = world.bulletWorld().getCollisionObjectArray();
	for ( int k = 0; settings.idOf && k < objects.size(); ++k )
	{
		if ( !SoftBody::upcast( objects[k] ) )
		{
			ids.push_back( settings.idOf( *objects[k], settings.context ) );
		}
	}
	std::sort( ids.begin(), ids.end() );
	const bool areDifferent = std::adjacent_find( ids.begin(), ids.end() ) == ids.end();
	return areDifferent ? Status{} : Status{ ResultCode::BadArgument, "SaveSettings::idOf: two objects of the world have the same id." };
}

} // namespace

Result<std::vector<std::byte>> saveTemplate( const BodyTemplate& bodyTemplate )
{
	Result<std::vector<std::byte>> result;
	result.status = withinMemory( "Not enough memory to save a template.", [&]() {
		Archive archive = beginSnapshot( result.value );
		archive.write( bodyTemplate );
		archive.finish();
		endSnapshot( result.value, SnapshotKind::Template );
		return Status{};
	} );
	return result;
}

Result<std::shared_ptr<const BodyTemplate>> loadTemplate( BytesView bytes )
{
	Result<std::shared_ptr<const BodyTemplate>> result;
	result.status = withinMemory( "Not enough memory to load a template.", [&]() {
		Archive archive = openSnapshot( bytes, SnapshotKind::Template );
		const std::shared_ptr<BodyTemplate> made = BodyTemplate::blank();
		if ( archive.isSound() )
		{
			archive( *made );
		}
		if ( !archive.isSound() || archive.left() > 0 )
		{
			return refusalOf( archive );
		}
		insist( made->vertexCount() > 0 ? requireFeature( Feature::Surface ) : Status{} );
		result.value = made;
		return Status{};
	} );
	return result;
}

Result<std::vector<std::byte>> saveBody( const SoftBody& body, const SaveSettings& settings )
{
	Result<std::vector<std::byte>> result;
	result.status = withinMemory( "Not enough memory to save a body.", [&]() {
		Archive archive = beginSnapshot( result.value );
		const BodyTemplate& of = body.bodyTemplate();
		std::uint64_t fingerprint = of.fingerprint();
		bool isStored = settings.withTemplates;
		archive( fingerprint, isStored );
		if ( isStored )
		{
			archive.write( of );
		}
		std::vector<CutTrace> cuts = body.impl().cuts ? *body.impl().cuts : std::vector<CutTrace>();
		archive( cuts );
		BodyRecord record = BodyRecord::of( body );
		for ( BodyRecord::StoredPin& pin : record.pins )
		{
			const bool follows = pin.kind == PinKind::FollowsBody;
			pin.kind = follows ? PinKind::Still : pin.kind;
			pin.object = -1;
		}
		BodyRecord::write( archive, body, record );
		archive.finish();
		endSnapshot( result.value, SnapshotKind::Body );
		return Status{};
	} );
	return result;
}

namespace {

Status readBody( BytesView bytes, const LoadSettings& settings, std::unique_ptr<SoftBody>& body )
{
	Archive archive = openSnapshot( bytes, SnapshotKind::Body );
	std::uint64_t fingerprint = 0;
	bool isStored = false;
	archive( fingerprint, isStored );
	std::vector<std::shared_ptr<const BodyTemplate>> templates;
	for ( const std::shared_ptr<const BodyTemplate>& each : settings.templates )
	{
		each && each->fingerprint() == fingerprint ? templates.assign( 1, each ) : void();
	}
	if ( isStored && archive.isSound() )
	{
		const std::shared_ptr<BodyTemplate> made = BodyTemplate::blank();
		archive( *made );
		templates.empty() ? templates.push_back( made ) : void();
	}
	archive.require( !templates.empty(), "The template is neither stored in the snapshot nor listed in LoadSettings::templates." );
	std::vector<CutTrace> cuts;
	archive( cuts );
	BodyRecord record;
	if ( archive.isSound() )
	{
		record.read( archive, templates, nullptr );
	}
	const auto cells = archive.isSound() ? std::uint32_t( templates[0]->cellCount() ) : 0u;
	checkCuts( archive, cuts, cells );
	for ( const BodyRecord::StoredPin& pin : record.pins )
	{
		archive.require( pin.kind != PinKind::FollowsBody, "A pin of a single body follows an object." );
	}
	if ( !archive.isSound() || archive.left() > 0 )
	{
		return refusalOf( archive );
	}
	body = SoftBody::Impl::blank();
	record.applyTo( *body );
	SoftBody::Impl& impl = body->impl();
	impl.separatedPairs.clear(); // of a world's bodies
	impl.cuts = cuts.empty() ? nullptr : std::make_shared<std::vector<CutTrace>>( std::move( cuts ) );
	for ( const BodyRecord::StoredPin& pin : record.pins )
	{
		impl.pins.push_back( Pin{ pin.node, pin.kind, nullptr, -1, -1, pin.point, pin.hasTarget } );
	}
	return {};
}

} // namespace

SoftBodyResult loadBody( BytesView bytes, const LoadSettings& settings )
{
	SoftBodyResult result;
	result.status = withinMemory( "Not enough memory to load a body.", [&]() { return readBody( bytes, settings, result.value ); } );
	return result;
}

Status saveWorld( const SoftBodyHost& world, std::vector<std::byte>& bytes, const SaveSettings& settings )
{
	return withinMemory( "Not enough memory to save a world.", [&]() {
		rejectIf( world.step().bodies.isBusy(), "saveWorld", "a step is in progress." );
		insist( checkIds( world, settings ) );
		Archive archive = beginSnapshot( bytes );
		WorldSnapshot( world.step() ).write( archive, settings );
		archive.finish();
		endSnapshot( bytes, SnapshotKind::World );
		return Status{};
	} );
}

Result<RestoredWorld> restoreWorld( SoftBodyHost& world, BytesView bytes, const LoadSettings& settings )
{
	Result<RestoredWorld> result;
	result.status = withinMemory( "Not enough memory to restore a world.", [&]() {
		rejectIf( world.step().bodies.isBusy(), "restoreWorld", "a step is in progress." );
		Archive archive = openSnapshot( bytes, SnapshotKind::World );
		WorldSnapshot snapshot( world.step() );
		if ( archive.isSound() )
		{
			snapshot.read( archive, settings );
		}
		if ( !archive.isSound() )
		{
			return refusalOf( archive );
		}
		snapshot.commit( result.value );
		return Status{};
	} );
	return result;
}

} // namespace pliant
