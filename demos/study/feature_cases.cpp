// +-----------------------------------------------------------------------------------------------------------------+
// | Each feature off, idle and working.                                                                              |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/feature_cases.h"

namespace pliant_study {

namespace {

constexpr int kEdge = 12;
constexpr double kCell = 0.1;
constexpr int kFirstSteps = 5;

pliant::Fracture breaking( float strain )
{
	pliant::Fracture fracture;
	fracture.rule = pliant::BreakRule::Distance;
	fracture.breakStrain = strain;
	return fracture;
}

pliant::Adaptivity levels( float strain )
{
	pliant::Adaptivity settings;
	settings.coarseLevels = 2;
	settings.refineStrain = strain;
	return settings;
}

class FeatureList
{
public:
	FeatureList()
	{
		add( "plain", "" );
		addSurface();
		addBreaking();
		FeatureCase& plastic = add( "plasticity", "idle: never yields" );
		plastic.material.yieldStrain = 1.0f;
		FeatureCase& flowing = add( "plasticity", "working" );
		flowing.material.yieldStrain = 1e-4f;
		add( "kept volume", "working" ).material.volumeKeeping = 1;
		FeatureCase& coarse = add( "levels", "idle: fine everywhere" );
		coarse.adaptivity = levels( 0 );
		coarse.adaptivity.keepMass = 2; // never a coarse node
		add( "levels", "working: big nodes, nothing changes" ).adaptivity = levels( 1.0f );
		add( "levels", "working: splits and merges" ).adaptivity = levels( 0.002f );
		FeatureCase& far = add( "far levels", "idle: stiffness within reach" );
		far.material.farLevels = 1;
		FeatureCase& reaching = add( "far levels", "working" );
		reaching.material.farLevels = 1;
		reaching.material.youngsModulus = 2e6f;
		add( "implicit", "idle: Automatic, steps explicitly" ).material.elasticity = pliant::Elasticity::Automatic;
		add( "implicit", "working" ).material.elasticity = pliant::Elasticity::Implicit;
		add( "clusters", "working: one for the body" ).material.method = pliant::Method::SingleCluster;
		add( "pins", "working" ).prepare = []( pliant::SoftBody& body ) {
			body.pinNodesInside( btVector3( -1, -1, -1 ), btVector3( 1, btScalar( 0.1 ), 1 ) );
		};
		add( "wider regions", "w 2" ).material.regionHalfWidth = 2;
	}

	const std::vector<FeatureCase>& all() const { return m_all; }

private:
	void addSurface()
	{
		add( "surface", "off: Skinning::None" ).skinning = pliant::Skinning::None;
		m_all.back().isLookedAt = false;
		add( "surface", "idle: nobody looks" ).isLookedAt = false;
	}

	void addBreaking()
	{
		add( "fracture", "idle: strong" ).prepare = []( pliant::SoftBody& body ) {
			static_cast<void>( body.setFracture( breaking( 10.0f ) ) );
		};
		add( "fracture", "working: cut in two" ).prepare = []( pliant::SoftBody& body ) {
			static_cast<void>( body.setFracture( breaking( 10.0f ) ) );
			body.cutPlane( body.massCentre(), btVector3( 1, 0, 0 ) );
		};
		add( "self-collision", "idle: whole" ).prepare = []( pliant::SoftBody& body ) {
			static_cast<void>( body.setSelfCollision( true ) );
		};
		add( "self-collision", "working: a deep cut" ).prepare = []( pliant::SoftBody& body ) {
			static_cast<void>( body.setSelfCollision( true ) );
			body.cutPlane( body.massCentre() + btVector3( 0, btScalar( 0.3 ), 0 ), btVector3( 1, 0, 0 ), btScalar( 0.7 ) );
		};
	}

	FeatureCase& add( const std::string& feature, const std::string& state )
	{
		FeatureCase one;
		one.feature = feature;
		one.state = state;
		one.material.youngsModulus = 2e5f;
		m_all.push_back( one );
		return m_all.back();
	}

	std::vector<FeatureCase> m_all;
};

} // namespace

const std::vector<FeatureCase>& featureCases()
{
	static const FeatureList kList;
	return kList.all();
}

int featureCells()
{
	return kEdge * kEdge * kEdge;
}

std::unique_ptr<SmallWorld> makeFeatureWorld( const FeatureCase& one )
{
	auto world = std::make_unique<SmallWorld>();
	world->addGround();
	const pliant::Skinning skinning = pliant::hasFeature( pliant::Feature::Surface ) ? one.skinning : pliant::Skinning::None;
	pliant::SoftBody* body = world->add(
		cubeTemplate( kEdge, kCell, skinning ), btVector3( 0, btScalar( kEdge * kCell / 2 ), 0 ), one.material, one.adaptivity );
	if ( body == nullptr )
	{
		return nullptr;
	}
	if ( one.prepare )
	{
		one.prepare( *body );
	}
	for ( int k = 0; k < kFirstSteps; ++k )
	{
		world->timedStep( one.isLookedAt );
	}
	return world;
}

} // namespace pliant_study
