// +-----------------------------------------------------------------------------------------------------------------+
// | glob_drop: the experiment of Ohta et al. 2009, figure 6. The same Glob falls on the uniform lattice and, next to  |
// | it, with each method with levels; the colour is the distance to the uniform one.                                  |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"
#include "demos/skin_distance.h"

#include <algorithm>
#include <random>

namespace pliant_demos {

namespace {

constexpr int kGlobDropCells = 1400;
constexpr int kGlobDropCoarseLevels = 2;
constexpr btScalar kGlobDropApart = btScalar( 0.95 ); // m from one Glob to the next
constexpr btScalar kDropHeight = btScalar( 0.7 );     // m, of the middle: about half a bounding-box diagonal to fall
constexpr double kFullColour = 0.15;                  // fraction of the bounding-box diagonal that is drawn in brick
// A step of the paper is one of our substeps; it reports 180 of them after the impact. Before step 80 the bodies have not begun to tumble.
constexpr int kEarlyStep = 20, kLastStep = 45; // game steps of four substeps
constexpr int kReportEvery = 5;
constexpr float kRefineStrain = 0.15f;

struct Method
{
	const char* name;
	pliant::Adaptivity adaptivity;
};

std::vector<Method> methods()
{
	pliant::Adaptivity ours;
	ours.coarseLevels = kGlobDropCoarseLevels;
	ours.residual = pliant::ResidualRule::Soften; // a hard fall leaves lumps with a softer residual
	pliant::Adaptivity refined = ours;
	refined.refineStrain = kRefineStrain;
	return { { "Steinemann", pliant::steinemannAdaptivity( kGlobDropCoarseLevels ) },
		{ "Ohta", pliant::ohtaAdaptivity( kGlobDropCoarseLevels ) }, { "ours", ours }, { "ours, refining", refined } };
}

std::string heading( std::string what, int step )
{
	return what.append( std::to_string( step ) );
}

class GlobDrop : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		const pliant_glue::ModelMesh mesh = makeGlob();
		const std::vector<Method> compared = methods();
		m_left = -kGlobDropApart * btScalar( compared.size() ) / 2;
		SoftOrder order;
		order.name = "Glob";
		order.mesh = &mesh;
		order.cells = kGlobDropCells;
		order.material.density = 300.0f;
		order.material.youngsModulus = 2.3e4f; // waves of 7 m/s: twice the velocity of the impact
		order.material.damping = 2.0f;
		order.material.wobbleDamping = 0.0f; // the papers' bodies are undamped
		order.shape = stage.buildShape( order );
		if ( order.shape == nullptr )
		{
			return false;
		}
		stage.setName( "uniform lattice" );
		m_reference = drop( stage, order, 0 );
		for ( const Method& method : compared )
		{
			m_sides.push_back( std::make_unique<Stage>( stage.options(), method.name ) );
			order.adaptivity = method.adaptivity;
			m_bodies.push_back( drop( *m_sides.back(), order, int( m_sides.size() ) ) );
		}
		m_errors.resize( m_bodies.size() );
		m_diagonal = m_reference == nullptr ? 1 : boxDiagonal( *m_reference );
		return m_reference != nullptr && std::find( m_bodies.begin(), m_bodies.end(), nullptr ) == m_bodies.end();
	}

	std::vector<Stage*> sideStages() override
	{
		std::vector<Stage*> sides;
		std::transform( m_sides.begin(), m_sides.end(), std::back_inserter( sides ), []( const auto& side ) { return side.get(); } );
		return sides;
	}

	void afterStep( Stage& stage, double ) override
	{
		const bool isTouching = stage.world().stepReport().softContacts > 0;
		if ( m_sinceImpact == 0 && !isTouching )
		{
			return;
		}
		++m_sinceImpact;
		if ( m_sinceImpact % kReportEvery == 0 && m_sinceImpact <= kLastStep )
		{
			stage.skin();
			for ( std::size_t i = 0; i < m_bodies.size(); ++i )
			{
				m_sides[i]->skin();
				m_errors[i].push_back( distanceOf( i ) );
			}
		}
	}

	void beforePicture( Stage&, pliant_glue::DrawList& ) override
	{
		for ( std::size_t i = 0; i < m_bodies.size(); ++i )
		{
			m_sides[i]->colourVertices( m_bodies[i], heatColours( distanceOf( i ).vertex, kFullColour * m_diagonal ) );
		}
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		FindingTable means{
			"distance to the uniform lattice, mean over the skin, share of the bounding-box diagonal, by game steps after the impact", {},
			{} };
		FindingTable spreads{ "the same: standard deviation, and mean with the body's middle taken off", {}, {} };
		for ( std::size_t i = 0; i < m_bodies.size(); ++i )
		{
			FindingTable::Row mean{ m_sides[i]->name(), {} }, spread{ m_sides[i]->name(), {} };
			for ( std::size_t k = 0; k < m_errors[i].size(); ++k )
			{
				const int step = int( k + 1 ) * kReportEvery;
				const SkinDistance& error = m_errors[i][k];
				mean.values.push_back( error.mean / m_diagonal );
				if ( i == 0 )
				{
					means.columns.push_back( heading( "+", step ) );
				}
				if ( step == kEarlyStep || step == kLastStep )
				{
					spread.values.insert( spread.values.end(), { error.deviation / m_diagonal, error.shape / m_diagonal } );
					if ( i == 0 )
					{
						spreads.columns.insert( spreads.columns.end(), { heading( "std +", step ), heading( "shape +", step ) } );
					}
				}
			}
			means.rows.push_back( std::move( mean ) );
			spreads.rows.push_back( std::move( spread ) );
		}
		return { means, spreads };
	}

	double duration() const override { return 1.5; }
	int slowness() const override { return 2; }
	pliant_glue::DrawCamera camera( double ) const override { return { { -0.1f, 1.15f, 5.1f }, { -0.1f, 0.42f, 0 }, 31.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.35f, 0.80f, 0.55f }, { 0, 0.5f, 0 }, 3.6f }; }

private:
	SkinDistance distanceOf( std::size_t i ) const
	{
		return skinDistance( *m_bodies[i], *m_reference, btVector3( kGlobDropApart * btScalar( i + 1 ), 0, 0 ) );
	}

	pliant::SoftBody* drop( Stage& stage, SoftOrder order, int place ) const
	{
		// The seed determines on which side it falls: the motion after the impact is chaotic, and one run proves nothing.
		std::mt19937 random( stage.options().seed );
		const auto next = [&] { return btScalar( random() ) / btScalar( std::mt19937::max() ) - btScalar( 0.5 ); };
		const btVector3 axis = btVector3( next(), next(), next() ).normalized();
		const btQuaternion turn( axis, SIMD_2_PI * next() );
		order.place = btTransform( turn, btVector3( m_left + kGlobDropApart * btScalar( place ), kDropHeight, 0 ) );
		order.colour = kStone;
		stage.addGround( btScalar( 0.5 ) );
		return stage.addSoft( order );
	}

	btScalar m_left = 0;
	pliant::SoftBody* m_reference = nullptr;
	std::vector<std::unique_ptr<Stage>> m_sides;
	std::vector<pliant::SoftBody*> m_bodies;
	std::vector<std::vector<SkinDistance>> m_errors; // of each body, one each kReportEvery steps
	double m_diagonal = 1;
	int m_sinceImpact = 0;
};

} // namespace

std::unique_ptr<Scene> makeGlobDrop()
{
	return std::make_unique<GlobDrop>();
}

} // namespace pliant_demos
