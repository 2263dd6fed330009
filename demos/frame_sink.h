#pragma once

// Outputs for a film's frames: pictures, or model files for another program to draw.

#include "demos/run.h"

#include <memory>
#include <string>

namespace pliant_demos {

class FrameSink
{
public:
	virtual ~FrameSink() = default;

	/// Returns false if the frame could not be written; `why` then has the reason.
	virtual bool write( int frame, const pliant_glue::DrawList& list, std::string& why ) = 0;

	/// After the last frame. Returns a description of the output, for the summary.
	virtual std::string finish() = 0;
};

/// PNG frames, and a film of them if ffmpeg is installed. Null if nothing can be drawn here; `why` then has the reason.
std::unique_ptr<FrameSink> makePictureSink( const RunSettings& settings, std::string& why );

/// A model file for every `exportEvery`-th frame.
std::unique_ptr<FrameSink> makeModelSink( const RunSettings& settings );

} // namespace pliant_demos
