#pragma once

// Where a film's frames go: pictures, or model files for another program to draw.

#include "demos/run.h"

#include <memory>
#include <string>

namespace pliant_demos {

class FrameSink
{
public:
	virtual ~FrameSink() = default;

	/// False when the frame could not be written; `why` then says so.
	virtual bool write( int frame, const pliant_glue::DrawList& list, std::string& why ) = 0;

	/// After the last frame. Returns what was made, for the summary.
	virtual std::string finish() = 0;
};

/// PNG frames, and a film of them when ffmpeg is there. Null when nothing can be drawn here; `why` then says so.
std::unique_ptr<FrameSink> makePictureSink( const RunSettings& settings, std::string& why );

/// A model file for every `exportEvery`-th frame.
std::unique_ptr<FrameSink> makeModelSink( const RunSettings& settings );

} // namespace pliant_demos
