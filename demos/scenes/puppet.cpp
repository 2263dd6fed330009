// +-----------------------------------------------------------------------------------------------------------------+
// | puppet: a soft figure that follows the pose of ten bones, with weak springs for its belly and cheeks. It dances,   |
// | is released in mid-stride and falls like a ragdoll, and is driven by its pose again.                               |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/solids.h"

#include <pliant/game/skeleton.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant_demos {

namespace {

constexpr int kCells = 2400;
constexpr double kLetGoAt = 3.0, kTakenUpFrom = 4.6, kTakenUpAt = 6.0; // s
constexpr btScalar kStride = btScalar( 0.8 );                          // m/s, along x, while it dances
constexpr float kFlabby = 0.06f;                                       // strength of belly and cheeks

/// The bones: each from a joint to its end, with its parent.
struct Bone
{
	const char* name;
	int parent;
	Point joint, end;
	float radius; ///< m, of the material around it
};

constexpr std::array<Bone, 10> kBones = { {
	{ "trunk", -1, { 0, 0.86f, 0 }, { 0, 1.26f, 0 }, 0.16f },
	{ "head", 0, { 0, 1.40f, 0 }, { 0, 1.60f, 0.01f }, 0.15f },
	{ "left upper arm", 0, { 0.21f, 1.29f, 0 }, { 0.46f, 1.22f, 0 }, 0.075f },
	{ "left forearm", 2, { 0.46f, 1.22f, 0 }, { 0.74f, 1.14f, 0 }, 0.062f },
	{ "right upper arm", 0, { -0.21f, 1.29f, 0 }, { -0.46f, 1.22f, 0 }, 0.075f },
	{ "right forearm", 4, { -0.46f, 1.22f, 0 }, { -0.74f, 1.14f, 0 }, 0.062f },
	{ "left thigh", 0, { 0.11f, 0.80f, 0 }, { 0.14f, 0.46f, 0 }, 0.105f },
	{ "left shin", 6, { 0.14f, 0.46f, 0 }, { 0.16f, 0.09f, 0 }, 0.075f },
	{ "right thigh", 0, { -0.11f, 0.80f, 0 }, { -0.14f, 0.46f, 0 }, 0.105f },
	{ "right shin", 8, { -0.14f, 0.46f, 0 }, { -0.16f, 0.09f, 0 }, 0.075f },
} };

constexpr Point kBelly = { 0, 0.95f, 0.13f }, kCheeks[2] = { { 0.08f, 1.55f, 0.11f }, { -0.08f, 1.55f, 0.11f } };

float distance( const Point& a, const Point& b )
{
	return std::hypot( a[0] - b[0], a[1] - b[1], a[2] - b[2] );
}

float distanceTo( const Bone& bone, const Point& p )
{
	float along = 0, square = 0;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		along += ( p[k] - bone.joint[k] ) * ( bone.end[k] - bone.joint[k] );
		square += ( bone.end[k] - bone.joint[k] ) * ( bone.end[k] - bone.joint[k] );
	}
	const float t = std::clamp( along / square, 0.0f, 1.0f );
	Point at;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		at[k] = bone.joint[k] + t * ( bone.end[k] - bone.joint[k] );
	}
	return distance( p, at );
}

pliant_glue::ModelMesh makeFigure()
{
	const auto field = []( const Point& p ) {
		float inside = rod( p, kBones[0].joint, kBones[0].end, 0.165f, 0.15f );
		inside = join(
			inside, ellipsoid( p, kBelly, { Point{ 1, 0, 0 }, Point{ 0, 1, 0 }, Point{ 0, 0, 1 } }, { 0.19f, 0.17f, 0.16f } ), 0.06f );
		for ( std::size_t k = 1; k < kBones.size(); ++k )
		{
			const Bone& bone = kBones[k];
			inside = join( inside, rod( p, bone.joint, bone.end, bone.radius, bone.radius * 0.92f ), k == 1 ? 0.05f : 0.04f );
		}
		inside = join( inside, rod( p, { 0, 1.2f, 0 }, { 0, 1.45f, 0 }, 0.08f, 0.08f ), 0.04f );
		for ( const float side : { -1.0f, 1.0f } )
		{
			inside = join( inside, rod( p, { side * 0.16f, 0.06f, -0.02f }, { side * 0.17f, 0.055f, 0.14f }, 0.06f, 0.055f ), 0.03f );
			inside = join( inside,
				ellipsoid(
					p, { side * 0.08f, 1.55f, 0.11f }, { Point{ 1, 0, 0 }, Point{ 0, 1, 0 }, Point{ 0, 0, 1 } }, { 0.07f, 0.06f, 0.06f } ),
				0.02f );
		}
		return inside;
	};
	pliant_glue::ModelMesh mesh = marchSurface( field, { -0.95f, -0.1f, -0.35f }, { 0.95f, 1.95f, 0.45f }, 0.022f );
	mesh.name = "figure";
	return mesh;
}

/// The four nearest bones of each vertex, by their distances.
struct Weights
{
	std::vector<int> bones;
	std::vector<float> weights;

	explicit Weights( const pliant_glue::ModelMesh& mesh )
	{
		for ( std::size_t v = 0; v < mesh.vertexCount(); ++v )
		{
			const Point p = { mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2] };
			std::array<std::pair<float, int>, kBones.size()> near;
			for ( std::size_t k = 0; k < kBones.size(); ++k )
			{
				near[k] = { std::max( distanceTo( kBones[k], p ) - kBones[k].radius, 0.0f ), int( k ) };
			}
			std::sort( near.begin(), near.end() );
			for ( std::size_t k = 0; k < 4; ++k )
			{
				bones.push_back( near[k].second );
				weights.push_back( std::pow( 1.0f + near[k].first / 0.02f, -4.0f ) );
			}
		}
	}
	pliant::SkinWeights view( int vertexCount ) const { return { bones.data(), weights.data(), 4, vertexCount, int( kBones.size() ) }; }
};

pliant::PosePaint paint( const float* point, void* )
{
	const Point p = { point[0], point[1], point[2] };
	const float near = std::min( { distance( p, kBelly ) - 0.1f, distance( p, kCheeks[0] ), distance( p, kCheeks[1] ) } );
	const float t = std::clamp( near / 0.12f, 0.0f, 1.0f );
	return { kFlabby + ( 1.0f - kFlabby ) * t, 0.25f };
}

/// The bones' transforms from the bind pose to the world.
std::array<btTransform, kBones.size()> poseAt( double seconds )
{
	const double beat = 2.0 * 3.14159265358979 * seconds * 1.25, grown = std::min( 1.0, seconds / 0.8 );
	const auto swing = [&]( double size, double phase, double times = 1.0 ) {
		return btScalar( grown * size * std::sin( times * beat + phase ) );
	};
	const btVector3 x( 1, 0, 0 ), y( 0, 1, 0 ), z( 0, 0, 1 );
	const double lift = 0.10 + 0.07 * grown * std::abs( std::sin( beat ) ), walked = double( kStride ) * std::min( seconds, kLetGoAt );
	std::array<btQuaternion, kBones.size()> turn;
	turn.fill( btQuaternion::getIdentity() );
	turn[0] = btQuaternion( y, swing( 0.35, 0 ) ) * btQuaternion( z, swing( 0.12, 1.0 ) );
	turn[1] = btQuaternion( x, swing( 0.2, 0.5, 2.0 ) ) * btQuaternion( z, swing( 0.2, 0 ) );
	turn[2] = btQuaternion( z, swing( 0.7, 0.3 ) ) * btQuaternion( y, swing( 0.5, 1.0 ) );
	turn[3] = btQuaternion( z, swing( 0.5, 1.1 ) + btScalar( 0.5 * grown ) );
	turn[4] = btQuaternion( z, swing( 0.7, 0.3 ) ) * btQuaternion( y, swing( 0.5, 1.0 ) );
	turn[5] = btQuaternion( z, swing( 0.5, 1.1 ) - btScalar( 0.5 * grown ) );
	turn[6] = btQuaternion( x, swing( 0.55, 0 ) );
	turn[7] = btQuaternion( x, btScalar( 0.4 * grown ) + swing( 0.4, 1.6 ) );
	turn[8] = btQuaternion( x, -swing( 0.55, 0 ) );
	turn[9] = btQuaternion( x, btScalar( 0.4 * grown ) - swing( 0.4, 1.6 ) );
	std::array<btTransform, kBones.size()> bones;
	for ( std::size_t k = 0; k < kBones.size(); ++k )
	{
		const Bone& bone = kBones[k];
		const btVector3 joint( bone.joint[0], bone.joint[1], bone.joint[2] );
		const btTransform about( turn[k], joint - quatRotate( turn[k], joint ) );
		const btTransform root( btQuaternion::getIdentity(), btVector3( btScalar( walked - 1.2 ), btScalar( lift ), 0 ) );
		bones[k] = ( bone.parent < 0 ? root : bones[std::size_t( bone.parent )] ) * about;
	}
	return bones;
}

class Puppet : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.8 ) );
		stage.addBox( btVector3( btScalar( 0.5 ), btScalar( 0.3 ), btScalar( 0.9 ) ),
			btTransform( btQuaternion::getIdentity(), btVector3( btScalar( 1.75 ), btScalar( 0.15 ), 0 ) ), 25, kSlate );
		const pliant_glue::ModelMesh mesh = makeFigure();
		SoftOrder order;
		order.name = "figure";
		order.mesh = &mesh;
		order.cells = kCells;
		order.place = btTransform( btQuaternion::getIdentity(), btVector3( btScalar( -1.2 ), btScalar( 0.1 ), 0 ) );
		order.material.youngsModulus = 2.5e4f;
		order.material.density = 300.0f;
		order.material.damping = 4.0f;
		order.friction = btScalar( 0.8 );
		order.colour = kTerracotta;
		m_body = stage.addSoft( order );
		if ( m_body == nullptr )
		{
			return false;
		}
		const Weights weights( mesh );
		pliant::PoseSettings settings;
		settings.frequency = 12.0f;
		settings.dampingRatio = 0.25f;
		settings.paint = paint;
		mustSucceed( pliant::followBones( *m_body, weights.view( int( mesh.vertexCount() ) ), settings ) );
		return true;
	}

	void beforeStep( Stage&, double seconds ) override
	{
		const bool isFree = seconds >= kLetGoAt && seconds < kTakenUpFrom;
		const double taken = std::clamp( ( seconds - kTakenUpFrom ) / ( kTakenUpAt - kTakenUpFrom ), 0.0, 1.0 );
		mustSucceed( pliant::setPoseBlend( *m_body, btScalar( isFree ? 0.0 : seconds < kLetGoAt ? 1.0 : taken * taken ) ) );
		const auto bones = poseAt( seconds + 1.0 / 60.0 );
		mustSucceed( pliant::setPose( *m_body, bones.data(), int( bones.size() ) ) );
		m_speedBefore = m_body->linearVelocity();
	}

	void afterStep( Stage&, double seconds ) override
	{
		double square = 0;
		for ( int node = 0; node < m_body->nodeCount(); ++node )
		{
			const btVector3 off = m_body->nodePosition( node ) - pliant::poseTarget( *m_body, m_body->cellOfNode( node ) );
			square += double( off.length2() );
		}
		const double away = std::sqrt( square / m_body->nodeCount() );
		const std::size_t phase = seconds < kLetGoAt ? 0 : seconds < kTakenUpAt ? 1 : 2;
		m_away[phase] = phase == 1 ? std::max( m_away[phase], away ) : m_away[phase] + away;
		++m_steps[phase];
		if ( seconds >= kLetGoAt && m_handOver.isZero() )
		{
			m_handOver = m_body->linearVelocity() - m_speedBefore;
		}
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		FindingTable table{ "root mean square distance from the pose, m", { "distance" }, {} };
		table.rows.push_back( { "mean while it dances", { m_away[0] / std::max( 1, m_steps[0] ) } } );
		table.rows.push_back( { "most while it is free", { m_away[1] } } );
		table.rows.push_back( { "mean after it is taken up", { m_away[2] / std::max( 1, m_steps[2] ) } } );
		FindingTable handOver{ "change of the centre's velocity in the step in which it is let go, m/s", { "along x", "up" }, {} };
		handOver.rows.push_back( { "hand-over", { double( m_handOver.x() ), double( m_handOver.y() ) } } );
		return { table, handOver };
	}

	double duration() const override { return 8.0; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 0.9f, 1.5f, 4.6f }, { 0.5f, 0.85f, 0 }, 34.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.45f, 0.8f, 0.5f }, { 0.4f, 0.6f, 0 }, 3.2f }; }

private:
	pliant::SoftBody* m_body = nullptr;
	btVector3 m_speedBefore = btVector3( 0, 0, 0 ), m_handOver = btVector3( 0, 0, 0 );
	double m_away[3] = {};
	int m_steps[3] = {};
};

} // namespace

std::unique_ptr<Scene> makePuppet()
{
	return std::make_unique<Puppet>();
}

} // namespace pliant_demos
