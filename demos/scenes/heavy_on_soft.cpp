// +-----------------------------------------------------------------------------------------------------------------+
// | heavy_on_soft: boxes of 1, 10, 100 and 1000 times a soft block's mass on blocks with a modulus at which they are  |
// | compressed by a twentieth; in the middle, off the middle, and on an edge. One step of 1/60 s a frame              |
// | (docs/design/implicit.md).                                                                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace pliant_demos {

namespace {

constexpr btScalar kHeavyOnSoftEdge = btScalar( 0.6 );
constexpr int kHeavyOnSoftCells = 6;
constexpr float kHeavyOnSoftDensity = 1000.0f;
constexpr double kStrain = 0.05; // of the box's weight over E and the block's top
constexpr btScalar kHeavyOnSoftGap = btScalar( 0.002 );
constexpr btScalar kHeavyOnSoftApart = btScalar( 1.0 );
constexpr double kPutDown = 2.0; // s in which a box gets its weight: released at once, the heaviest on an edge would swing over and fall

struct Column
{
	pliant::SoftBody* block = nullptr;
	btRigidBody* box = nullptr;
	double ratio = 1.0, modulus = 1.0;
	std::string name;
};

class HeavyOnSoft : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.8 ) );
		const double ratios[] = { 1, 10, 100, 1000 };
		const pliant_glue::Colour colours[] = { kTeal, kOchre, kTerracotta, kPlum };
		// In the middle, off it by a tenth of the edge, and a narrow box along one edge.
		for ( int row = 0; row < 3; ++row )
		{
			for ( int k = 0; k < 4; ++k )
			{
				if ( !addColumn( stage, row, k, ratios[k], colours[k] ) )
				{
					return false;
				}
			}
		}
		return true;
	}

	void beforeStep( Stage& stage, double seconds ) override
	{
		const double fraction = std::min( 1.0, seconds / kPutDown );
		for ( Column& column : m_columns )
		{
			if ( seconds < kPutDown + 1.0 )
			{
				column.box->setGravity( stage.world().getGravity() * btScalar( fraction ) );
			}
		}
	}

	std::vector<FindingTable> findings( const Stage& stage ) const override
	{
		FindingTable table;
		table.caption = "Strain of the blocks under their boxes; a block's own weight is in both";
		table.columns = { "strain", "sigma / E", "lean, degrees", "box speed, m/s" };
		const double g = double( -stage.world().getGravity().y() );
		for ( const Column& column : m_columns )
		{
			// Between the centres of the lowest and the highest layer; theory is the mean load of the layers between.
			double top = 0.0, bottom = 0.0;
			for ( int k = 0; k < kHeavyOnSoftCells * kHeavyOnSoftCells; ++k )
			{
				const int first = k / kHeavyOnSoftCells * kHeavyOnSoftCells * kHeavyOnSoftCells + k % kHeavyOnSoftCells;
				bottom += double( column.block->nodePosition( first ).y() );
				top += double( column.block->nodePosition( first + kHeavyOnSoftCells * ( kHeavyOnSoftCells - 1 ) ).y() );
			}
			const double length = double( kHeavyOnSoftEdge ) * ( kHeavyOnSoftCells - 1 ) / kHeavyOnSoftCells;
			const double strain = 1.0 - ( top - bottom ) / ( kHeavyOnSoftCells * kHeavyOnSoftCells * length );
			const double theory = ( column.ratio + 0.5 ) * double( column.block->mass() ) * g /
				( double( kHeavyOnSoftEdge ) * double( kHeavyOnSoftEdge ) * column.modulus );
			const double lean = double( btAcos( btMin( btScalar( 1 ), column.box->getWorldTransform().getBasis()[1].y() ) ) ) * 180.0 /
				SIMD_PI;
			table.rows.push_back( { column.name, { strain, theory, lean, double( column.box->getLinearVelocity().length() ) } } );
		}
		return { table };
	}

	double duration() const override { return 7.0; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 2.6f, 2.7f, 5.2f }, { 0, 0.45f, 0 }, 36.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.5f, 0.75f, 0.5f }, { 0, 0.6f, 0 }, 4.5f }; }

private:
	bool addColumn( Stage& stage, int row, int k, double ratio, const pliant_glue::Colour& colour )
	{
		static const char* const kWhere[] = { "middle", "off middle", "edge" };
		const pliant_glue::ModelMesh cube = makeCube( float( kHeavyOnSoftEdge ), 12 );
		const double mass = double( kHeavyOnSoftDensity ) * std::pow( double( kHeavyOnSoftEdge ), 3.0 );
		const btVector3 at( kHeavyOnSoftApart * ( btScalar( k ) - btScalar( 1.5 ) ), 0, -kHeavyOnSoftApart * ( btScalar( row ) - 1 ) );
		const double g = double( -stage.world().getGravity().y() );

		Column column;
		column.ratio = ratio;
		column.name = "1:" + std::to_string( int( ratio ) ) + " " + kWhere[row];
		column.modulus = ratio * mass * g /
			( double( kHeavyOnSoftEdge ) * double( kHeavyOnSoftEdge ) * kStrain * ( row == 2 ? 0.1 : 1.0 ) );
		SoftOrder order;
		order.name = column.name;
		order.mesh = &cube;
		order.cellSize = float( kHeavyOnSoftEdge ) / kHeavyOnSoftCells;
		order.place = btTransform( btQuaternion::getIdentity(), at + btVector3( 0, kHeavyOnSoftEdge / 2, 0 ) );
		order.material.density = kHeavyOnSoftDensity;
		order.material.youngsModulus = float( column.modulus );
		order.material.elasticity = pliant::Elasticity::Implicit;
		order.friction = btScalar( 0.8 );
		order.colour = colour;
		column.block = stage.addSoft( order );
		if ( column.block == nullptr )
		{
			return false;
		}
		const btVector3 size = row == 2 ? btVector3( kHeavyOnSoftEdge / 3, kHeavyOnSoftEdge / 3, kHeavyOnSoftEdge )
										: btVector3( kHeavyOnSoftEdge, kHeavyOnSoftEdge / 2, kHeavyOnSoftEdge );
		const btScalar aside = row == 0 ? btScalar( 0 ) : row == 1 ? kHeavyOnSoftEdge / 10 : kHeavyOnSoftEdge / 3;
		const btVector3 place = at + btVector3( aside, kHeavyOnSoftEdge + kHeavyOnSoftGap + size.y() / 2, 0 );
		column.box = stage.addBox( size, btTransform( btQuaternion::getIdentity(), place ), btScalar( ratio * mass ), kSlate );
		m_columns.push_back( column );
		return true;
	}

	std::vector<Column> m_columns;
};

} // namespace

std::unique_ptr<Scene> makeHeavyOnSoft()
{
	return std::make_unique<HeavyOnSoft>();
}

} // namespace pliant_demos
