// The public functions of bodies that follow a pose.

#include "pliant/game/skeleton.h"
#include "lattice/attempt.h"
#include "world/bodies/placing.h"
#include "world/constants.h"
#include "world/joints/pose_follower.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

void checkSettings( const char* call, const PoseSettings& settings )
{
	const bool isSound = settings.frequency > 0.0f && settings.dampingRatio >= 0.0f && settings.dampingRatio <= kMostPoseDamping;
	if ( !isSound )
	{
		reject( ResultCode::BadSettings, std::string( call ) + ": the frequency must be above 0 and the damping ratio 0 to 10." );
	}
}

/// Fills the data that does not depend on bones.
void paint( const char* call, const Lattice& lattice, const PoseSettings& settings, PoseModel& model )
{
	for ( std::size_t cell = 0; cell < lattice.fill.size(); ++cell )
	{
		const Vec3d at = lattice.massCentre + lattice.restCentre[cell].cast<double>();
		const Vec3 point = at.cast<float>();
		const PosePaint painted = settings.paint ? settings.paint( point.data(), settings.context ) : PosePaint{};
		if ( !( painted.strength >= 0.0f && painted.strength <= 1.0f && painted.largestDistance > 0.0f ) )
		{
			reject(
				ResultCode::BadSettings, std::string( call ) + ": paint must return a strength of 0 to 1 and a largest distance above 0." );
		}
		model.rest.push_back( at );
		model.strength.push_back( painted.strength );
		model.reach.push_back( std::min( painted.largestDistance, std::numeric_limits<float>::max() ) );
		model.fill.push_back( lattice.fill[cell] );
	}
	model.frequency = 2.0 * EIGEN_PI * double( settings.frequency );
	model.dampingRatio = double( settings.dampingRatio );
}

/// Reads the vertices' weights; refuses bad numbers, bones out of range, and weights with the sum 0.
void readWeights( const SkinWeights& given, std::vector<PoseModel::Weights>& vertices )
{
	for ( int v = 0; v < given.vertexCount; ++v )
	{
		PoseModel::Weights& own = vertices.emplace_back();
		double sum = 0.0;
		for ( int k = 0; k < given.perVertex; ++k )
		{
			const std::size_t index = std::size_t( v ) * std::size_t( given.perVertex ) + std::size_t( k );
			const float weight = given.weights[index];
			rejectIf( !( weight >= 0.0f ) || !std::isfinite( weight ), "followBones", "a weight is negative or no finite number." );
			rejectIf( weight > 0.0f && ( given.bones[index] < 0 || given.bones[index] >= given.boneCount ), "followBones",
				"there is no bone of a number that has a weight." );
			own.bone[std::size_t( k )] = weight > 0.0f ? given.bones[index] : 0;
			own.weight[std::size_t( k )] = weight;
			sum += double( weight );
		}
		rejectIf( !( sum > 0.0 ), "followBones", "a vertex has no weight above 0." );
		for ( float& weight : own.weight )
		{
			weight = float( double( weight ) / sum );
		}
	}
}

void follow( SoftBody& body, PoseModel model )
{
	SoftBody::Impl& impl = body.impl();
	impl.follower = std::make_unique<PoseFollower>();
	impl.follower->model = std::make_shared<const PoseModel>( std::move( model ) );
	impl.body->pull().clear();
}

void give( const char* call, SoftBody& body, std::vector<Vec3d> targets, bool jumps )
{
	for ( const Vec3d& target : targets )
	{
		rejectIf( !( target.cwiseAbs().maxCoeff() <= double( kFarthestPosition ) ), call, "a cell would be further out than 1e9 m." );
	}
	PoseFollower& follower = *body.impl().follower;
	const bool isNew = !follower.hasPose || targets != follower.target;
	follower.setTargets( std::move( targets ), jumps );
	if ( isNew && follower.blend > 0.0 )
	{
		body.activate();
	}
}

} // namespace

Status followBones( SoftBody& body, const SkinWeights& weights, const PoseSettings& settings )
{
	return attempt( [&]() {
		insist( body.impl().checkTime( "followBones" ) );
		const BodyTemplate& shape = body.bodyTemplate();
		const SkinBinding& skin = shape.skin();
		checkSettings( "followBones", settings );
		rejectIf(
			skin.start.empty() || shape.vertexCount() == 0, "followBones", "the body's template has no skin (LatticeSettings::skinning)." );
		rejectIf( !weights.bones || !weights.weights || weights.perVertex < 1 || weights.perVertex > PoseModel::kMostBones ||
				weights.boneCount < 1 || weights.vertexCount != shape.vertexCount(),
			"followBones", "it needs bones and weights, 1 to 4 a vertex, for as many vertices as the template has." );
		PoseModel model;
		std::vector<PoseModel::Weights> vertices;
		readWeights( weights, vertices );
		paint( "followBones", shape.lattice(), settings, model );
		model.boneCount = weights.boneCount;
		model.weights = weightsOfCells(
			shape.lattice(), weights.boneCount, int( skin.start.size() ) - 1, skin.start, skin.node, skin.weight, vertices );
		follow( body, std::move( model ) );
	} );
}

Status followTargets( SoftBody& body, const PoseSettings& settings )
{
	return attempt( [&]() {
		insist( body.impl().checkTime( "followTargets" ) );
		checkSettings( "followTargets", settings );
		PoseModel model;
		paint( "followTargets", body.bodyTemplate().lattice(), settings, model );
		follow( body, std::move( model ) );
	} );
}

void stopFollowing( SoftBody& body )
{
	if ( isFollowing( body ) && !body.impl().isInField() )
	{
		body.impl().follower.reset();
		body.impl().body->pull().clear();
		body.activate();
	}
}

bool isFollowing( const SoftBody& body )
{
	return body.impl().follower != nullptr;
}

Status setPose( SoftBody& body, const btTransform* bones, int count, bool jumps )
{
	return attempt( [&]() {
		insist( body.impl().checkTime( "setPose" ) );
		const PoseFollower* const follower = body.impl().follower.get();
		rejectIf( !follower || follower->model->boneCount == 0, "setPose", "the body follows no bones (followBones)." );
		rejectIf( !bones || count != follower->model->boneCount, "setPose", "it needs one transform for each bone given to followBones." );
		for ( int k = 0; k < count; ++k )
		{
			rejectIf( !isFinite( bones[k] ), "setPose", "a transform is not finite." );
		}
		const PoseModel& model = *follower->model;
		std::vector<Vec3d> targets( model.rest.size(), Vec3d::Zero() );
		for ( std::size_t cell = 0; cell < targets.size(); ++cell )
		{
			for ( std::size_t k = 0; k < PoseModel::kMostBones; ++k )
			{
				const float weight = model.weights[cell].weight[k];
				if ( weight > 0.0f )
				{
					const btTransform& bone = bones[model.weights[cell].bone[k]];
					targets[cell] += double( weight ) * ( toMatrix3d( bone.getBasis() ) * model.rest[cell] + toVec3d( bone.getOrigin() ) );
				}
			}
		}
		give( "setPose", body, std::move( targets ), jumps );
	} );
}

Status setTargets( SoftBody& body, const btVector3* positions, int count, bool jumps )
{
	return attempt( [&]() {
		insist( body.impl().checkTime( "setTargets" ) );
		const PoseFollower* const follower = body.impl().follower.get();
		rejectIf( !follower || follower->model->boneCount > 0, "setTargets", "the body follows no targets (followTargets)." );
		rejectIf( !positions || count != int( follower->model->rest.size() ), "setTargets",
			"it needs a position for each cell of the template." );
		std::vector<Vec3d> targets;
		for ( int cell = 0; cell < count; ++cell )
		{
			rejectIf( !isFinite( positions[cell] ), "setTargets", "a position is not finite." );
			targets.push_back( toVec3d( positions[cell] ) );
		}
		give( "setTargets", body, std::move( targets ), jumps );
	} );
}

btVector3 poseTarget( const SoftBody& body, int cell )
{
	const PoseFollower* const follower = body.impl().follower.get();
	const bool isThere = follower && cell >= 0 && cell < int( follower->target.size() );
	return isThere ? toBt( follower->target[std::size_t( cell )] ) : btVector3( 0, 0, 0 );
}

Status setPoseBlend( SoftBody& body, btScalar blend )
{
	return attempt( [&]() {
		insist( body.impl().checkTime( "setPoseBlend" ) );
		PoseFollower* const follower = body.impl().follower.get();
		rejectIf( !follower, "setPoseBlend", "the body follows no pose." );
		rejectIf( !( blend >= 0 && blend <= 1 ), "setPoseBlend", "the blend must be 0 to 1." );
		if ( follower->blend != double( blend ) )
		{
			follower->blend = double( blend );
			body.activate();
		}
	} );
}

btScalar poseBlend( const SoftBody& body )
{
	return body.impl().follower ? btScalar( body.impl().follower->blend ) : btScalar( 0 );
}

PoseForce poseForce( const SoftBody& body )
{
	const PoseFollower* const follower = body.impl().follower.get();
	return follower ? PoseForce{ toBt( follower->force ), toBt( follower->torque ) } : PoseForce{};
}

} // namespace pliant
