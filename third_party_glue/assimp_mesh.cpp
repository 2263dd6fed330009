// +-----------------------------------------------------------------------------------------------------------------+
// | Model files through assimp, as if every file came from a stranger: validated, counted, and given up when it takes |
// | too long.                                                                                                         |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/assimp_mesh.h"

#include "third_party_glue/off_reader.h"
#include "third_party_glue/ply_reader.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/ProgressHandler.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <new>
#include <sstream>
#include <thread>

namespace pliant_glue {

namespace {

namespace fs = std::filesystem;

constexpr int kMaxNodeDepth = 256;
constexpr std::size_t kGlbHeaderBytes = 20;

using Stop = std::atomic<bool>;

/// Opens plain files within the size limit only: a model may name others (materials, buffers), even devices that never end.
class GuardedFiles : public Assimp::DefaultIOSystem
{
public:
	GuardedFiles( const ReadLimits& limits, std::shared_ptr<Stop> stop ) : m_limits( limits ), m_stop( std::move( stop ) ) {}

	Assimp::IOStream* Open( const char* file, const char* mode ) override
	{
		std::error_code error;
		const bool writes = mode != nullptr && ( mode[0] == 'w' || mode[0] == 'a' );
		if ( *m_stop || writes || !fs::is_regular_file( file, error ) || fs::file_size( file, error ) > m_limits.fileBytes || error )
		{
			return nullptr;
		}
		return DefaultIOSystem::Open( file, mode );
	}

private:
	ReadLimits m_limits;
	std::shared_ptr<Stop> m_stop;
};

/// assimp asks it between its passes whether to go on.
class StopHandler : public Assimp::ProgressHandler
{
public:
	explicit StopHandler( std::shared_ptr<Stop> stop ) : m_stop( std::move( stop ) ) {}
	bool Update( float ) override { return !*m_stop; }

private:
	std::shared_ptr<Stop> m_stop;
};

/// Puts the triangles of a validated scene together. Null pointers are still met in files that pass the validation.
class Gatherer
{
public:
	Gatherer( const aiScene& scene, const ReadLimits& limits ) : m_scene( scene ), m_limits( limits ) {}

	ReadResult gather()
	{
		visit( m_scene.mRootNode, aiMatrix4x4(), 0 );
		if ( m_tooMany )
		{
			return ReadResult::failure(
				FileCode::TooLarge, "The file's meshes have more vertices than the limit of " + std::to_string( m_limits.vertices ) + "." );
		}
		if ( m_mesh.indices.empty() )
		{
			return ReadResult::failure( FileCode::Unreadable, "The file holds no triangle." );
		}
		if ( !m_someTexture )
		{
			m_mesh.textureCoordinates.clear();
		}
		return { {}, std::move( m_mesh ) };
	}

private:
	void visit( const aiNode* node, const aiMatrix4x4& parent, int depth )
	{
		if ( node == nullptr || depth > kMaxNodeDepth || m_tooMany )
		{
			return;
		}
		const aiMatrix4x4 toWorld = parent * node->mTransformation;
		for ( unsigned k = 0; k < node->mNumMeshes && node->mMeshes != nullptr; ++k )
		{
			if ( node->mMeshes[k] < m_scene.mNumMeshes && m_scene.mMeshes[node->mMeshes[k]] != nullptr )
			{
				append( *m_scene.mMeshes[node->mMeshes[k]], *node, toWorld );
			}
		}
		for ( unsigned k = 0; k < node->mNumChildren && node->mChildren != nullptr; ++k )
		{
			visit( node->mChildren[k], toWorld, depth + 1 );
		}
	}

	void append( const aiMesh& from, const aiNode& node, const aiMatrix4x4& toWorld )
	{
		const std::size_t first = m_mesh.vertexCount();
		if ( from.mVertices == nullptr || from.mFaces == nullptr || first + from.mNumVertices > m_limits.vertices )
		{
			m_tooMany = m_tooMany || first + from.mNumVertices > m_limits.vertices;
			return;
		}
		for ( unsigned i = 0; i < from.mNumVertices; ++i )
		{
			const aiVector3D p = toWorld * from.mVertices[i];
			m_mesh.positions.insert( m_mesh.positions.end(), { float( p.x ), float( p.y ), float( p.z ) } );
			const aiVector3D uv = from.HasTextureCoords( 0 ) ? from.mTextureCoords[0][i] : aiVector3D();
			m_mesh.textureCoordinates.insert( m_mesh.textureCoordinates.end(), { float( uv.x ), float( uv.y ) } );
		}
		m_someTexture = m_someTexture || from.HasTextureCoords( 0 );

		const auto part = std::uint32_t( m_mesh.submeshNames.size() );
		m_mesh.submeshNames.emplace_back( from.mName.length > 0 ? from.mName.C_Str() : node.mName.C_Str() );
		const bool mirrored = toWorld.Determinant() < 0;
		for ( unsigned f = 0; f < from.mNumFaces; ++f )
		{
			const aiFace& face = from.mFaces[f];
			if ( face.mNumIndices != 3 || face.mIndices == nullptr ||
				*std::max_element( face.mIndices, face.mIndices + 3 ) >= from.mNumVertices )
			{
				continue; // points and lines, which SortByPType leaves only in files without any triangle
			}
			const auto base = std::uint32_t( first );
			m_mesh.indices.insert( m_mesh.indices.end(),
				{ base + face.mIndices[0], base + face.mIndices[mirrored ? 2 : 1], base + face.mIndices[mirrored ? 1 : 2] } );
			m_mesh.submeshOfTriangle.push_back( part );
		}
	}

	const aiScene& m_scene;
	const ReadLimits& m_limits;
	ModelMesh m_mesh;
	bool m_tooMany = false;
	bool m_someTexture = false;
};

ReadResult importWithAssimp( const std::string& path, const ReadLimits& limits, const std::shared_ptr<Stop>& stop )
{
	Assimp::Importer importer;
	importer.SetIOHandler( new GuardedFiles( limits, stop ) ); // the importer deletes both
	importer.SetProgressHandler( new StopHandler( stop ) );
	importer.SetPropertyInteger( AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE );
	importer.SetPropertyInteger( AI_CONFIG_PP_RVC_FLAGS,
		aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
			aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS );
	// Without validation assimp 5.2 hands out null meshes and null child nodes. Normals go first, so that vertices can be joined.
	const unsigned steps = aiProcess_ValidateDataStructure | aiProcess_Triangulate | aiProcess_RemoveComponent | aiProcess_SortByPType |
		aiProcess_JoinIdenticalVertices;
	const aiScene* scene = importer.ReadFile( path, steps );
	if ( *stop )
	{
		return ReadResult::failure( FileCode::TimeLimit, "stopped" );
	}
	if ( scene == nullptr || scene->mRootNode == nullptr || ( scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE ) != 0 )
	{
		const std::string why = importer.GetErrorString();
		return ReadResult::failure( FileCode::Unreadable, why.empty() ? "The file holds no mesh." : "assimp: " + why );
	}
	return Gatherer( *scene, limits ).gather();
}

/// .off and .ply: our own readers, which lose nothing and survive anything.
ReadResult importPlain( const std::string& path, const ReadLimits& limits, ReadResult ( *reader )( std::string_view, const ReadLimits& ) )
{
	std::ifstream file( path, std::ios::binary );
	std::ostringstream text;
	text << file.rdbuf();
	return file ? reader( text.view(), limits ) : ReadResult::failure( FileCode::Unreadable, "The file cannot be read." );
}

std::string lowerCaseEnding( const std::string& path )
{
	std::string ending = fs::path( path ).extension().string();
	std::transform( ending.begin(), ending.end(), ending.begin(), []( unsigned char c ) { return char( std::tolower( c ) ); } );
	return ending;
}

/// Bytes 8 and 12 of a .glb file give its own length and that of its first chunk; assimp allocates the latter unseen.
bool glbPromisesTooMuch( const std::string& header, std::uintmax_t fileBytes )
{
	const auto word = [&]( std::size_t at ) {
		std::uint32_t value = 0;
		for ( std::size_t k = 0; k < 4; ++k )
		{
			value |= std::uint32_t( std::uint8_t( header[at + k] ) ) << ( 8 * k );
		}
		return value;
	};
	return header.size() < kGlbHeaderBytes || word( 8 ) > fileBytes || word( 12 ) > fileBytes;
}

/// Looks at what a header claims before assimp believes it.
bool promisesTooMuch( const std::string& path, std::uintmax_t fileBytes )
{
	if ( lowerCaseEnding( path ) != ".glb" )
	{
		return false;
	}
	std::ifstream file( path, std::ios::binary );
	std::string header( std::size_t( std::min<std::uintmax_t>( fileBytes, kGlbHeaderBytes ) ), '\0' );
	file.read( header.data(), std::streamsize( header.size() ) );
	return glbPromisesTooMuch( header, fileBytes );
}

ReadResult import( const std::string& path, const ReadLimits& limits, const std::shared_ptr<Stop>& stop )
{
	try
	{
		const std::string ending = lowerCaseEnding( path );
		return ending == ".off" ? importPlain( path, limits, readOff )
			: ending == ".ply"  ? importPlain( path, limits, readPly )
								: importWithAssimp( path, limits, stop );
	}
	catch ( const std::bad_alloc& )
	{
		return ReadResult::failure( FileCode::OutOfMemory, "Not enough memory to read the file." );
	}
	catch ( const std::exception& error )
	{
		return ReadResult::failure( FileCode::Unreadable, std::string( "The reader failed: " ) + error.what() );
	}
}

/// What the reading thread and the waiting one share; the last of them frees it.
struct Reading
{
	std::mutex mutex;
	std::condition_variable done;
	bool isDone = false;
	ReadResult result;
};

/// assimp asks its progress handler between passes only, so a loop inside a loader can run for minutes. The import therefore has a
/// thread of its own, which is told to stop and left to end by itself when the time is over.
ReadResult importWithin( const std::string& path, const ReadLimits& limits )
{
	auto stop = std::make_shared<Stop>( false );
	auto reading = std::make_shared<Reading>();
	std::thread( [path, limits, stop, reading] {
		ReadResult result = import( path, limits, stop );
		const std::lock_guard<std::mutex> lock( reading->mutex );
		reading->result = std::move( result );
		reading->isDone = true;
		reading->done.notify_one();
	} ).detach();

	std::unique_lock<std::mutex> lock( reading->mutex );
	const auto limit = std::chrono::duration<double>( std::clamp( limits.seconds, 0.0, 86400.0 ) );
	if ( !reading->done.wait_for( lock, limit, [&] { return reading->isDone; } ) )
	{
		*stop = true;
		std::ostringstream sentence;
		sentence << "Reading took longer than the limit of " << limits.seconds << " s.";
		return ReadResult::failure( FileCode::TimeLimit, sentence.str() );
	}
	return std::move( reading->result );
}

/// NaN would pass every comparison later on; a file that holds one is told here, with the vertex.
FileStatus checkNumbers( const ModelMesh& mesh )
{
	for ( std::size_t i = 0; i < mesh.positions.size(); ++i )
	{
		if ( !std::isfinite( mesh.positions[i] ) )
		{
			return { FileCode::Unreadable, "Vertex " + std::to_string( i / 3 ) + " is not a finite number." };
		}
	}
	return {};
}

ReadResult readChecked( const std::string& path, const ReadLimits& limits )
{
	std::error_code error;
	if ( !fs::exists( path, error ) )
	{
		return ReadResult::failure( FileCode::NotFound, "There is no such file." );
	}
	if ( !fs::is_regular_file( path, error ) )
	{
		return ReadResult::failure( FileCode::Unreadable, "It is not a plain file." );
	}
	const std::uintmax_t bytes = fs::file_size( path, error );
	if ( error || bytes == 0 )
	{
		return ReadResult::failure( FileCode::Unreadable, "The file is empty or cannot be read." );
	}
	if ( bytes > limits.fileBytes )
	{
		return ReadResult::failure( FileCode::TooLarge,
			"The file has " + std::to_string( bytes ) + " bytes, more than the limit of " + std::to_string( limits.fileBytes ) + "." );
	}
	if ( promisesTooMuch( path, bytes ) )
	{
		return ReadResult::failure( FileCode::Unreadable, "Its header promises more than the file holds." );
	}
	ReadResult result = importWithin( path, limits );
	if ( result.ok() )
	{
		result.status = checkNumbers( result.mesh );
	}
	return result;
}

} // namespace

const char* toString( FileCode code )
{
	switch ( code )
	{
		case FileCode::Ok: return "Ok";
		case FileCode::NotFound: return "NotFound";
		case FileCode::Unreadable: return "Unreadable";
		case FileCode::TooLarge: return "TooLarge";
		case FileCode::TimeLimit: return "TimeLimit";
		case FileCode::NotWritten: return "NotWritten";
		case FileCode::OutOfMemory: return "OutOfMemory";
	}
	return "Unknown";
}

ReadResult readModel( const std::string& path, const ReadLimits& limits )
{
	try
	{
		ReadResult result = readChecked( path, limits );
		if ( result.ok() )
		{
			result.mesh.name = fs::path( path ).stem().string();
		}
		else
		{
			result.mesh = {};
			result.status.sentence = path + ": " + result.status.sentence;
		}
		return result;
	}
	catch ( const std::exception& )
	{
		return ReadResult::failure( FileCode::OutOfMemory, "Not enough memory or threads to read the file." );
	}
}

} // namespace pliant_glue
