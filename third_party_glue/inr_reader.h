#pragma once

// INRIMAGE-4 (.inr): grey images in space, as scanners and segmentations leave them. Bytes only, not packed.

#include "third_party_glue/model_file.h"

#include <array>
#include <string_view>

namespace pliant_glue {

/// One byte a voxel; x runs fastest, then y, then z.
struct GreyVolume
{
	std::array<int, 3> size = { 0, 0, 0 };
	std::array<float, 3> spacing = { 1, 1, 1 }; ///< from one voxel to the next, in the file's unit
	std::vector<std::uint8_t> values;

	std::uint8_t at( int x, int y, int z ) const
	{
		return values[( std::size_t( z ) * std::size_t( size[1] ) + std::size_t( y ) ) * std::size_t( size[0] ) + std::size_t( x )];
	}
};

struct VolumeResult
{
	FileStatus status;
	GreyVolume volume;

	bool ok() const { return status.ok(); }
	static VolumeResult failure( FileCode code, std::string sentence ) { return { { code, std::move( sentence ) }, {} }; }
};

/// Of a file's bytes. `limits.fileBytes` bounds the voxels too.
VolumeResult readInr( std::string_view bytes, const ReadLimits& limits = {} );

/// Of a file.
VolumeResult readVolume( const std::string& path, const ReadLimits& limits = {} );

} // namespace pliant_glue
