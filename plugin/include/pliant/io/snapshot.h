#pragma once

// Saves templates, bodies and whole worlds of soft bodies as bytes, and restores them (docs/guide/saving.md).
//
//     std::vector<std::byte> bytes;
//     if ( pliant::saveWorld( world, bytes ).ok() ) ...
//     const auto restored = pliant::restoreWorld( world, bytes );
//
// A restored world continues like the one that was saved, to the bit. Bytes are little-endian, and begin with a version and a checksum.
// Truncated, damaged, foreign or newer data is refused (ResultCode::BadSnapshot), and then nothing changes. Snapshots of bodies and worlds
// hold numbers of Bullet's precision: a build of the other precision refuses them; templates work with both.

#include "pliant/body_template.h"
#include "pliant/export.h"
#include "pliant/result.h"
#include "pliant/soft_body.h"
#include "pliant/soft_body_host.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

class btCollisionObject;
class btSerializer;

namespace pliant {

/// Bytes that a load reads. They are only read during the call.
struct BytesView
{
	const std::byte* data = nullptr; ///< null where size is 0
	std::size_t size = 0;            ///< number of bytes

	/// No bytes.
	BytesView() = default;
	/// `count` bytes at `first`.
	BytesView( const std::byte* first, std::size_t count ) : data( first ), size( count ) {}
	/// All bytes of a list.
	BytesView( const std::vector<std::byte>& all ) : data( all.data() ), size( all.size() ) {}
};

/// How a body or a world is saved.
struct SaveSettings
{
	/// Whether the templates are stored too. If not, the loader must have them: a snapshot without them has the state only (a rollback).
	bool withTemplates = true;

	/// Whether a world's snapshot omits data that depends on the addresses of Bullet's objects (the trees of its broadphase): worlds in
	/// equal states then have equal bytes, so that two machines can be compared. Not for restoring to the last bit.
	bool forComparison = false;

	/// The game's number of an object of the world that is no soft body, by which it is found again. Null: its index among those objects.
	std::int64_t ( *idOf )( const btCollisionObject& object, void* context ) = nullptr;
	void* context = nullptr; ///< passed to `idOf`
};

/// How a body or a world is loaded.
struct LoadSettings
{
	/// Templates that the snapshot may refer to without storing them. Those of the bodies in the world are found without being listed.
	std::vector<std::shared_ptr<const BodyTemplate>> templates;

	/// The inverse of SaveSettings::idOf, needed where that was set: the object with this number, in the world; null where there is none.
	btCollisionObject* ( *objectOf )( std::int64_t id, void* context ) = nullptr;
	void* context = nullptr; ///< passed to `objectOf`

	/// Whether the rigid bodies of the world get the motion and the sleep that they had, too. If not, the game restores them before the
	/// call.
	bool withRigidBodies = true;
};

/// Changes that restoreWorld made among the bodies of the world.
struct RestoredWorld
{
	/// Bodies that the world had when it was saved and has not had since. The world owns them, as it owns fragments
	/// (SoftBodyHost::releaseFragment). They have no user pointer.
	std::vector<SoftBody*> created;
	/// Bodies that have left the world, because it did not have them when it was saved. They are the game's; those that the world owned
	/// are deleted instead.
	std::vector<SoftBody*> removed;
};

/// Saves a template: a game may ship the bytes instead of the mesh. Errors: OutOfMemory.
PLIANT_API Result<std::vector<std::byte>> saveTemplate( const BodyTemplate& bodyTemplate );

/// Loads a template. Errors: BadSnapshot; BadArgument where the build lacks Feature::Surface and the template has a skin; OutOfMemory.
PLIANT_API Result<std::shared_ptr<const BodyTemplate>> loadTemplate( BytesView bytes );

/// Saves one body with its state, in a world or not. Its contacts and attachments belong to the world and are left out; pins to rigid
/// bodies become pins that hold still. Errors: OutOfMemory.
PLIANT_API Result<std::vector<std::byte>> saveBody( const SoftBody& body, const SaveSettings& settings = {} );

/// Loads a body, which is in no world. It has no user pointer. Errors: BadSnapshot, also where its template is neither stored nor listed;
/// OutOfMemory.
PLIANT_API SoftBodyResult loadBody( BytesView bytes, const LoadSettings& settings = {} );

/// Saves all soft bodies of a world with their contacts, pins and attachments, and the state that Bullet carries from step to step:
/// contacts of rigid bodies, broadphase, motion and sleep. Call it between steps. `bytes`: replaced; its memory is reused, so that a game
/// that saves every step allocates nothing. Errors: OutOfMemory; BadArgument if an id occurs twice in the settings, and during a step.
PLIANT_API Status saveWorld( const SoftBodyHost& world, std::vector<std::byte>& bytes, const SaveSettings& settings = {} );

/// Restores a world, between steps. Its objects other than soft bodies must be those at the time of saving, in the same order or with ids,
/// and its settings the same. Bodies that still exist keep their address, whether they have broken since or not; see RestoredWorld for
/// others. The game's contact callbacks are not called, except gContactDestroyedCallback with the data that it has stored in contact
/// points. Errors: BadSnapshot, OutOfMemory, BadArgument during a step: nothing has changed.
PLIANT_API Result<RestoredWorld> restoreWorld( SoftBodyHost& world, BytesView bytes, const LoadSettings& settings = {} );

/// Writes a .bullet file: the output of the world's `serialize`, and a chunk with the snapshot of saveWorld, which other importers skip.
/// Errors: as for saveWorld.
PLIANT_API Status saveBulletFile( SoftBodyHost& world, btSerializer& serializer, const SaveSettings& settings = {} );

/// Finds that snapshot in a .bullet file: a view of `file`, to be given to restoreWorld. Errors: BadSnapshot where the file is none, or has
/// no such chunk.
PLIANT_API Result<BytesView> snapshotInBulletFile( BytesView file );

} // namespace pliant
