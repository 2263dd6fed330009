#include "matching/level_tables.h"

#include "matching/constants.h"
#include "threads/parallel.h"

#include <algorithm>

namespace pliant {

namespace {

bool usesEnergies( const Adaptivity& settings )
{
	return settings.softening == Softening::Energy || settings.softening == Softening::EnergyTensor ||
		   settings.residual == ResidualRule::Quadratic || settings.residual == ResidualRule::Larger;
}

void storeSymmetric( AlignedArray<float> ( &to )[6], int i, const Eigen::Matrix3d& m )
{
	const double values[6] = { m( 0, 0 ), m( 1, 1 ), m( 2, 2 ), m( 1, 2 ), m( 0, 2 ), m( 0, 1 ) };
	for ( int k = 0; k < 6; ++k )
	{
		to[k][i] = float( values[k] );
	}
}

/// Rows that one task measures: a multiple of the floats in a cache line, so that no two tasks write to one.
constexpr int kRowsPerTask = 64;

/// Fills the tables region by region.
class Filler
{
public:
	Filler( const LevelBase& base, const Lattice& lattice, const Cut& cut, const RegionMatrix& matrix, const LevelSettings& settings,
		RegionTables& tables ) :
		m_base( base ), m_lattice( lattice ), m_cut( cut ), m_matrix( matrix ), m_material( settings.material ), m_settings( settings.adaptivity ),
		m_stiffness( settings.stiffness ), m_tasks( settings.tasks ), m_tables( tables )
	{
	}

	void run( const TablesBefore& before )
	{
		allocate();
		// Literal weights by way of the octree are multiplied by m_r at the end, and could not be taken over as they were.
		const bool isWeighed = m_tables.plan && m_material.weights == Weights::Literal;
		auto fill = [this, &before, isWeighed]( int chunk ) {
			const int last = std::min( m_cut.count(), ( chunk + 1 ) * kRowsPerTask );
			for ( int r = chunk * kRowsPerTask; r < last; ++r )
			{
				if ( before.tables && !isWeighed && before.region[r] != kNoNode )
				{
					copyRegion( *before.tables, int( before.region[r] ), r );
					continue;
				}
				fillRegion( r );
			}
		};
		runTasks( m_tasks, ( m_cut.count() + kRowsPerTask - 1 ) / kRowsPerTask, fill );
		for ( int i = 0; i < m_cut.count(); ++i )
		{
			fillNode( i );
		}
		if ( isWeighed )
		{
			for ( int r = 0; r < m_cut.count(); ++r )
			{
				m_tables.moments.regionWeight[r] *= float( m_base.octree.mass[m_cut.node[r]] ); // m_r of eq. 8
			}
		}
		if ( !hasFlat() )
		{
			for ( auto& component : m_tables.outOfPlane )
			{
				component = {};
			}
		}
	}

private:
	/// eta = beta everywhere: the whole of a region's pull is scaled, and F is not needed.
	bool scalesOnly() const { return m_settings.residual == ResidualRule::Soften && m_settings.softening != Softening::EnergyTensor && m_material.beta == 0.0f; }

	void allocate()
	{
		RegionMoments& moments = m_tables.moments;
		moments.count = m_cut.count();
		moments.padded = ( moments.count + kLanes - 1 ) / kLanes * kLanes;
		const int padded = moments.padded;
		for ( AlignedArray<float>* array : { &moments.nodeWeight, &moments.inverseCover, &moments.inverseMass, &moments.centre[0], &moments.centre[1],
				  &moments.centre[2], &m_tables.pull } )
		{
			array->assign( padded, 0.0f );
		}
		for ( int k = 0; k < 6; ++k )
		{
			moments.moment[k].assign( padded, k < 3 ? 1.0f : 0.0f );
			moments.inverseMoment[k].assign( padded, 0.0f );
			m_tables.outOfPlane[k].assign( padded, 0.0f );
		}
		if ( scalesOnly() || m_tables.plan || !m_stiffness.empty() )
		{
			moments.regionWeight.assign( padded, 1.0f );
		}
		if ( !scalesOnly() )
		{
			m_tables.beta.assign( padded, 0.0f );
			m_tables.eta.assign( padded, 0.0f );
		}
		if ( m_settings.softening == Softening::EnergyTensor )
		{
			for ( int k = 0; k < 9; ++k )
			{
				m_tables.blend[k].assign( padded, k % 4 == 0 ? 1.0f : 0.0f );
			}
		}
		m_tables.regions.halfWidth = m_material.regionHalfWidth;
	}

	bool hasFlat() const
	{
		const auto isZero = []( float value ) { return value == 0.0f; };
		return std::any_of( std::begin( m_tables.outOfPlane ), std::end( m_tables.outOfPlane ),
			[&isZero]( const AlignedArray<float>& component ) { return !std::all_of( component.begin(), component.end(), isZero ); } );
	}

	/// What fillRegion would write again: it depends on the row alone.
	void copyRegion( const RegionTables& from, int old, int r )
	{
		const auto copy = [old, r]( const AlignedArray<float>& source, AlignedArray<float>& to ) {
			if ( !to.empty() )
			{
				to[r] = source.empty() ? 0.0f : source[old];
			}
		};
		RegionMoments& moments = m_tables.moments;
		copy( from.moments.inverseMass, moments.inverseMass );
		copy( from.moments.regionWeight, moments.regionWeight );
		copy( from.beta, m_tables.beta );
		copy( from.eta, m_tables.eta );
		for ( int k = 0; k < 3; ++k )
		{
			copy( from.moments.centre[k], moments.centre[k] );
		}
		for ( int k = 0; k < 6; ++k )
		{
			copy( from.moments.moment[k], moments.moment[k] );
			copy( from.moments.inverseMoment[k], moments.inverseMoment[k] );
			copy( from.outOfPlane[k], m_tables.outOfPlane[k] );
		}
		for ( int k = 0; k < 9; ++k )
		{
			copy( from.blend[k], m_tables.blend[k] );
		}
	}

	double betaOf( std::uint32_t node, const RegionRest& rest ) const
	{
		const double mass = m_base.octree.mass[node];
		switch ( m_settings.softening )
		{
			case Softening::None: return 0.0;
			case Softening::Ohta1D: return ohtaBeta( mass, m_material.regionHalfWidth, 1 );
			case Softening::Ohta2D: return ohtaBeta( mass, m_material.regionHalfWidth, 2 );
			case Softening::Ohta3D: return ohtaBeta( mass, m_material.regionHalfWidth, 3 );
			default: return energyBeta( fineMoment( m_base.moments, node ), rest.moment );
		}
	}

	double etaOf( int region, const RegionRest& rest, double beta ) const
	{
		if ( m_settings.residual == ResidualRule::Keep )
		{
			return 0.0;
		}
		if ( m_settings.residual == ResidualRule::Soften )
		{
			return beta;
		}
		const double eta = quadraticEta( m_base.octree, m_cut, m_matrix, std::uint32_t( region ), m_base.moments, rest, m_lattice.cellSize, beta );
		return m_settings.residual == ResidualRule::Larger ? std::max( eta, beta ) : eta;
	}

	bool holdsFinestOnly( int r ) const
	{
		const auto first = m_matrix.member.begin() + m_matrix.start[r], last = m_matrix.member.begin() + m_matrix.start[r + 1];
		return std::all_of( first, last, [this]( std::uint32_t a ) { return m_cut.node[a] < m_base.octree.levelStart[1]; } );
	}

	double stiffnessOf( std::uint32_t node ) const
	{
		if ( m_stiffness.empty() )
		{
			return 1.0;
		}
		const Octree& octree = m_base.octree;
		double sum = 0.0;
		for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
		{
			sum += octree.mass[octree.cells[k]] * m_stiffness[octree.cells[k]];
		}
		return sum / octree.mass[node];
	}

	void fillRegion( int r )
	{
		RegionMoments& moments = m_tables.moments;
		const std::uint32_t node = m_cut.node[r];
		const RegionRest rest = measureRegion( m_base.octree, m_cut, m_matrix, std::uint32_t( r ), m_lattice.cellSize );
		moments.inverseMass[r] = float( 1.0 / rest.mass );
		for ( int k = 0; k < 3; ++k )
		{
			moments.centre[k][r] = float( rest.centre[k] );
		}
		storeSymmetric( moments.moment, r, rest.moment );
		storeSymmetric( moments.inverseMoment, r, rest.inverse );
		storeSymmetric( m_tables.outOfPlane, r, rest.outside );

		// Among finest cells only, the region is the finest one itself: nothing to soften, to the last bit.
		const bool isFinest = holdsFinestOnly( r );
		double beta = isFinest ? 0.0 : betaOf( node, rest );
		double eta = isFinest ? 0.0 : etaOf( r, rest, beta );
		if ( node >= m_base.octree.levelStart[1] )
		{
			beta = 1.0 - ( 1.0 - beta ) * m_settings.coarseStiffness;
			eta = 1.0 - ( 1.0 - eta ) * m_settings.coarseStiffness;
		}
		if ( !moments.regionWeight.empty() )
		{
			moments.regionWeight[r] = float( stiffnessOf( node ) * ( scalesOnly() ? 1.0 - beta : 1.0 ) );
		}
		if ( scalesOnly() )
		{
			return;
		}
		beta = 1.0 - ( 1.0 - beta ) * ( 1.0 - m_material.beta );
		m_tables.beta[r] = float( beta );
		m_tables.eta[r] = float( eta );
		if ( m_settings.softening == Softening::EnergyTensor && !isFinest )
		{
			const Eigen::Matrix3d c = energyBlend( fineMoment( m_base.moments, node ), rest.moment );
			for ( int k = 0; k < 9; ++k )
			{
				m_tables.blend[k][r] = float( c( k / 3, k % 3 ) );
			}
		}
	}

	void fillNode( int i )
	{
		double cover = 0.0, pull = 0.0;
		for ( std::uint32_t k = m_matrix.start[i]; k < m_matrix.start[i + 1]; ++k )
		{
			const std::uint32_t r = m_matrix.member[k];
			const double share = m_matrix.share[k];
			cover += share;
			const float weight = m_tables.moments.regionWeight.empty() ? 1.0f : m_tables.moments.regionWeight[r];
			pull += share * ( scalesOnly() ? weight : weight * ( 1.0f - m_tables.eta[r] ) );
		}
		RegionMoments& moments = m_tables.moments;
		if ( m_tables.plan )
		{
			// By way of the octree every member of a region weighs as much as in any other: weights stand at the nodes, not at the terms.
			const double mass = m_base.octree.mass[m_cut.node[i]];
			const std::uint32_t members = m_matrix.start[i + 1] - m_matrix.start[i];
			const bool conserves = m_material.weights == Weights::Conserving;
			moments.nodeWeight[i] = float( conserves ? mass / members : mass );
			moments.inverseCover[i] = float( 1.0 / ( conserves ? members : cover * kMassUnit ) );
			m_tables.pull[i] = float( pull / cover );
			return;
		}
		moments.nodeWeight[i] = float( m_matrix.unit[i] );
		moments.inverseCover[i] = float( 1.0 / cover );
		m_tables.pull[i] = float( pull / cover );
	}

	const LevelBase& m_base;
	const Lattice& m_lattice;
	const Cut& m_cut;
	const RegionMatrix& m_matrix;
	const Material& m_material;
	const Adaptivity& m_settings;
	const std::vector<float>& m_stiffness;
	TaskRunner* m_tasks;
	RegionTables& m_tables;
};

} // namespace

std::shared_ptr<const LevelBase> buildLevelBase( const Lattice& lattice, const Material& material, const Adaptivity& settings )
{
	auto base = std::make_shared<LevelBase>();
	base->octree = buildOctree( lattice, settings.coarseLevels );
	base->fine = buildFineRegions( lattice, material.regionHalfWidth );
	if ( usesEnergies( settings ) )
	{
		base->moments = buildFineMoments( base->octree, lattice, base->fine );
	}
	return base;
}

std::shared_ptr<const LevelBase> LevelCache::find( const Lattice& lattice, const Material& material, const Adaptivity& settings )
{
	const std::lock_guard<std::mutex> lock( m_mutex );
	const bool withMoments = usesEnergies( settings );
	const auto found = std::find_if( m_entries.begin(), m_entries.end(), [&]( const Entry& e ) {
		return e.coarseLevels == settings.coarseLevels && e.halfWidth == material.regionHalfWidth && e.withMoments == withMoments;
	} );
	if ( found != m_entries.end() )
	{
		if ( std::shared_ptr<const LevelBase> base = found->base.lock() )
		{
			return base;
		}
	}
	std::shared_ptr<const LevelBase> base = buildLevelBase( lattice, material, settings );
	if ( found != m_entries.end() )
	{
		found->base = base;
	}
	else
	{
		m_entries.push_back( Entry{ settings.coarseLevels, material.regionHalfWidth, withMoments, base } );
	}
	return base;
}

Cut firstCut( const Octree& octree, const Adaptivity& settings )
{
	const auto byMass = keepsByMass( octree, settings.keepMass );
	return selectCut( octree, [&]( std::uint32_t node ) { return !( settings.isSurfaceFine && octree.isSurface[node] != 0 ) && byMass( node ); } );
}

namespace {

/// Matrix and sums of Steinemann's regions, which are kept with their graph for the next change.
LevelRegions fromIntervals( const RegionInput& input, const Cut& cut, VisibilityGraph graph, IntervalRegions intervals )
{
	LevelRegions regions;
	const IntervalWeights weights = input.material.weights == Weights::Conserving ? IntervalWeights::Conserving : IntervalWeights::Literal;
	regions.matrix = std::make_shared<const RegionMatrix>( buildIntervalRegions( input.base.octree, cut, intervals, weights ) );
	if ( input.settings.hierarchicalSums )
	{
		regions.plan = std::make_shared<const SumPlan>( planSums( input.base.octree, cut, intervals ) );
	}
	regions.graph = std::make_shared<const VisibilityGraph>( std::move( graph ) );
	regions.intervals = std::make_shared<const IntervalRegions>( std::move( intervals ) );
	return regions;
}

} // namespace

LevelRegions buildLevelRegions( const LevelBase& base, const Lattice& lattice, const Cut& cut, const Material& material, const Adaptivity& settings )
{
	if ( settings.regions == RegionRule::Interval )
	{
		VisibilityGraph graph = buildVisibilityGraph( lattice, base.octree, cut );
		IntervalRegions intervals = findIntervalRegions(
			IntervalInput{ base.octree, cut, graph }, intervalWidths( base.octree, cut, float( material.regionHalfWidth ) ), settings.intervalSlack );
		return fromIntervals( RegionInput{ base, lattice, material, settings }, cut, std::move( graph ), std::move( intervals ) );
	}
	const UnionWeights weights = material.weights == Weights::Conserving ? UnionWeights::Conserving : UnionWeights::Literal;
	RegionMatrix matrix = settings.regions == RegionRule::Union ? buildUnionRegions( base.octree, cut, base.fine, weights )
																 : buildMultiplicityRegions( base.octree, cut, base.fine );
	return LevelRegions{ std::make_shared<const RegionMatrix>( std::move( matrix ) ), nullptr };
}

LevelRegions updateLevelRegions( const RegionInput& input, const Cut& from, const LevelRegions& regions, const Cut& to )
{
	const Octree& octree = input.base.octree;
	switch ( input.settings.regions )
	{
		case RegionRule::Multiplicity:
			return LevelRegions{ std::make_shared<const RegionMatrix>( updateMultiplicityRegions( octree, from, *regions.matrix, to, input.base.fine ) ), nullptr };
		case RegionRule::Interval:
		{
			VisibilityUpdate sight = updateVisibilityGraph( input.lattice, octree, from, *regions.graph, to );
			const IntervalInput before{ octree, from, *regions.graph }, after{ octree, to, sight.graph };
			IntervalUpdate update = updateIntervalRegions( before, after, sight.change, *regions.intervals,
				intervalWidths( octree, to, float( input.material.regionHalfWidth ) ), input.tasks );
			return fromIntervals( input, to, std::move( sight.graph ), std::move( update.regions ) );
		}
		default: return buildLevelRegions( input.base, input.lattice, to, input.material, input.settings );
	}
}

std::shared_ptr<const RegionTables> buildLevelTables( const LevelBase& base, const Lattice& lattice, const Cut& cut,
	const LevelRegions& regions, const LevelSettings& settings, const TablesBefore& before )
{
	auto tables = std::make_shared<RegionTables>();
	tables->matrix = regions.matrix;
	tables->plan = regions.plan;
	Filler( base, lattice, cut, *tables->matrix, settings, *tables ).run( before );
	return tables;
}

} // namespace pliant
