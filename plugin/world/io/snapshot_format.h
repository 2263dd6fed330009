#pragma once

// The frame around every snapshot: what it is, which version, and whether it is whole.

#include "archive/archive.h"
#include "pliant/io/snapshot.h"

namespace pliant {

enum class SnapshotKind : std::uint8_t
{
	Template,
	Body,
	World
};

/// Starts a snapshot that replaces what the list holds; what is written then is its content.
Archive beginSnapshot( std::vector<std::byte>& bytes );
/// Completes it, once its archive has finished.
void endSnapshot( std::vector<std::byte>& bytes, SnapshotKind kind );

/// An archive of the content; not sound, with the reason, where the bytes are no whole snapshot of this kind. It is trusted where this
/// process has written it.
Archive openSnapshot( BytesView bytes, SnapshotKind kind );

/// The size that a snapshot says it has, with its frame; bytes may follow it. 0 where the data is too short to say.
std::size_t snapshotSize( BytesView bytes );

/// What a load answers that its archive has refused.
Status refusalOf( const Archive& archive );

} // namespace pliant
