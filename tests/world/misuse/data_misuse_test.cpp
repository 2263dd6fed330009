// Misuse of the data from which bodies are made, drawn, posed and restored, while a scene continues.

#include "world/bodies/soft_body_impl.h"
#include "world/misuse/misuse.h"

#include <pliant/build.h>
#include <pliant/game/skeleton.h>
#include <pliant/render/render_mesh.h>
#include <pliant/render/vertex_attributes.h>

#include <LinearMath/btSerializer.h>

#include <cstring>

namespace pliant::test {
namespace {

const float kCorners[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
const std::uint32_t kFaces[12] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };

MeshView tetrahedron()
{
	MeshView mesh;
	mesh.positions = kCorners;
	mesh.vertexCount = 4;
	mesh.indices = kFaces;
	mesh.triangleCount = 4;
	return mesh;
}

Status build( const MeshView& mesh, const LatticeSettings& settings = {} )
{
	return BodyTemplate::build( mesh, settings ).status;
}

std::shared_ptr<const BodyTemplate> shapeOf( const SoftBody* body )
{
	return body->impl().bodyTemplate;
}

std::unique_ptr<RenderSkin> skinOf( const std::shared_ptr<const BodyTemplate>& shape )
{
	return std::move( RenderSkin::create( RenderMesh::bind( shape, tetrahedron() ).value ).value );
}

const Misuse kTemplates[] = {
	{ "BodyTemplate::build", kBad,
		[]( Scene& ) {
			const MeshView mesh = tetrahedron();
			return Answers{ build( changed( mesh, &MeshView::positions, static_cast<const float*>( nullptr ) ) ),
				build( changed( mesh, &MeshView::indices, static_cast<const std::uint32_t*>( nullptr ) ) ),
				build( changed( mesh, &MeshView::positionStride, std::size_t( 2 ) ) ),
				build( changed( mesh, &MeshView::positionStride, std::size_t( 0 ) ) ) };
		},
		"The mesh needs" },
	{ "BodyTemplate::build", ResultCode::BadSettings,
		[]( Scene& ) {
			const LatticeSettings usual;
			const MeshView mesh = tetrahedron();
			CrackSettings cracks;
			cracks.noiseAmplitude = NAN;
			return Answers{ build( mesh, changed( usual, &LatticeSettings::cellSize, -1.0f ) ),
				build( mesh, changed( usual, &LatticeSettings::cellSize, std::nanf( "" ) ) ),
				build( mesh, changed( usual, &LatticeSettings::targetCells, 0 ) ),
				build( mesh, changed( usual, &LatticeSettings::maxCells, INT_MAX ) ),
				build( mesh, changed( usual, &LatticeSettings::samplesPerEdge, 9 ) ),
				build( mesh, changed( usual, &LatticeSettings::weldTolerance, -1.0f ) ),
				build( mesh, changed( usual, &LatticeSettings::minimumFill, std::nanf( "" ) ) ),
				build( mesh, changed( usual, &LatticeSettings::shellThickness, -1.0f ) ),
				build( mesh, changed( usual, &LatticeSettings::shell, Shell( 7 ) ) ),
				build( mesh, changed( usual, &LatticeSettings::skinning, Skinning( 7 ) ) ),
				build( mesh, changed( usual, &LatticeSettings::cracks, cracks ) ) };
		},
		"Settings" },
	{ "BodyTemplate::build", ResultCode::EmptyMesh,
		[]( Scene& ) {
			return Answers{ build( changed( tetrahedron(), &MeshView::vertexCount, std::size_t( 0 ) ) ),
				build( changed( tetrahedron(), &MeshView::triangleCount, std::size_t( 0 ) ) ) };
		},
		"mesh" },
	{ "BodyTemplate::scaled", kBad,
		[]( Scene& s ) {
			Answers all;
			for ( const float bad : { 0.0f, -1.0f, 1e-7f, 1e7f, std::nanf( "" ), std::numeric_limits<float>::infinity() } )
			{
				all.push_back( shapeOf( s.body )->scaled( bad ).status );
			}
			return all;
		} },
	{ "check", ResultCode::BadMaterial,
		[]( Scene& ) { return Answers{ check( changed( Material{}, &Material::alpha, std::nanf( "" ) ) ) }; }, "Material::alpha" },
	{ "check", ResultCode::BadSettings,
		[]( Scene& ) {
			return Answers{ check( changed( Adaptivity{}, &Adaptivity::keepMass, std::nanf( "" ) ) ),
				check( changed( Adaptivity{}, &Adaptivity::regions, RegionRule( 9 ) ) ),
				check( changed( Adaptivity{}, &Adaptivity::softening, Softening( -1 ) ) ),
				check( changed( Adaptivity{}, &Adaptivity::residual, ResidualRule( 9 ) ) ) };
		},
		"Adaptivity" },
	{ "check", ResultCode::BadSettings,
		[]( Scene& ) { return Answers{ check( changed( Fracture{}, &Fracture::coolDown, std::nanf( "" ) ) ) }; }, "Fracture::coolDown" },
	{ "check", ResultCode::BadSettings,
		[]( Scene& ) { return Answers{ check( changed( DebrisBudget{}, &DebrisBudget::fadeTime, std::nanf( "" ) ) ) }; }, "fadeTime" },
	{ "steinemannAdaptivity", ResultCode::BadSettings,
		[]( Scene& ) {
			return Answers{ check( steinemannAdaptivity( -1 ) ), check( steinemannAdaptivity( INT_MAX ) ) };
		},
		"Adaptivity" },
	{ "ohtaAdaptivity", ResultCode::BadSettings,
		[]( Scene& ) {
			return Answers{ check( ohtaAdaptivity( -1 ) ), check( ohtaAdaptivity( INT_MAX ) ) };
		},
		"Adaptivity" },
	{ "defaultYoungsModulus", ResultCode::Ok,
		[]( Scene& ) {
			Answers all;
			for ( const float bad : { 0.0f, -1.0f, std::nanf( "" ), std::numeric_limits<float>::infinity() } )
			{
				all.push_back( answers( defaultYoungsModulus( bad, 1.0f ) == 0.0f ) );
				all.push_back( answers( defaultYoungsModulus( 1000.0f, bad ) == 0.0f ) );
			}
			return all;
		} },
#ifdef NDEBUG // with assertions this ends the program
	{ "planStiffness", ResultCode::Ok,
		[]( Scene& ) {
			Answers all;
			const Material sound = changed( Material{}, &Material::youngsModulus, 1e5f );
			all.push_back( answers( !planStiffness( Material{}, 0.1f, 0.01f, 4 ).reachable ) );
			for ( const float bad : { 0.0f, -1.0f, std::nanf( "" ), std::numeric_limits<float>::infinity() } )
			{
				all.push_back( answers( !planStiffness( sound, bad, 0.01f, 4 ).reachable ) );
				all.push_back( answers( !planStiffness( sound, 0.1f, bad, 4 ).reachable ) );
				all.push_back( answers( !planStiffness( changed( sound, &Material::density, bad ), 0.1f, 0.01f, 4 ).reachable ) );
			}
			all.push_back( answers( !planStiffness( sound, 0.1f, 0.01f, 0 ).reachable ) );
			return all;
		} },
#endif
	{ "hasFeature", ResultCode::Ok,
		[]( Scene& ) {
			return Answers{ answers( !hasFeature( Feature( -1 ) ) ), answers( !hasFeature( Feature( kFeatureCount ) ) ) };
		} },
	{ "toString", ResultCode::Ok,
		[]( Scene& ) {
			return Answers{ answers( std::strcmp( toString( ResultCode( -1 ) ), "unknown" ) == 0 ),
				answers( std::strcmp( toString( ResultCode( 999 ) ), "unknown" ) == 0 ) };
		} },
	{ "toString", ResultCode::Ok,
		[]( Scene& ) {
			return Answers{ answers( std::strcmp( toString( Feature( -1 ) ), "unknown" ) == 0 ),
				answers( std::strcmp( toString( Feature( 999 ) ), "unknown" ) == 0 ) };
		} },
	{ "createThreadPool", ResultCode::Ok,
		[]( Scene& ) {
			return Answers{
				answers( createThreadPool( 0 )->threadCount() == 1 ), answers( createThreadPool( INT_MIN )->threadCount() == 1 ) };
		} },
	{ "TaskRunner::run", ResultCode::Ok,
		[]( Scene& ) {
			int calls = 0;
			const TaskRunner::Task task = []( void* context, int ) { ++*static_cast<int*>( context ); };
			for ( const int threads : { 1, 2 } )
			{
				const std::unique_ptr<TaskRunner> pool = createThreadPool( threads );
				for ( const int count : { 0, -1, INT_MIN } )
				{
					pool->run( count, task, &calls );
				}
			}
			return Answers{ answers( calls == 0 ) };
		} },
};

const Misuse kDrawn[] = {
	{ "RenderMesh::bind", kBad, []( Scene& ) { return Answers{ RenderMesh::bind( nullptr, tetrahedron() ).status }; } },
	{ "RenderMesh::bind", kBad,
		[]( Scene& s ) {
			const MeshView mesh = changed( tetrahedron(), &MeshView::positions, static_cast<const float*>( nullptr ) );
			return Answers{ RenderMesh::bind( shapeOf( s.body ), mesh ).status };
		},
		"The mesh needs" },
	{ "RenderSkin::create", kBad, []( Scene& ) { return Answers{ RenderSkin::create( nullptr ).status }; } },
	{ "RenderSkin::surface", ResultCode::Ok,
		[]( Scene& s ) {
			const auto skin = skinOf( block( 1, 1, 1, 0.3f ) ); // of another template
			return Answers{ answers( skin->surface( *s.body ).vertexCount == 0 ) };
		} },
	{ "RenderSkin::gpuSurface", ResultCode::Ok,
		[]( Scene& s ) {
			const auto skin = skinOf( block( 1, 1, 1, 0.3f ) );
			return Answers{ answers( skin->gpuSurface( *s.body ).vertices.count == 0 ) };
		} },
	{ "RenderSkin::vertexSources", ResultCode::Ok,
		[]( Scene& s ) {
			const auto skin = skinOf( block( 1, 1, 1, 0.3f ) );
			return Answers{ answers( skin->vertexSources( *s.body ).vertexCount == 0 ) };
		} },
	{ "vertexSources", ResultCode::Ok, []( Scene& s ) { return Answers{ answers( vertexSources( *s.bare ).vertexCount == 0 ) }; } },
	{ "restTangents", ResultCode::Ok,
		[]( Scene& s ) {
			return Answers{ answers( !restTangents( *s.bare ).tangents ), answers( !restTangents( *s.body ).tangents ) }; // no texture
		} },
	{ "tangents", ResultCode::Ok,
		[]( Scene& s ) {
			return Answers{ answers( !tangents( *s.bare ).tangents ), answers( !tangents( *s.body ).tangents ) };
		} },
	{ "interpolateAttribute", kBad,
		[]( Scene& ) {
			float one = 1.0f;
			VertexSourceView none, negative;
			negative.vertexCount = -1;
			return Answers{ interpolateAttribute( none, nullptr, 1, nullptr, &one ),
				interpolateAttribute( none, &one, 1, nullptr, nullptr ), interpolateAttribute( none, &one, 0, nullptr, &one ),
				interpolateAttribute( none, &one, INT_MIN, nullptr, &one ), interpolateAttribute( negative, &one, 1, nullptr, &one ) };
		} },
};

PosePaint paintTooStrong( const float*, void* )
{
	return PosePaint{ 2.0f, 1.0f };
}

PosePaint paintNothingReached( const float*, void* )
{
	return PosePaint{ 1.0f, NAN };
}

/// A weight of 1 on bone 0 for every vertex.
struct OneBone
{
	explicit OneBone( const SoftBody& body ) : weights( std::size_t( body.bodyTemplate().vertexCount() ), 1.0f ), bones( weights.size(), 0 )
	{
		view = SkinWeights{ bones.data(), weights.data(), 1, int( bones.size() ), 1 };
	}

	std::vector<float> weights;
	std::vector<int> bones;
	SkinWeights view;
};

const Misuse kPosed[] = {
	{ "followBones", kBad,
		[]( Scene& s ) {
			const OneBone good( *s.body );
			OneBone unknown = good, unnumbered = good;
			unknown.weights[0] = NAN;
			unknown.view.weights = unknown.weights.data();
			unnumbered.bones[0] = 1;
			unnumbered.view.bones = unnumbered.bones.data();
			return Answers{ followBones( *s.body, SkinWeights{} ),
				followBones( *s.body, changed( good.view, &SkinWeights::bones, static_cast<const int*>( nullptr ) ) ),
				followBones( *s.body, changed( good.view, &SkinWeights::weights, static_cast<const float*>( nullptr ) ) ),
				followBones( *s.body, changed( good.view, &SkinWeights::perVertex, 0 ) ),
				followBones( *s.body, changed( good.view, &SkinWeights::perVertex, 5 ) ),
				followBones( *s.body, changed( good.view, &SkinWeights::vertexCount, -1 ) ),
				followBones( *s.body, changed( good.view, &SkinWeights::boneCount, 0 ) ), followBones( *s.body, unknown.view ),
				followBones( *s.body, unnumbered.view ), followBones( *s.bare, good.view ) };
		} },
	{ "followBones", ResultCode::BadSettings,
		[]( Scene& s ) {
			const OneBone good( *s.body );
			const PoseSettings usual;
			return Answers{ followBones( *s.body, good.view, changed( usual, &PoseSettings::frequency, 0.0f ) ),
				followBones( *s.body, good.view, changed( usual, &PoseSettings::frequency, std::nanf( "" ) ) ),
				followBones( *s.body, good.view, changed( usual, &PoseSettings::dampingRatio, 11.0f ) ),
				followBones( *s.body, good.view, changed( usual, &PoseSettings::paint, &paintTooStrong ) ),
				followBones( *s.body, good.view, changed( usual, &PoseSettings::paint, &paintNothingReached ) ) };
		} },
	{ "followTargets", ResultCode::BadSettings,
		[]( Scene& s ) {
			const PoseSettings usual;
			return Answers{ followTargets( *s.body, changed( usual, &PoseSettings::frequency, -1.0f ) ),
				followTargets( *s.body, changed( usual, &PoseSettings::dampingRatio, std::nanf( "" ) ) ),
				followTargets( *s.body, changed( usual, &PoseSettings::paint, &paintTooStrong ) ) };
		} },
	{ "stopFollowing", ResultCode::Ok,
		[]( Scene& s ) {
			stopFollowing( *s.body );
			return Answers{ answers( !isFollowing( *s.body ) ) };
		} },
	{ "isFollowing", ResultCode::Ok, []( Scene& s ) { return Answers{ answers( !isFollowing( *s.body ) ) }; } },
	{ "setPose", kBad,
		[]( Scene& s ) {
			const btTransform still = btTransform::getIdentity();
			return Answers{ setPose( *s.body, &still, 1 ), setPose( *s.body, nullptr, 0 ), setPose( *s.posed, &still, 2 ),
				setPose( *s.posed, nullptr, 1 ), setPose( *s.posed, &still, -1 ) };
		} },
	{ "setPose", kBad,
		[]( Scene& s ) {
			Answers all = forBadVectors( [&]( const btVector3& v ) {
				const btTransform bad( btQuaternion::getIdentity(), v );
				return setPose( *s.posed, &bad, 1 );
			} );
			const btTransform far = at( btScalar( 2e9 ), 0, 0 );
			btTransform large = btTransform::getIdentity();
			large.getBasis()[0][0] = btScalar( 1e30 );
			all.push_back( setPose( *s.posed, &far, 1 ) );
			all.push_back( setPose( *s.posed, &large, 1, true ) );
			return all;
		} },
	{ "setTargets", kBad,
		[]( Scene& s ) {
			std::vector<btVector3> targets( 64, btVector3( 0, 0, 0 ) );
			Answers all{ setTargets( *s.body, targets.data(), 64 ), setTargets( *s.posed, targets.data(), 64 ),
				setTargets( *s.drawn, nullptr, 64 ), setTargets( *s.drawn, targets.data(), 63 ),
				setTargets( *s.drawn, targets.data(), -1 ) };
			for ( const btVector3& bad : { btVector3( kNan, 0, 0 ), btVector3( 0, kInf, 0 ), btVector3( 0, 0, btScalar( 2e9 ) ) } )
			{
				targets[63] = bad;
				all.push_back( setTargets( *s.drawn, targets.data(), 64 ) );
			}
			return all;
		} },
	{ "poseTarget", ResultCode::Ok,
		[]( Scene& s ) {
			Answers all = forBadIndices( 64, [&]( int i ) { return answers( poseTarget( *s.posed, i ).isZero() ); } );
			all.push_back( answers( poseTarget( *s.body, 0 ).isZero() ) );
			return all;
		} },
	{ "setPoseBlend", kBad,
		[]( Scene& s ) {
			return Answers{ setPoseBlend( *s.body, 1 ), setPoseBlend( *s.posed, kNan ), setPoseBlend( *s.posed, btScalar( -0.1 ) ),
				setPoseBlend( *s.posed, btScalar( 1.1 ) ) };
		} },
	{ "poseBlend", ResultCode::Ok, []( Scene& s ) { return Answers{ answers( poseBlend( *s.body ) == 0 ) }; } },
	{ "poseForce", ResultCode::Ok, []( Scene& s ) { return Answers{ answers( poseForce( *s.body ).force.isZero() ) }; } },
};

/// Data that is not a snapshot of the expected kind.
template <class Load>
Answers forBadData( const std::vector<std::byte>& otherKind, const Load& load )
{
	std::vector<std::byte> cut = otherKind, noise( 500, std::byte( 7 ) );
	cut.pop_back();
	return { load( BytesView() ), load( BytesView( nullptr, 500 ) ), load( BytesView( otherKind.data(), 3 ) ), load( cut ), load( noise ),
		load( otherKind ) };
}

const SaveSettings kOneIdForAll{ true, false, []( const btCollisionObject&, void* ) { return std::int64_t( 1 ); } };

const Misuse kSaved[] = {
	{ "loadTemplate", ResultCode::BadSnapshot,
		[]( Scene& s ) { return forBadData( saveBody( *s.body ).value, []( BytesView bytes ) { return loadTemplate( bytes ).status; } ); },
		"he " },
	{ "saveBody", ResultCode::Ok,
		[]( Scene& s ) {
			return Answers{ saveBody( *s.body ).status, saveBody( *s.bare ).status };
		} },
	{ "loadBody", ResultCode::BadSnapshot,
		[]( Scene& s ) {
			Answers all = forBadData(
				saveTemplate( *shapeOf( s.body ) ).value, []( BytesView bytes ) { return loadBody( bytes ).status; } );
			SaveSettings bare;
			bare.withTemplates = false;
			LoadSettings others;
			others.templates = { nullptr, shapeOf( s.bare.get() ) };
			all.push_back( loadBody( saveBody( *s.body, bare ).value ).status );
			all.push_back( loadBody( saveBody( *s.body, bare ).value, others ).status );
			return all;
		},
		"he " },
	{ "saveWorld", kBad,
		[]( Scene& s ) {
			std::vector<std::byte> bytes( 3 );
			return Answers{ saveWorld( s.home.world, bytes, kOneIdForAll ) };
		},
		"SaveSettings::idOf" },
	{ "restoreWorld", ResultCode::BadSnapshot,
		[]( Scene& s ) {
			Answers all = forBadData(
				saveBody( *s.body ).value, [&s]( BytesView bytes ) { return restoreWorld( s.home.world, bytes ).status; } );
			std::vector<std::byte> bytes;
			static_cast<void>( saveWorld( s.elsewhere.world, bytes ) );
			all.push_back( restoreWorld( s.home.world, bytes ).status ); // a snapshot of another world
			return all;
		},
		"he " },
	{ "saveBulletFile", kBad,
		[]( Scene& s ) {
			btDefaultSerializer serializer;
			return Answers{ saveBulletFile( s.home.world, serializer, kOneIdForAll ) };
		},
		"SaveSettings::idOf" },
	{ "snapshotInBulletFile", ResultCode::BadSnapshot,
		[]( Scene& s ) {
			return forBadData( saveBody( *s.body ).value, []( BytesView bytes ) { return snapshotInBulletFile( bytes ).status; } );
		},
		"he " },
};

class MisuseOfData : public testing::TestWithParam<BodyState>
{};

TEST_P( MisuseOfData, IsRefusedAndChangesNothing )
{
	expectNothingChanges( GetParam(), kTemplates );
	expectNothingChanges( GetParam(), kDrawn );
	expectNothingChanges( GetParam(), kPosed );
	expectNothingChanges( GetParam(), kSaved );
}

INSTANTIATE_TEST_SUITE_P( States, MisuseOfData, testing::ValuesIn( kBodyStates ) );

} // namespace
} // namespace pliant::test
