// +-----------------------------------------------------------------------------------------------------------------+
// | flowers: Steinemann et al. 2008, figure 6. Forty flowers in the wind, each of about 140 coarse nodes. Where a     |
// | finger touches one, its nodes are split down to the finest cells; they are merged again when it has come to rest. |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/creatures.h"
#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/scene.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace pliant_demos {

namespace {

constexpr int kColumns = 8, kRows = 5;
constexpr int kPetals = 6;
constexpr btScalar kFlowersSpacing = btScalar( 0.55 );
constexpr int kFlowersCoarseLevels = 2;
constexpr float kFinestCell = 0.0148f;             // m: four in a petal's thickness
constexpr float kPetalFraction = 0.25f;            // of the stem's stiffness
constexpr float kKeepAll = 1e-6f;                  // every block is one node at first, however small its fill
constexpr btScalar kFootHeight = btScalar( 0.06 ); // m of the stem that is held
constexpr btScalar kWind = btScalar( 0.6 );        // m/s^2 on a petal in the strongest gust
constexpr btScalar kFingerThickness = btScalar( 0.10 ), kFingerHeight = btScalar( 0.58 );
constexpr double kFingerStart = 0.5; // s

class Flowers : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		const pliant_glue::ModelMesh mesh = makeFlower( kPetals );
		SoftOrder order;
		order.name = "flower";
		order.mesh = &mesh;
		order.cellSize = kFinestCell;
		order.material.density = 200.0f;
		order.material.youngsModulus = 1.4e4f;
		order.stiffness.fraction = []( const float* point, void* ) { return point[1] > kFlowerHeadFrom + 0.04f ? kPetalFraction : 1.0f; };
		order.material.damping = 3.0f;
		order.material.wobbleDamping = 0.1f;
		order.adaptivity.coarseLevels = kFlowersCoarseLevels;
		order.adaptivity.keepMass = kKeepAll;
		order.adaptivity.softening = pliant::Softening::None; // as in the paper: coarse nodes are stiffer, which keeps stems upright
		order.adaptivity.residual = pliant::ResidualRule::Keep;
		order.adaptivity.refinesOnContact = true;
		order.adaptivity.refineStrain = 0.5f;
		order.adaptivity.mergeFraction = 0.8f;
		order.adaptivity.mergeDelay = 0.4f;
		order.shape = stage.buildShape( order );
		std::mt19937 random( stage.options().seed );
		for ( int i = 0; order.shape != nullptr && i < kColumns * kRows; ++i )
		{
			plant( stage, order, i, mesh, random );
		}
		m_finger = stage.addSphere( kFingerThickness, fingerAt( 0 ), 0, kOak );
		m_nodesAtFirst = m_mostNodes = stage.counts().nodes;
		return order.shape != nullptr && int( m_flowers.size() ) == kColumns * kRows;
	}

	void beforeStep( Stage&, double seconds ) override
	{
		Stage::moveBody( m_finger, btTransform( btQuaternion::getIdentity(), fingerAt( seconds ) ) );
		for ( pliant::SoftBody* flower : m_flowers )
		{
			const btVector3 at = flower->massCentre();
			for ( int i = 0; i < flower->nodeCount(); ++i )
			{
				// A gust runs over the field along x; it meets petals more than stems.
				const double phase = 2.2 * seconds - 1.4 * double( at.x() ) - 0.5 * double( at.z() );
				const btScalar gust = btScalar( 0.35 + 0.65 * std::sin( phase ) ) * kWind;
				const btScalar exposed = std::clamp(
					flower->nodePosition( i ).y() / btScalar( kFlowerHeadMiddle ), btScalar( 0 ), btScalar( 1 ) );
				const btScalar force = gust * exposed * flower->nodeMass( i );
				mustSucceed( flower->applyForce( btVector3( force, 0, force * btScalar( 0.35 * std::sin( 1.7 * phase ) ) ), i ) );
			}
		}
	}

	void afterStep( Stage& stage, double ) override
	{
		m_mostNodes = std::max( m_mostNodes, stage.counts().nodes );
		const pliant::StepReport& report = stage.world().stepReport();
		( report.splits > 0 ? m_touches : m_quiet ).push_back( report.levels );
		m_splits += report.splits;
	}

	std::vector<FindingTable> findings( const Stage& stage ) const override
	{
		const double count = double( m_flowers.size() );
		return { { "flowers", { "nodes each", "nodes", "most nodes", "growth, %" },
					 { { "forty",
						 { m_nodesAtFirst / count, double( m_nodesAtFirst ), double( m_mostNodes ),
							 100.0 * ( m_mostNodes - m_nodesAtFirst ) / m_nodesAtFirst } } } },
			{ "ms", { "step, median", "step, worst", "skin, frame", "skin a flower" },
				{ { "forty",
					{ stage.log().medianStep(), stage.log().longestStep(), stage.log().medianSkinning(),
						stage.log().medianSkinning() / count } } } },
			{ "levels in frames that split nodes, over those that do not, ms (goal: worst 2)",
				{ "frames", "nodes split", "median", "95 %", "worst" },
				{ { "touch",
					{ double( m_touches.size() ), double( m_splits ), costOfTouch( 0.5 ), costOfTouch( 0.95 ), costOfTouch( 1.0 ) } } } } };
	}

	double duration() const override { return 3.0; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 0.4f, 1.75f, 3.7f }, { 0, 0.30f, 0.1f }, 34.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.45f, 0.75f, 0.45f }, { 0, 0.3f, 0 }, 3.4f }; }

private:
	/// ms that this fraction of the frames with splits does not exceed, minus the median of the others.
	double costOfTouch( double fraction ) const
	{
		const auto at = []( std::vector<double> seconds, double part ) {
			std::sort( seconds.begin(), seconds.end() );
			return seconds.empty() ? 0.0 : 1e3 * seconds[std::min( seconds.size() - 1, std::size_t( part * double( seconds.size() ) ) )];
		};
		return at( m_touches, fraction ) - at( m_quiet, 0.5 );
	}

	void plant( Stage& stage, SoftOrder order, int number, const pliant_glue::ModelMesh& mesh, std::mt19937& random )
	{
		const auto next = [&] { return btScalar( random() ) / btScalar( std::mt19937::max() ) - btScalar( 0.5 ); };
		const btScalar x = ( btScalar( number % kColumns ) - btScalar( kColumns - 1 ) / 2 + next() * btScalar( 0.3 ) ) * kFlowersSpacing;
		const btScalar z = ( btScalar( number / kColumns ) - btScalar( kRows - 1 ) / 2 + next() * btScalar( 0.3 ) ) * kFlowersSpacing;
		order.place = btTransform( btQuaternion( btVector3( 0, 1, 0 ), SIMD_2_PI * next() ), btVector3( x, 0, z ) );
		pliant::SoftBody* flower = stage.addSoft( order );
		if ( flower == nullptr )
		{
			return;
		}
		mustSucceed( flower->setGravity( btVector3( 0, 0, 0 ) ) ); // plants have grown under gravity
		flower->pinNodesInside( btVector3( x - 1, -1, z - 1 ), btVector3( x + 1, kFootHeight, z + 1 ) );
		const pliant_glue::Colour petals[] = { kBrick, kOchre, kPlum, kTerracotta };
		std::vector<float> colours;
		for ( std::size_t i = 0; i < mesh.vertexCount(); ++i )
		{
			const bool isHead = mesh.positions[i * 3 + 1] > kFlowerHeadFrom;
			const pliant_glue::Colour& colour = isHead ? petals[( number + number / kColumns ) % 4] : kMoss;
			colours.insert( colours.end(), colour.begin(), colour.end() );
		}
		stage.colourVertices( flower, std::move( colours ) );
		m_flowers.push_back( flower );
	}

	/// From left to right, in and out of the two front rows of heads.
	static btVector3 fingerAt( double seconds )
	{
		const btScalar half = kFlowersSpacing * btScalar( kColumns ) / 2, t = btScalar( std::max( 0.0, seconds - kFingerStart ) );
		const btScalar x = -half - btScalar( 0.3 ) + btScalar( 1.9 ) * t;
		return btVector3(
			x, kFingerHeight, kFlowersSpacing * btScalar( 1.5 ) + btScalar( 0.35 ) * btScalar( std::sin( 2.0 * double( t ) ) ) );
	}

	std::vector<pliant::SoftBody*> m_flowers;
	btRigidBody* m_finger = nullptr;
	std::vector<double> m_touches, m_quiet; ///< s that changes of levels took in each frame
	int m_nodesAtFirst = 0, m_mostNodes = 0, m_splits = 0;
};

} // namespace

std::unique_ptr<Scene> makeFlowers()
{
	return std::make_unique<Flowers>();
}

} // namespace pliant_demos
