// Frames, poses and ghosts as bytes.

#include "world/bodies/frame_patch.h"
#include "world/io/world_snapshot.h"

#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>

namespace pliant {

void archive( Archive& archive, Frame::Node& part )
{
	archive( part.node, part.rest );
}

void WorldSnapshot::FrameRecord::archive( Archive& archive )
{
	archive( rigid, body, frame.radius, frame.middle, frame.patch, frame.at, frame.rotation, frame.mean, frame.mass, frame.inertia,
		frame.force, frame.unseen, frame.mobility );
}

void WorldSnapshot::collectFrames()
{
	for ( const Frame& frame : m_bodies.frames.all() )
	{
		if ( frame.isInWorld )
		{
			m_frames.emplace_back();
			m_frames.back().rigid = indexOf( frame.rigid.get() );
			m_frames.back().body = indexOf( frame.body );
			m_frames.back().frame.copyState( frame );
		}
	}
}

void WorldSnapshot::checkFrames( Archive& archive )
{
	const std::vector<Frame>& live = m_bodies.frames.all();
	const auto inWorld = std::count_if( live.begin(), live.end(), []( const Frame& frame ) { return frame.isInWorld; } );
	archive.require( std::size_t( inWorld ) == m_frames.size(), "The world has other frames than when it was saved." );
	std::vector<int> rigid;
	for ( const FrameRecord& record : m_frames )
	{
		const bool isRigid = isObject( record.rigid ) && !isSoft( record.rigid );
		const btRigidBody* const body = isRigid ? btRigidBody::upcast( m_entries[std::size_t( record.rigid )].object ) : nullptr;
		archive.require( body && m_bodies.frames.find( *body ), "The world lacks a frame of the snapshot." );
		const Frame& frame = record.frame;
		const auto isPart = [&]( const Frame::Node& part ) { return isBodyNode( record.body, part.node ) && part.rest.allFinite(); };
		archive.require( record.body < 0 || ( frame.patch.size() >= 3 && std::all_of( frame.patch.begin(), frame.patch.end(), isPart ) ),
			"A frame has nodes that are not there." );
		archive.require( frame.middle.allFinite() && frame.at.allFinite() && frame.rotation.coeffs().allFinite() &&
				frame.mean.allFinite() && frame.inertia.allFinite() && frame.force.allFinite() && frame.unseen.allFinite() &&
				frame.mobility.allFinite() && frame.mass > 0.0 && std::isfinite( frame.mass ) && frame.radius >= 0.0,
			"A number of a frame is not valid." );
		rigid.push_back( record.rigid );
	}
	std::sort( rigid.begin(), rigid.end() );
	archive.require( std::adjacent_find( rigid.begin(), rigid.end() ) == rigid.end(), "Two frames have the same rigid body." );
}

void WorldSnapshot::restoreFrames()
{
	for ( std::size_t k = 0; k < m_frames.size(); ++k )
	{
		const FrameRecord& record = m_frames[k];
		SoftBody* const body = record.body >= 0 ? asSoftBody( m_entries[std::size_t( record.body )].object ) : nullptr;
		const btRigidBody& rigid = *btRigidBody::upcast( m_entries[std::size_t( record.rigid )].object );
		m_bodies.frames.restore( k, rigid, record.frame, body, m_step.m_parts.world );
	}
	m_bodies.frames.restoreMobilities();
}

void archive( Archive& archive, PoseModel::Weights& weights )
{
	archive( weights.bone, weights.weight );
}

void archive( Archive& archive, PoseModel& model )
{
	archive( model.boneCount, model.weights, model.rest, model.strength, model.reach, model.fill, model.frequency, model.dampingRatio );
}

void PoseFollower::archiveMake( Archive& archive, std::size_t cells )
{
	if ( !archive.isReading() )
	{
		archive.write( *model );
		return;
	}
	PoseModel read;
	archive( read );
	bool isSound = read.boneCount >= 0 && read.weights.size() == ( read.boneCount > 0 ? cells : 0u ) && read.rest.size() == cells &&
		read.strength.size() == cells && read.reach.size() == cells && read.fill.size() == cells && read.frequency > 0.0 &&
		std::isfinite( read.dampingRatio );
	for ( const PoseModel::Weights& weights : read.weights )
	{
		isSound = isSound &&
			std::all_of( weights.bone.begin(), weights.bone.end(), [&read]( int bone ) { return bone >= 0 && bone < read.boneCount; } );
	}
	archive.require( isSound, "A pose does not fit its body." );
	model = std::make_shared<const PoseModel>( std::move( read ) );
}

void PoseFollower::archiveState( Archive& archive )
{
	archive( blend, hasPose, before, target, isMoving, impulse, angularImpulse, time, force, torque );
	const std::size_t count = hasPose ? model->rest.size() : 0;
	archive.require( before.size() == count && target.size() == count && blend >= 0.0 && blend <= 1.0, "A pose does not fit its body." );
	for ( const std::vector<Vec3d>* const positions : { &before, &target } )
	{
		archive.require( std::all_of( positions->begin(), positions->end(), []( const Vec3d& at ) { return at.allFinite(); } ),
			"A number is not finite." );
	}
}

btOverlappingPairCache* WorldSnapshot::cacheOf( btCollisionObject& object )
{
	static const btPairCachingGhostObject known;
	return btGhostObject::upcast( &object ) && isSameClass( object, known )
		? static_cast<btPairCachingGhostObject&>( object ).getOverlappingPairCache()
		: nullptr;
}

void WorldSnapshot::collectGhosts()
{
	const btCollisionObjectArray& objects = m_step.m_parts.objects;
	for ( int k = 0; k < objects.size(); ++k )
	{
		const btGhostObject* const ghost = btGhostObject::upcast( objects[k] );
		if ( !ghost )
		{
			continue;
		}
		GhostRecord record;
		record.ghost = k;
		for ( int n = 0; n < ghost->getNumOverlappingObjects(); ++n )
		{
			const int object = indexOf( ghost->getOverlappingObject( n ) );
			object >= 0 ? record.overlaps.push_back( object ) : void();
		}
		m_ghosts.push_back( std::move( record ) );
		btOverlappingPairCache* const cache = cacheOf( *objects[k] );
		cache ? collectPairsOf( *cache, k ) : void();
	}
}

void WorldSnapshot::checkGhosts( Archive& archive ) const
{
	const auto isGhost = [this]( int object ) {
		return isObject( object ) && !isSoft( object ) && btGhostObject::upcast( m_entries[std::size_t( object )].object );
	};
	for ( const GhostRecord& record : m_ghosts )
	{
		const auto isAny = [this]( int object ) { return isObject( object ); };
		archive.require( isGhost( record.ghost ) && std::all_of( record.overlaps.begin(), record.overlaps.end(), isAny ),
			"A ghost is no ghost, or overlaps what is not there." );
	}
	int before = -1;
	for ( const PairRecord& pair : m_pairs )
	{
		const int ghost = pair.ghost;
		archive.require( ghost >= before && ( ghost < 0 || ( isGhost( ghost ) && cacheOf( *m_entries[std::size_t( ghost )].object ) ) ),
			"A pair belongs to a ghost that has none." );
		archive.require( ghost < 0 || ( ( pair.first == ghost ) != ( pair.second == ghost ) ), "A ghost has a pair of others." );
		before = std::max( before, ghost );
	}
}

void WorldSnapshot::restoreGhosts()
{
	for ( const GhostRecord& record : m_ghosts )
	{
		btGhostObject& ghost = *btGhostObject::upcast( m_entries[std::size_t( record.ghost )].object );
		btOverlappingPairCache* const cache = cacheOf( ghost );
		cache ? endPairs( *cache ) : void();
		ghost.getOverlappingPairs().resizeNoInitialize( 0 );
		for ( const int object : record.overlaps )
		{
			ghost.getOverlappingPairs().push_back( m_entries[std::size_t( object )].object );
		}
	}
}

} // namespace pliant
