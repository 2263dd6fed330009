// +-----------------------------------------------------------------------------------------------------------------+
// | plastic_block: after Steinemann et al. 2008, figure 5. A ball, an edge and a corner press into three blocks that  |
// | differ only in their plastic flow: none, little and late, much and at once. The table has the remaining depth of  |
// | each dent.                                                                                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pliant_demos {

namespace {

constexpr float kPlasticBlockEdge = 0.6f;                 // m
constexpr btScalar kPlasticBlockApart = btScalar( 0.86 ); // m from one block to the next
constexpr int kPlasticBlockCuts = 60;                     // of a block's faces: dents need vertices
constexpr int kPlasticBlockCells = 5832;                  // 18 along an edge
constexpr int kPlasticBlockCoarseLevels = 2;
constexpr btScalar kDepth = btScalar( 0.12 ); // m that each stamp moves below the block's top
constexpr btScalar kClearance = btScalar(
	0.90 ); // m above it where a stamp waits, out of the picture, so that its shadow is behind the blocks
constexpr double kStampSeconds = 1.1, kFirstStamp = 0.3; // down and up again; one after the other
constexpr double kRest = 1.2;                            // s for the blocks to come to rest at the end

/// How a block flows; see pliant::Material.
struct Flow
{
	const char* name;
	float yieldStrain, creep, limit;
	pliant_glue::Colour colour;
};
constexpr Flow kFlows[] = {
	{ "rubber", 0.0f, 10.0f, 0.5f, kTeal }, { "wax", 0.15f, 6.0f, 0.3f, kOchre }, { "clay", 0.10f, 60.0f, 1.0f, kTerracotta } };

struct Stamp
{
	const char* name;
	btScalar x, z;  ///< from a block's middle
	btScalar reach; ///< from its own centre down to the point that touches first, m
	bool isBall;
	btQuaternion turn;
	std::vector<btRigidBody*> bodies = {}; ///< one a block
};

class PlasticBlock : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.9 ) );
		const pliant_glue::ModelMesh mesh = makeCube( kPlasticBlockEdge, kPlasticBlockCuts );
		SoftOrder order;
		order.mesh = &mesh;
		order.cells = kPlasticBlockCells;
		order.material.density = 250.0f;
		order.material.youngsModulus = 6.0e4f;
		order.material.damping = 25.0f;
		order.adaptivity.coarseLevels = kPlasticBlockCoarseLevels;
		order.adaptivity.refinesOnContact = true;
		order.adaptivity.refineStrain = 0.1f;
		order.friction = btScalar( 0.9 );
		order.shape = stage.buildShape( order );
		for ( std::size_t i = 0; order.shape != nullptr && i < std::size( kFlows ); ++i )
		{
			order.name = kFlows[i].name;
			order.material.yieldStrain = kFlows[i].yieldStrain;
			order.material.plasticCreep = kFlows[i].creep;
			order.material.plasticLimit = kFlows[i].limit;
			order.colour = kFlows[i].colour;
			order.place = btTransform( btQuaternion::getIdentity(), btVector3( middleOf( i ), btScalar( kPlasticBlockEdge ) / 2, 0 ) );
			m_blocks.push_back( Block{ stage.addSoft( order ), {}, {}, {} } );
			if ( m_blocks.back().body == nullptr )
			{
				return false;
			}
		}
		addStamps( stage );
		return order.shape != nullptr;
	}

	void beforeStep( Stage&, double seconds ) override
	{
		for ( std::size_t i = 0; i < m_stamps.size(); ++i )
		{
			const double fraction = ( seconds - kFirstStamp ) / kStampSeconds - double( i );
			// Half a cosine down, half a cosine up.
			const btScalar down = fraction <= 0 || fraction >= 1 ? btScalar( 0 )
																 : btScalar( 0.5 - 0.5 * std::cos( 2 * SIMD_PI * fraction ) );
			const Stamp& stamp = m_stamps[i];
			const btScalar y = btScalar( kPlasticBlockEdge ) + stamp.reach + kClearance - down * ( kClearance + kDepth );
			for ( std::size_t k = 0; k < stamp.bodies.size(); ++k )
			{
				Stage::moveBody( stamp.bodies[k], btTransform( stamp.turn, btVector3( middleOf( k ) + stamp.x, y, stamp.z ) ) );
			}
		}
	}

	void afterStep( Stage& stage, double ) override
	{
		stage.skin();
		for ( std::size_t k = 0; k < m_blocks.size(); ++k )
		{
			Block& block = m_blocks[k];
			if ( block.top.empty() )
			{
				rememberTop( block, middleOf( k ) );
			}
			for ( std::size_t i = 0; i < m_stamps.size(); ++i )
			{
				block.deepest[i] = std::max( block.deepest[i], depthUnder( block, i ) );
			}
		}
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		FindingTable table{ "dents, mm", { "pressed", "left", "left, %" }, {} };
		for ( std::size_t k = 0; k < m_blocks.size(); ++k )
		{
			for ( std::size_t i = 0; i < m_stamps.size(); ++i )
			{
				const double pressed = m_blocks[k].deepest[i], left = depthUnder( m_blocks[k], i );
				table.rows.push_back(
					{ std::string( kFlows[k].name ) + ", " + m_stamps[i].name, { 1000 * pressed, 1000 * left, 100 * left / pressed } } );
			}
		}
		return { table };
	}

	double duration() const override { return kFirstStamp + double( m_stamps.size() ) * kStampSeconds + kRest; }
	pliant_glue::DrawCamera camera( double ) const override { return { { -0.35f, 1.75f, 2.65f }, { 0, 0.34f, 0 }, 36.0f }; }
	pliant_glue::DrawLight light() const override { return { { 0.62f, 0.42f, 0.45f }, { 0, 0.4f, 0 }, 2.4f }; }

private:
	struct Block
	{
		pliant::SoftBody* body;
		std::vector<int> top;                ///< vertices of the top face
		std::vector<std::vector<int>> under; ///< those of them under each stamp
		std::vector<double> deepest;         ///< m, under each stamp, while it pressed
	};

	static btScalar middleOf( std::size_t block ) { return kPlasticBlockApart * ( btScalar( block ) - 1 ); }

	void addStamps( Stage& stage )
	{
		const btScalar size = btScalar( 0.2 ), across = btScalar( kPlasticBlockEdge * 0.27 );
		const btQuaternion edgeDown( btVector3( 0, 0, 1 ), SIMD_PI / 4 );
		const btQuaternion cornerDown = shortestArcQuat( btVector3( 1, 1, 1 ).normalized(), btVector3( 0, 1, 0 ) );
		m_stamps = { { "ball", -across, across, size / 2, true, btQuaternion::getIdentity() },
			{ "edge", across * btScalar( 0.9 ), across * btScalar( 0.5 ), size / btScalar( std::sqrt( 2.0 ) ), false, edgeDown },
			{ "corner", -across * btScalar( 0.3 ), -across, size * btScalar( std::sqrt( 3.0 ) ) / 2, false, cornerDown } };
		for ( Stamp& stamp : m_stamps )
		{
			for ( std::size_t k = 0; k < m_blocks.size(); ++k )
			{
				const btVector3 at( middleOf( k ) + stamp.x, btScalar( kPlasticBlockEdge ) + stamp.reach + kClearance, stamp.z );
				stamp.bodies.push_back( stamp.isBall
						? stage.addSphere( size, at, 0, kStone )
						: stage.addBox( btVector3( size, size, size ), btTransform( stamp.turn, at ), 0, kStone ) );
			}
		}
	}

	/// Vertices of the top face, and those of them under each stamp.
	void rememberTop( Block& block, btScalar middle )
	{
		const pliant::SurfaceView skin = block.body->surface();
		block.under.resize( m_stamps.size() );
		block.deepest.resize( m_stamps.size() );
		for ( int i = 0; i < skin.vertexCount; ++i )
		{
			const float* p = skin.positions + std::size_t( i ) * 3;
			if ( double( p[1] ) + double( skin.origin.y() ) < 0.95 * double( kPlasticBlockEdge ) )
			{
				continue;
			}
			block.top.push_back( i );
			for ( std::size_t k = 0; k < m_stamps.size(); ++k )
			{
				const double dx = double( p[0] ) + double( skin.origin.x() - middle - m_stamps[k].x ),
							 dz = double( p[2] ) + double( skin.origin.z() - m_stamps[k].z );
				if ( dx * dx + dz * dz < kUnder * kUnder )
				{
					block.under[k].push_back( i );
				}
			}
		}
	}

	/// Below the mean height of the top face, which sinks under the block's own weight.
	static double depthUnder( const Block& block, std::size_t stamp )
	{
		const pliant::SurfaceView skin = block.body->surface();
		const auto height = [&]( int i ) { return double( skin.positions[std::size_t( i ) * 3 + 1] ); };
		std::vector<double> heights;
		std::transform( block.top.begin(), block.top.end(), std::back_inserter( heights ), height );
		std::nth_element( heights.begin(), heights.begin() + std::ptrdiff_t( heights.size() / 2 ), heights.end() );
		double lowest = heights[heights.size() / 2];
		const double middle = lowest;
		for ( const int i : block.under[stamp] )
		{
			lowest = std::min( lowest, height( i ) );
		}
		return middle - lowest;
	}

	static constexpr double kUnder = 0.03; // m around a stamp's middle
	std::vector<Block> m_blocks;
	std::vector<Stamp> m_stamps;
};

} // namespace

std::unique_ptr<Scene> makePlasticBlock()
{
	return std::make_unique<PlasticBlock>();
}

} // namespace pliant_demos
