// +-----------------------------------------------------------------------------------------------------------------+
// | sphere_crack: Ohta et al. 2009, figure 4. The same cracks in four spheres, drawn as bricks, by Marching Squares, |
// | as exact faces and as exact faces with noise. They are pulled apart in the air and then fall.                    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant_demos {

namespace {

constexpr float kDiameter = 0.8f; // m
constexpr float kSphereCrackCell = kDiameter / 11;
constexpr int kSubdivisions = 4;
constexpr btScalar kSphereCrackApart = btScalar( 1.25 );     // m from one to the next
constexpr btScalar kSphereCrackHeight = btScalar( 0.75 );    // m
constexpr double kCracksAt = 0.4, kStopsAt = 1.2;            // s
constexpr double kFallsAt = 5.2, kSphereCrackDuration = 6.6; // s
constexpr double kNearFrom = 1.4, kNearTo = 4.6;             // s: the camera passes them at a short distance
constexpr btScalar kSphereCrackPull = btScalar( 1.4 );       // m/s for each metre from the middle

struct Way
{
	const char* name;
	pliant::CrackFaces faces;
	float noise;
	int subdivision;
	pliant::SoftBody* body = nullptr;
};

float smooth( double t )
{
	const float s = float( std::clamp( t, 0.0, 1.0 ) );
	return s * s * ( 3 - 2 * s );
}

class SphereCrack : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.7 ) );
		const pliant_glue::ModelMesh mesh = makeSphere( kDiameter, kSubdivisions );
		for ( std::size_t i = 0; i < m_ways.size(); ++i )
		{
			Way& way = m_ways[i];
			SoftOrder order;
			order.name = way.name;
			order.mesh = &mesh;
			order.cellSize = kSphereCrackCell;
			order.cracks.faces = way.faces;
			order.cracks.noiseAmplitude = way.noise;
			order.cracks.subdivision = way.subdivision;
			order.material.density = 600.0f;
			order.material.youngsModulus = 2.0e5f;
			order.material.damping = 40.0f;
			order.colour = kSlate;
			order.insideColour = kTerracotta;
			order.place = btTransform( btQuaternion::getIdentity(), btVector3( placeOf( i ), kSphereCrackHeight, 0 ) );
			way.body = stage.addSoft( order );
			if ( way.body == nullptr )
			{
				return false;
			}
			way.body->setUserIndex2( int( i ) );
			mustSucceed( way.body->setGravity( btVector3( 0, 0, 0 ) ) ); // pieces inherit it
		}
		return true;
	}

	void beforeStep( Stage& stage, double seconds ) override
	{
		const auto isAt = [seconds]( double when ) { return std::abs( seconds - when ) < 1.0 / 120; };
		if ( isAt( kCracksAt ) )
		{
			crack();
		}
		for ( int k = 0; k < stage.world().softBodyCount(); ++k )
		{
			pliant::SoftBody& piece = *stage.world().softBody( k );
			if ( isAt( kCracksAt + 1.0 / 60 ) )
			{
				const btVector3 middle( placeOf( std::size_t( piece.getUserIndex2() ) ), kSphereCrackHeight, 0 );
				mustSucceed( piece.setLinearVelocity( ( piece.massCentre() - middle ) * kSphereCrackPull ) );
			}
			else if ( isAt( kStopsAt ) )
			{
				mustSucceed( piece.setLinearVelocity( btVector3( 0, 0, 0 ) ) );
			}
			else if ( isAt( kFallsAt ) )
			{
				piece.clearGravity();
				piece.activate( true );
			}
		}
	}

	void afterStep( Stage& stage, double ) override
	{
		for ( const pliant::FractureEvent& event : stage.world().fractureEvents() )
		{
			Found& found = m_found[std::size_t( event.parent->getUserIndex2() )];
			found.links += event.links;
			found.pieces += double( event.fragments.size() );
			found.area += event.area;
		}
	}

	std::vector<FindingTable> findings( const Stage& stage ) const override
	{
		std::array<double, kWays> triangles{};
		auto& world = const_cast<pliant::SoftBodyWorld&>( stage.world() );
		for ( int k = 0; k < world.softBodyCount(); ++k )
		{
			triangles[std::size_t( world.softBody( k )->getUserIndex2() )] += double( world.softBody( k )->surface().triangleCount );
		}
		FindingTable table{ "the same cracks, drawn in four ways", { "pieces", "links", "crack, m^2", "triangles" }, {} };
		for ( std::size_t i = 0; i < m_ways.size(); ++i )
		{
			table.rows.push_back(
				{ m_ways[i].name, { m_found[i].pieces + 1, double( m_found[i].links ), m_found[i].area, triangles[i] } } );
		}
		return { table };
	}

	double duration() const override { return kSphereCrackDuration; }

	/// From all of them to each at a short distance, and back.
	pliant_glue::DrawCamera camera( double seconds ) const override
	{
		const float near = smooth( ( seconds - kStopsAt ) / 0.8 ) - smooth( ( seconds - kNearTo ) / 0.6 );
		const float along = float( std::clamp( ( seconds - kNearFrom ) / ( kNearTo - kNearFrom ), 0.0, 1.0 ) );
		const float side = near * ( 3.4f * along - 1.7f );
		return { { side + 0.3f * near, 1.55f - 0.25f * near, 5.6f - 3.3f * near }, { side, 0.62f + 0.08f * near, 0 }, 32.0f };
	}
	pliant_glue::DrawLight light() const override { return { { -0.35f, 0.80f, 0.50f }, { 0, 0.4f, 0 }, 3.2f }; }

private:
	static constexpr std::size_t kWays = 4;
	struct Found
	{
		int links = 0;
		double pieces = 0, area = 0;
	};

	static btScalar placeOf( std::size_t way ) { return kSphereCrackApart * ( btScalar( way ) - btScalar( 0.5 ) * btScalar( kWays - 1 ) ); }

	/// Three planes, none of which is parallel to the lattice.
	void crack()
	{
		const btQuaternion turn( btVector3( 1, 2, btScalar( 0.5 ) ).normalized(), btScalar( -0.6 ) );
		const btVector3 normals[3] = {
			quatRotate( turn, btVector3( 1, 0, 0 ) ), quatRotate( turn, btVector3( 0, 1, 0 ) ), quatRotate( turn, btVector3( 0, 0, 1 ) ) };
		const btScalar offsets[3] = { btScalar( 0.04 ), btScalar( -0.025 ), btScalar( 0.015 ) };
		for ( std::size_t i = 0; i < m_ways.size(); ++i )
		{
			for ( int k = 0; k < 3; ++k )
			{
				m_ways[i].body->cutPlane( btVector3( placeOf( i ), kSphereCrackHeight, 0 ) + normals[k] * offsets[k], normals[k] );
			}
		}
	}

	std::array<Way, kWays> m_ways = {
		{ { "bricks", pliant::CrackFaces::Bricks, 0.0f, 1 }, { "Marching Squares", pliant::CrackFaces::MarchingSquares, 0.0f, 1 },
			{ "exact", pliant::CrackFaces::Exact, 0.0f, 1 }, { "exact, noise", pliant::CrackFaces::Exact, 0.3f, 3 } } };
	std::array<Found, kWays> m_found;
};

} // namespace

std::unique_ptr<Scene> makeSphereCrack()
{
	return std::make_unique<SphereCrack>();
}

} // namespace pliant_demos
