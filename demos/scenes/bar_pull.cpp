// +-----------------------------------------------------------------------------------------------------------------+
// | bar_pull: bars stretched until they break, by planes across the largest stretch and by the distance between cells |
// | (Ohta et al. 2009, "Fracturing"). The bars lie at different angles in their lattices, and are rotated so that     |
// | they look alike. They should break at the strain set, at any angle.                                               |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant_demos {

namespace {

constexpr float kBarPullLength = 1.6f, kThickness = 0.32f; // m
constexpr float kBarPullCell = 0.04f;                      // m: forty along, eight across
constexpr int kBarPullCuts = 80;                           // of the mesh's faces: the drawing of a piece ends with its last whole triangles
constexpr float kBarPullGrip = 0.16f, kShoulder = 0.16f;   // m: held, and unbreakable next to it, as a specimen is thicker where it is held
constexpr float kFree = kBarPullLength / 2 - kBarPullGrip; // m from the middle to a grip
constexpr float kBreakStrain = 0.1f;
constexpr float kRate = 0.05f;       // of strain a second: slow compared with the travel time of sound along the bar
constexpr float kRateParted = 0.25f; // faster, so that the gap becomes visible
constexpr double kDrawn = 5.2;       // s of film
constexpr double kMaxStrain = 0.45;  // of bars that have parted: then they are no longer pulled
constexpr btScalar kBarPullHeight = btScalar( 0.35 ), kBarPullApart = btScalar( 0.62 );

struct Specimen
{
	const char* name;
	pliant::BreakRule rule;
	double degrees; ///< angle between the bar and its lattice
	pliant::SoftBody* body = nullptr;
	double z = 0, strain = 0;     ///< present values, m and strain, of the grips
	double first = 0, parted = 0; ///< strains; 0: not yet
	int links = 0;                ///< broken
};

/// Centre and direction of the bar in the mesh's coordinates: the mesh is rotated in the lattice about its own centre, the origin.
struct Shoulders
{
	float along[3];
};

float toughness( const float* point, const float*, void* context )
{
	const Shoulders& bar = *static_cast<const Shoulders*>( context );
	const float at = bar.along[0] * point[0] + bar.along[1] * point[1] + bar.along[2] * point[2];
	return std::abs( at ) > kFree - kShoulder ? std::numeric_limits<float>::infinity() : 1.0f;
}

class BarPull : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.5 ) );
		const pliant::BreakRule rules[] = { pliant::BreakRule::Plane, pliant::BreakRule::Distance };
		for ( const double degrees : { 0.0, 20.0, 45.0 } )
		{
			for ( const pliant::BreakRule rule : rules )
			{
				Specimen bar;
				bar.name = rule == pliant::BreakRule::Plane ? "plane" : "distance";
				bar.rule = rule;
				bar.degrees = degrees;
				m_bars.push_back( bar );
			}
		}
		for ( std::size_t i = 0; i < m_bars.size(); ++i )
		{
			m_bars[i].z = double( kBarPullApart ) * ( double( i ) - 0.5 * double( m_bars.size() - 1 ) );
			if ( !put( stage, m_bars[i] ) )
			{
				return false;
			}
		}
		return true;
	}

	void beforeStep( Stage& stage, double ) override
	{
		constexpr double kStep = 1.0 / 60;
		for ( Specimen& bar : m_bars )
		{
			const bool hasParted = bar.parted > 0;
			const double rate = !hasParted ? double( kRate ) : bar.strain < kMaxStrain ? double( kRateParted ) : 0;
			bar.strain += rate * kStep;
			const btScalar far = btScalar( rate * kStep ) * btScalar( kFree );
			pull( stage, bar, far );
		}
	}

	void afterStep( Stage& stage, double ) override
	{
		for ( const pliant::FractureEvent& event : stage.world().fractureEvents() )
		{
			Specimen& bar = m_bars[std::size_t( event.parent->getUserIndex2() )];
			bar.links += event.links;
			bar.first = bar.first > 0 ? bar.first : bar.strain;
			// A bar that loses splinters has not parted: it has when its two grips are in two bodies.
			bar.parted = bar.parted > 0 || !isApart( stage, bar ) ? bar.parted : bar.strain;
		}
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		FindingTable bars{
			"strain at break over what was set (0.1), by angle to the lattice", { "first break", "parted", "broken links" }, {} };
		FindingTable rules{ "all angles of a rule", { "least", "most", "spread, %" }, {} };
		for ( const Specimen& bar : m_bars )
		{
			bars.rows.push_back( { std::string( bar.name ) + ", " + std::to_string( int( bar.degrees ) ) + " degrees",
				{ bar.first / double( kBreakStrain ), bar.parted / double( kBreakStrain ), double( bar.links ) } } );
		}
		for ( const char* rule : { "plane", "distance" } )
		{
			double least = std::numeric_limits<double>::max(), most = 0;
			for ( const Specimen& bar : m_bars )
			{
				if ( std::string( bar.name ) == rule )
				{
					least = std::min( least, bar.first / double( kBreakStrain ) );
					most = std::max( most, bar.first / double( kBreakStrain ) );
				}
			}
			rules.rows.push_back( { rule, { least, most, 100 * ( most - least ) / least } } );
		}
		return { bars, rules };
	}

	double duration() const override { return kDrawn; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 0.9f, 3.6f, 4.6f }, { 0, 0.1f, 0.1f }, 36.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.35f, 0.80f, 0.30f }, { 0, 0.3f, 0 }, 2.8f }; }

private:
	bool put( Stage& stage, Specimen& bar )
	{
		const float angle = float( bar.degrees ) * SIMD_RADS_PER_DEG, c = std::cos( angle ), s = std::sin( angle );
		pliant_glue::ModelMesh mesh = makeCube( 1, kBarPullCuts );
		for ( std::size_t i = 0; i < mesh.positions.size(); i += 3 )
		{
			const float x = mesh.positions[i] * kBarPullLength, y = mesh.positions[i + 1] * kThickness;
			mesh.positions[i] = c * x - s * y;
			mesh.positions[i + 1] = s * x + c * y;
			mesh.positions[i + 2] *= kThickness;
		}
		Shoulders shoulders{ { c, s, 0 } };
		SoftOrder order;
		order.name = "bar";
		order.mesh = &mesh;
		order.cellSize = kBarPullCell;
		order.material.youngsModulus = 1.0e5f;
		order.material.wobbleDamping = 0;
		order.fracture.rule = bar.rule;
		order.fracture.breakStrain = kBreakStrain;
		order.toughness.fraction = toughness;
		order.toughness.context = &shoulders;
		order.colour = bar.rule == pliant::BreakRule::Plane ? kTeal : kTerracotta;
		order.place = btTransform(
			btQuaternion( btVector3( 0, 0, 1 ), -btScalar( angle ) ), btVector3( 0, kBarPullHeight, btScalar( bar.z ) ) );
		bar.body = stage.addSoft( order );
		if ( bar.body == nullptr )
		{
			return false;
		}
		bar.body->setUserIndex2( int( &bar - m_bars.data() ) );
		mustSucceed( bar.body->setGravity( btVector3( 0, 0, 0 ) ) );
		bar.body->setActivationState( DISABLE_DEACTIVATION );
		const btScalar z = btScalar( bar.z ), high = 1;
		bar.body->pinNodesInside( btVector3( btScalar( -kBarPullLength ), 0, z - kBarPullApart / 2 ),
			btVector3( btScalar( -kFree ), high, z + kBarPullApart / 2 ) );
		bar.body->pinNodesInside( btVector3( btScalar( kFree ), 0, z - kBarPullApart / 2 ),
			btVector3( btScalar( kBarPullLength ), high, z + kBarPullApart / 2 ) );
		for ( int i = 0; i < bar.body->nodeCount(); ++i )
		{
			// Starts with the velocities of uniform stretching, so that no waves run along the bar.
			const btScalar speed = btScalar( kRate ) * bar.body->nodePosition( i ).x();
			mustSucceed( bar.body->applyImpulse( btVector3( speed * bar.body->nodeMass( i ), 0, 0 ), i ) );
		}
		return true;
	}

	/// Moves the grips outward, in whatever pieces they are.
	static void pull( Stage& stage, const Specimen& bar, btScalar far )
	{
		for ( int k = 0; k < stage.world().softBodyCount(); ++k )
		{
			pliant::SoftBody& piece = *stage.world().softBody( k );
			for ( int i = 0; piece.getUserIndex2() == bar.body->getUserIndex2() && i < piece.nodeCount(); ++i )
			{
				if ( piece.isPinned( i ) )
				{
					const btVector3 at = piece.nodePosition( i );
					mustSucceed( piece.driveNode( i, at + btVector3( at.x() > 0 ? far : -far, 0, 0 ) ) );
				}
			}
		}
	}

	static bool isApart( Stage& stage, const Specimen& bar )
	{
		int held = 0;
		for ( int k = 0; k < stage.world().softBodyCount(); ++k )
		{
			const pliant::SoftBody& piece = *stage.world().softBody( k );
			bool isHeld = false;
			for ( int i = 0; piece.getUserIndex2() == bar.body->getUserIndex2() && i < piece.nodeCount(); ++i )
			{
				isHeld = isHeld || piece.isPinned( i );
			}
			held += isHeld ? 1 : 0;
		}
		return held > 1;
	}

	std::vector<Specimen> m_bars;
};

} // namespace

std::unique_ptr<Scene> makeBarPull()
{
	return std::make_unique<BarPull>();
}

} // namespace pliant_demos
