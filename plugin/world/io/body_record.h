#pragma once

// One soft body of a snapshot.

#include "archive/archive.h"
#include "world/bodies/soft_body_impl.h"
#include "world/io/object_state.h"

#include <memory>
#include <vector>

namespace pliant {

void archive( Archive& archive, CutTrace& cut );

struct BodyRecord
{
	/// A pin as stored: its object by index in the snapshot.
	struct StoredPin
	{
		int node = -1, object = -1;
		PinKind kind = PinKind::Still;
		btVector3 point = btVector3( 0, 0, 0 );
		bool hasTarget = false;
		void archive( Archive& archive );
	};

	unsigned serial = 0;
	int bodyTemplate = 0; ///< index in the snapshot
	int group = 0, mask = 0;
	int family = -1, cuts = -1; ///< index in the snapshot; -1: none
	bool isDrawn = false;
	bool isRigid = false; ///< in its rigid state: none of its nodes touches anything
	ObjectState motion;
	ObjectSettings settings;
	std::vector<StoredPin> pins;
	std::unique_ptr<SoftBody::Impl> made;                 ///< the body read; null: to be read in place, from `state`
	Archive state = Archive( nullptr, std::size_t( 0 ) ); ///< not read yet

	/// All stored data of a body except the data from which it is made and its state. `pinned`: the index of a pin's object.
	static BodyRecord of( const SoftBody& body );
	void archive( Archive& archive );
	/// Writes record, make and state of a body.
	static void write( Archive& archive, const SoftBody& body, BodyRecord& record );
	/// Reads them. `live`: the existing body with this state, or null; it is read in place later, when that cannot fail.
	void read( Archive& archive, const std::vector<std::shared_ptr<const BodyTemplate>>& templates, SoftBody* live );
	/// Makes `body` the recorded one, except for references to other objects.
	void applyTo( SoftBody& body );
};

/// Refuses cuts of cells that a template of this many cells does not have.
void checkCuts( Archive& archive, const std::vector<CutTrace>& cuts, std::uint32_t cells );

} // namespace pliant
