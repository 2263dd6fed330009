// +-----------------------------------------------------------------------------------------------------------------+
// | plastic_block: after Steinemann et al. 2008, figure 5. A ball, an edge and a corner press into a block one after   |
// | the other. Its material is elastic as yet: it springs back, and the table says so.                               |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pliant_demos {

namespace {

constexpr float kEdge = 0.9f;                       // m
constexpr int kCuts = 72;                           // of the block's faces: dents need vertices
constexpr int kCells = 6000;
constexpr btScalar kDepth = btScalar( 0.16 );       // m that each stamp goes below the block's top
constexpr btScalar kClearance = btScalar( 0.45 );   // m above it where a stamp waits
constexpr double kStampSeconds = 1.1, kFirstStamp = 0.3; // down and up again; one after the other
constexpr double kRest = 0.6;                       // s for the block to come to rest at the end

struct Stamp
{
	const char* name;
	btScalar x, z;
	btScalar reach; ///< from its middle down to what touches first, m
	bool isBall;
	btQuaternion turn;
	btRigidBody* body = nullptr;
	double deepest = 0; ///< m, under it, while it pressed
};

class PlasticBlock : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.9 ) );
		const pliant_glue::ModelMesh mesh = makeCube( kEdge, kCuts );
		SoftOrder order;
		order.name = "block";
		order.mesh = &mesh;
		order.cells = kCells;
		order.place = btTransform( btQuaternion::getIdentity(), btVector3( 0, btScalar( kEdge ) / 2, 0 ) );
		order.material.density = 400.0f;
		order.material.youngsModulus = 6.0e4f;
		order.material.damping = 25.0f;
		order.friction = btScalar( 0.9 );
		order.colour = kTeal;
		m_body = stage.addSoft( order );
		if( m_body == nullptr )
		{
			return false;
		}
		const btScalar size = btScalar( 0.3 ), across = btScalar( kEdge * 0.27 );
		const btQuaternion edgeDown( btVector3( 0, 0, 1 ), SIMD_PI / 4 );
		const btQuaternion cornerDown = shortestArcQuat( btVector3( 1, 1, 1 ).normalized(), btVector3( 0, 1, 0 ) );
		m_stamps = { { "ball", -across, across, size / 2, true, btQuaternion::getIdentity() },
			{ "edge", across * btScalar( 0.9 ), across * btScalar( 0.5 ), size / btScalar( std::sqrt( 2.0 ) ), false, edgeDown },
			{ "corner", -across * btScalar( 0.3 ), -across, size * btScalar( std::sqrt( 3.0 ) ) / 2, false, cornerDown } };
		for( Stamp& stamp : m_stamps )
		{
			stamp.body = stamp.isBall ? stage.addSphere( size, btVector3( 0, 2, 0 ), 0, kOchre )
			                          : stage.addBox( btVector3( size, size, size ), btTransform( stamp.turn ), 0, kOchre );
		}
		return true;
	}

	void beforeStep( Stage&, double seconds ) override
	{
		for( std::size_t i = 0; i < m_stamps.size(); ++i )
		{
			const double share = ( seconds - kFirstStamp ) / kStampSeconds - double( i );
			// Half a cosine down, half a cosine up.
			const btScalar down = share <= 0 || share >= 1 ? btScalar( 0 ) : btScalar( 0.5 - 0.5 * std::cos( 2 * SIMD_PI * share ) );
			const Stamp& stamp = m_stamps[i];
			const btScalar y = btScalar( kEdge ) + stamp.reach + kClearance - down * ( kClearance + kDepth );
			Stage::moveBody( stamp.body, btTransform( stamp.turn, btVector3( stamp.x, y, stamp.z ) ) );
		}
	}

	void afterStep( Stage& stage, double ) override
	{
		stage.skin();
		if( m_topVertices.empty() )
		{
			rememberTop();
		}
		for( std::size_t i = 0; i < m_stamps.size(); ++i )
		{
			m_stamps[i].deepest = std::max( m_stamps[i].deepest, depthUnder( i ) );
		}
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		FindingTable table{ "dents, m", { "pressed", "left", "left, %" }, {} };
		for( std::size_t i = 0; i < m_stamps.size(); ++i )
		{
			table.rows.push_back( { m_stamps[i].name, { m_stamps[i].deepest, depthUnder( i ), 100 * depthUnder( i ) / m_stamps[i].deepest } } );
		}
		return { table };
	}

	double duration() const override { return kFirstStamp + 3 * kStampSeconds + kRest; }
	pliant_glue::DrawCamera camera( double ) const override { return { { -0.9f, 2.0f, 2.5f }, { 0, 0.62f, 0 }, 36.0f }; }
	pliant_glue::DrawLight light() const override { return { { 0.75f, 0.45f, 0.05f }, { 0, 0.5f, 0 }, 2.0f }; }

private:
	/// Vertices of the top face, and those of them under each stamp.
	void rememberTop()
	{
		const pliant::SurfaceView skin = m_body->surface();
		const auto height = [&]( int i ) { return double( skin.positions[std::size_t( i ) * 3 + 1] ) + double( skin.origin.y() ); };
		for( const Stamp& stamp : m_stamps )
		{
			std::vector<int> under;
			for( int i = 0; i < skin.vertexCount; ++i )
			{
				const float* p = skin.positions + std::size_t( i ) * 3;
				const double dx = double( p[0] ) + double( skin.origin.x() - stamp.x ), dz = double( p[2] ) + double( skin.origin.z() - stamp.z );
				const bool isTop = height( i ) > 0.95 * double( kEdge );
				if( isTop && &stamp == &m_stamps.front() )
				{
					m_top.push_back( i );
				}
				if( isTop && dx * dx + dz * dz < kUnder * kUnder )
				{
					under.push_back( i );
				}
			}
			m_topVertices.push_back( std::move( under ) );
		}
	}

	/// Below the middle height of the top face, which sinks under the block's own weight.
	double depthUnder( std::size_t stamp ) const
	{
		const pliant::SurfaceView skin = m_body->surface();
		const auto height = [&]( int i ) { return double( skin.positions[std::size_t( i ) * 3 + 1] ); };
		std::vector<double> heights;
		std::transform( m_top.begin(), m_top.end(), std::back_inserter( heights ), height );
		std::nth_element( heights.begin(), heights.begin() + std::ptrdiff_t( heights.size() / 2 ), heights.end() );
		double lowest = heights[heights.size() / 2];
		const double middle = lowest;
		for( const int i : m_topVertices[stamp] )
		{
			lowest = std::min( lowest, height( i ) );
		}
		return middle - lowest;
	}

	static constexpr double kUnder = 0.04; // m around a stamp's middle
	pliant::SoftBody* m_body = nullptr;
	std::vector<Stamp> m_stamps;
	std::vector<std::vector<int>> m_topVertices;
	std::vector<int> m_top;
};

} // namespace

std::unique_ptr<Scene> makePlasticBlock()
{
	return std::make_unique<PlasticBlock>();
}

} // namespace pliant_demos
