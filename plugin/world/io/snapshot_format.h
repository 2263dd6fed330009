#pragma once

// The frame around every snapshot: its kind, its version, and its checksum.

#include "archive/archive.h"
#include "pliant/io/snapshot.h"

namespace pliant {

enum class SnapshotKind : std::uint8_t
{
	Template,
	Body,
	World
};

/// Starts a snapshot that replaces the contents of the list; data written then is its content.
Archive beginSnapshot( std::vector<std::byte>& bytes );
/// Completes it, once its archive has finished.
void endSnapshot( std::vector<std::byte>& bytes, SnapshotKind kind );

/// An archive of the content; not sound, with the reason, where the bytes are no whole snapshot of this kind. It is trusted where this
/// process has written it.
Archive openSnapshot( BytesView bytes, SnapshotKind kind );

/// The size that a snapshot states, with its frame; bytes may follow it. 0 if the data is too short to tell.
std::size_t snapshotSize( BytesView bytes );

/// Status of a load whose archive has refused the data.
Status refusalOf( const Archive& archive );

} // namespace pliant
