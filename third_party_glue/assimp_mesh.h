#pragma once

// Any model file assimp reads -> plain triangle arrays, and back out as glTF, OBJ, PLY or STL.

#include "third_party_glue/model_file.h"

namespace pliant_glue {

/// Read every triangle of a file into one mesh: node transforms applied, one submesh per mesh of the file, equal vertices joined.
/// Never throws and never runs longer than `limits.seconds` (plus a fraction of a second).
/// A reading that ran out of time goes on in the background, unseen, until assimp lets go of the file: do not end the process at once.
/// .off and .ply files go through readers of our own: assimp's loses a face per comment line of the one and crashes on damaged
/// files of the other.
ReadResult readModel( const std::string& path, const ReadLimits& limits = {} );

/// Write meshes into one file; the format follows from the ending: .glb, .gltf, .obj, .ply or .stl.
/// PLY and STL know no separate meshes: theirs are put together.
FileStatus writeModel( const std::string& path, const std::vector<ModelMesh>& meshes );

} // namespace pliant_glue
