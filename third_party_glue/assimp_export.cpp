// +-----------------------------------------------------------------------------------------------------------------+
// | Plain arrays -> an assimp scene -> a file. One node and one material a mesh.                                      |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/assimp_mesh.h"

#include <assimp/Exporter.hpp>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <new>

namespace pliant_glue {

namespace {

/// assimp's name of the format a file ending asks for; null when there is none.
const char* formatOf( const std::string& path )
{
	std::string ending = std::filesystem::path( path ).extension().string();
	std::transform( ending.begin(), ending.end(), ending.begin(), []( unsigned char c ) { return char( std::tolower( c ) ); } );
	static const std::map<std::string, const char*> kFormats = {
		{ ".glb", "glb2" }, { ".gltf", "gltf2" }, { ".obj", "obj" }, { ".ply", "plyb" }, { ".stl", "stlb" } };
	const auto found = kFormats.find( ending );
	return found == kFormats.end() ? nullptr : found->second;
}

/// assimp frees what it is given with delete[]: the scene owns everything made here.
aiVector3D* copyVectors( const std::vector<float>& from, std::size_t size )
{
	const std::size_t count = from.size() / size;
	auto* made = new aiVector3D[count];
	for ( std::size_t i = 0; i < count; ++i )
	{
		made[i] = aiVector3D( from[i * size], from[i * size + 1], size == 3 ? from[i * size + 2] : 0.0f );
	}
	return made;
}

aiColor4D* copyColours( const std::vector<float>& from )
{
	auto* made = new aiColor4D[from.size() / 3];
	for ( std::size_t i = 0; i < from.size() / 3; ++i )
	{
		made[i] = aiColor4D( from[i * 3], from[i * 3 + 1], from[i * 3 + 2], 1.0f );
	}
	return made;
}

aiMesh* makeMesh( const ModelMesh& from, unsigned material )
{
	auto made = std::make_unique<aiMesh>();
	made->mName = aiString( from.name );
	made->mMaterialIndex = material;
	made->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
	made->mNumVertices = unsigned( from.vertexCount() );
	made->mVertices = copyVectors( from.positions, 3 );
	if ( from.normals.size() == from.positions.size() )
	{
		made->mNormals = copyVectors( from.normals, 3 );
	}
	if ( from.textureCoordinates.size() == from.vertexCount() * 2 )
	{
		made->mTextureCoords[0] = copyVectors( from.textureCoordinates, 2 );
		made->mNumUVComponents[0] = 2;
	}
	if ( from.vertexColours.size() == from.positions.size() )
	{
		made->mColors[0] = copyColours( from.vertexColours );
	}
	made->mNumFaces = unsigned( from.triangleCount() );
	made->mFaces = new aiFace[from.triangleCount()];
	for ( std::size_t t = 0; t < from.triangleCount(); ++t )
	{
		made->mFaces[t].mNumIndices = 3;
		made->mFaces[t].mIndices = new unsigned[3]{ from.indices[t * 3], from.indices[t * 3 + 1], from.indices[t * 3 + 2] };
	}
	return made.release();
}

aiMaterial* makeMaterial( const ModelMesh& from )
{
	auto made = std::make_unique<aiMaterial>();
	const aiString name( from.name + "-material" );
	// A reader multiplies a vertex's colour by the material's.
	const bool isWhite = !from.vertexColours.empty();
	const aiColor4D colour = isWhite ? aiColor4D( 1, 1, 1, 1 ) : aiColor4D( from.colour[0], from.colour[1], from.colour[2], 1.0f );
	made->AddProperty( &name, AI_MATKEY_NAME );
	made->AddProperty( &colour, 1, AI_MATKEY_COLOR_DIFFUSE );
	made->AddProperty( &colour, 1, AI_MATKEY_BASE_COLOR );
	return made.release();
}

std::unique_ptr<aiScene> makeScene( const std::vector<ModelMesh>& meshes )
{
	auto scene = std::make_unique<aiScene>();
	const auto count = unsigned( meshes.size() );
	scene->mRootNode = new aiNode( "scene" );
	scene->mMeshes = new aiMesh* [count] {};
	scene->mMaterials = new aiMaterial* [count] {};
	scene->mNumMeshes = scene->mNumMaterials = count;
	scene->mRootNode->mChildren = new aiNode* [count] {};
	scene->mRootNode->mNumChildren = count;
	for ( unsigned i = 0; i < count; ++i )
	{
		scene->mMeshes[i] = makeMesh( meshes[i], i );
		scene->mMaterials[i] = makeMaterial( meshes[i] );
		auto* node = new aiNode( meshes[i].name );
		scene->mRootNode->mChildren[i] = node;
		node->mParent = scene->mRootNode;
		node->mNumMeshes = 1;
		node->mMeshes = new unsigned[1]{ i };
	}
	return scene;
}

std::string whatIsWrong( const std::vector<ModelMesh>& meshes )
{
	for ( const ModelMesh& mesh : meshes )
	{
		const std::size_t count = mesh.vertexCount();
		if ( count == 0 || mesh.indices.empty() || mesh.positions.size() % 3 != 0 || mesh.indices.size() % 3 != 0 )
		{
			return "mesh \"" + mesh.name + "\" has no vertex, no triangle or half of one";
		}
		if ( std::any_of( mesh.indices.begin(), mesh.indices.end(), [&]( std::uint32_t i ) { return i >= count; } ) )
		{
			return "mesh \"" + mesh.name + "\" names a vertex that is not there";
		}
	}
	return meshes.empty() ? "there is nothing to write" : "";
}

} // namespace

FileStatus writeModel( const std::string& path, const std::vector<ModelMesh>& meshes )
{
	const char* format = formatOf( path );
	if ( format == nullptr )
	{
		return { FileCode::NotWritten, path + ": the ending must be .glb, .gltf, .obj, .ply or .stl." };
	}
	if ( const std::string wrong = whatIsWrong( meshes ); !wrong.empty() )
	{
		return { FileCode::NotWritten, path + ": " + wrong + "." };
	}
	try
	{
		const std::unique_ptr<aiScene> scene = makeScene( meshes );
		Assimp::Exporter exporter;
		if ( exporter.Export( scene.get(), format, path ) != aiReturn_SUCCESS )
		{
			return { FileCode::NotWritten, path + ": assimp: " + exporter.GetErrorString() };
		}
		// The exporter does not say when the disk was full.
		std::error_code error;
		if ( std::filesystem::file_size( path, error ) == 0 || error )
		{
			return { FileCode::NotWritten, path + ": the file came out empty." };
		}
		return {};
	}
	catch ( const std::bad_alloc& )
	{
		return { FileCode::OutOfMemory, path + ": not enough memory to write it." };
	}
	catch ( const std::exception& error )
	{
		return { FileCode::NotWritten, path + ": " + error.what() };
	}
}

} // namespace pliant_glue
