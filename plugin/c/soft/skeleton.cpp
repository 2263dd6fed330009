// Bodies that follow bones or targets.

#include "pliant/c/skeleton.h"
#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/game/skeleton.h"
#include "world/bodies/soft_body_impl.h"

#include <LinearMath/btAlignedObjectArray.h>

#include <type_traits>

namespace pliant::c {

namespace {

static_assert( std::is_same_v<int, std::int32_t> ); // of bones

pliant_pose_settings defaultPose()
{
	const PoseSettings usual;
	pliant_pose_settings settings{};
	settings.frequency = usual.frequency;
	settings.damping_ratio = usual.dampingRatio;
	return settings;
}

pliant_skin_weights defaultWeights()
{
	pliant_skin_weights weights{};
	weights.per_vertex = SkinWeights{}.perVertex;
	return weights;
}

PosePaint paintOf( const float* point, void* context )
{
	const pliant_pose_settings& settings = *static_cast<const pliant_pose_settings*>( context );
	PosePaint paint;
	settings.paint( point, &paint.strength, &paint.largestDistance, settings.paint_context );
	return paint;
}

/// Calls `work( SoftBody&, const PoseSettings& )`, which returns a Status.
template <class F>
pliant_result follow( pliant_world* world, pliant_id body, const pliant_pose_settings* given, F&& work )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		pliant_pose_settings full = defaultPose();
		readSized( given, full );
		PoseSettings settings;
		settings.frequency = full.frequency;
		settings.dampingRatio = full.damping_ratio;
		settings.paint = full.paint ? paintOf : nullptr;
		settings.context = &full;
		return work( soft, settings );
	} );
}

/// Reads `count` items of `size` numbers each; none if `count` is not the number that the library expects.
template <class T, class F>
btAlignedObjectArray<T> listOf( const double* numbers, int count, int wanted, int size, F&& make )
{
	btAlignedObjectArray<T> all;
	for ( int k = 0; numbers && count == wanted && k < count; ++k )
	{
		all.push_back( make( numbers + std::size_t( k ) * std::size_t( size ) ) );
	}
	return all;
}

btTransform transformOf( const double* m )
{
	const auto at = [m]( int k ) { return btScalar( m[k] ); };
	return btTransform( btMatrix3x3( at( 0 ), at( 1 ), at( 2 ), at( 4 ), at( 5 ), at( 6 ), at( 8 ), at( 9 ), at( 10 ) ),
		btVector3( at( 3 ), at( 7 ), at( 11 ) ) );
}

btVector3 positionOf( const double* p )
{
	return btVector3( btScalar( p[0] ), btScalar( p[1] ), btScalar( p[2] ) );
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_skin_weights_init( pliant_skin_weights* weights, uint32_t size )
{
	return initSized( defaultWeights(), weights, size );
}

pliant_result pliant_pose_settings_init( pliant_pose_settings* settings, uint32_t size )
{
	return initSized( defaultPose(), settings, size );
}

pliant_result pliant_body_follow_bones(
	pliant_world* world, pliant_id body, const pliant_skin_weights* weights, const pliant_pose_settings* settings )
{
	return withSoft( world, body, [&]( SoftBody& ) {
		requirePointers( weights );
		pliant_skin_weights full = defaultWeights();
		readSized( weights, full );
		const SkinWeights taken{ full.bones, full.weights, full.per_vertex, full.vertex_count, full.bone_count };
		return follow( world, body, settings, [&]( SoftBody& soft, const PoseSettings& how ) { return followBones( soft, taken, how ); } );
	} );
}

pliant_result pliant_body_follow_targets( pliant_world* world, pliant_id body, const pliant_pose_settings* settings )
{
	return follow( world, body, settings, []( SoftBody& soft, const PoseSettings& how ) { return followTargets( soft, how ); } );
}

pliant_result pliant_body_stop_following( pliant_world* world, pliant_id body )
{
	return withSoft( world, body, []( SoftBody& soft ) { stopFollowing( soft ); } );
}

pliant_result pliant_body_get_following( const pliant_world* world, pliant_id body, int32_t* is_following )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { give( isFollowing( soft ) ? 1 : 0, is_following ); } );
}

pliant_result pliant_body_set_pose( pliant_world* world, pliant_id body, const double* bones, int32_t count, int32_t jumps )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		const PoseFollower* const follower = soft.impl().follower.get();
		const auto all = listOf<btTransform>( bones, count, follower ? follower->model->boneCount : 0, 12, transformOf );
		return setPose( soft, all.size() == 0 ? nullptr : &all[0], count, jumps != 0 );
	} );
}

pliant_result pliant_body_set_targets( pliant_world* world, pliant_id body, const double* positions, int32_t count, int32_t jumps )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		const PoseFollower* const follower = soft.impl().follower.get();
		const auto all = listOf<btVector3>( positions, count, follower ? int( follower->model->rest.size() ) : 0, 3, positionOf );
		return setTargets( soft, all.size() == 0 ? nullptr : &all[0], count, jumps != 0 );
	} );
}

pliant_result pliant_body_get_pose_target( const pliant_world* world, pliant_id body, int32_t cell, pliant_vec3* target )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { give( vectorOf( poseTarget( soft, cell ) ), target ); } );
}

pliant_result pliant_body_set_pose_blend( pliant_world* world, pliant_id body, double blend )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return setPoseBlend( soft, btScalar( blend ) ); } );
}

pliant_result pliant_body_get_pose_blend( const pliant_world* world, pliant_id body, double* blend )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { give( double( poseBlend( soft ) ), blend ); } );
}

pliant_result pliant_body_get_pose_force( const pliant_world* world, pliant_id body, pliant_vec3* force, pliant_vec3* torque )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		const PoseForce sum = poseForce( soft );
		offer( vectorOf( sum.force ), force );
		offer( vectorOf( sum.torque ), torque );
	} );
}
