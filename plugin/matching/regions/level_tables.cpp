#include "matching/regions/level_tables.h"

#include "adapt/constants.h"
#include "matching/constants.h"
#include "threads/parallel.h"

#include <algorithm>

namespace pliant {

namespace {

/// Fills the tables region by region.
class Filler
{
public:
	Filler( const LevelBase& base, const Lattice& lattice, const Cut& cut, const RegionMatrix& matrix, const LevelSettings& settings,
		RegionTables& tables ) :
		m_base( base ),
		m_lattice( lattice ), m_cut( cut ), m_matrix( matrix ), m_material( settings.material ), m_settings( settings.adaptivity ),
		m_stiffness( settings.stiffness ), m_tasks( settings.tasks ), m_tables( tables )
	{}

	void run( const TablesBefore& before )
	{
		allocate();
		// Literal weights with a sum plan are multiplied by m_r at the end, so that previous values cannot be reused.
		const bool isWeighed = m_tables.plan && m_material.weights == Weights::Literal;
		const bool reusesRows = before.tables && !isWeighed;
		const int chunks = ( m_cut.count() + kRowsPerTask - 1 ) / kRowsPerTask;
		m_hasFlat.assign( std::size_t( chunks ), 0 );
		auto fill = [this, &before, reusesRows]( int chunk ) {
			const int last = std::min( m_cut.count(), ( chunk + 1 ) * kRowsPerTask );
			for ( int r = chunk * kRowsPerTask; r < last; )
			{
				const int end = reusesRows ? endOfRun( before.region, r, last ) : r;
				if ( end > r )
				{
					copyRegions( *before.tables, int( before.region[r] ), r, end );
					moveCentres( before.shift, r, end );
					r = end;
					continue;
				}
				if ( !before.skipsOthers )
				{
					m_hasFlat[std::size_t( chunk )] |= fillRegion( r ) ? 1 : 0;
				}
				++r;
			}
		};
		runTasks( m_tasks, chunks, fill );
		// With a sum plan a node's weights depend on more than its own row.
		fillNodes( reusesRows && !m_tables.plan ? &before : nullptr );
		if ( isWeighed )
		{
			for ( int r = 0; r < m_cut.count(); ++r )
			{
				m_tables.moments.regionWeight[r] *= float( m_base.octree.mass[m_cut.node[r]] ); // m_r of eq. 8
			}
		}
		if ( !before.skipsOthers && !hasFlat( reusesRows ? before.tables : nullptr ) )
		{
			dropOutOfPlane();
		}
	}

	/// Fills rows that were skipped, and the weights of the nodes in them.
	void fillRows( const std::vector<std::uint32_t>& rows )
	{
		for ( const std::uint32_t r : rows )
		{
			fillRegion( int( r ) );
		}
		for ( const std::uint32_t r : rows )
		{
			for ( std::uint32_t k = m_matrix.start[r]; k < m_matrix.start[r + 1]; ++k )
			{
				// Repeated for each row that holds the node: only pieces that come apart take this path, which is expensive anyhow.
				fillNode( int( m_matrix.member[k] ) );
			}
		}
		if ( !hasFlat( &m_tables ) )
		{
			dropOutOfPlane();
		}
	}

private:
	void dropOutOfPlane()
	{
		for ( auto& component : m_tables.outOfPlane )
		{
			component.clear();
		}
	}

	/// eta = beta everywhere: a region's whole pull is scaled, and F is not needed.
	bool scalesOnly() const
	{
		return m_settings.residual == ResidualRule::Soften && m_settings.softening != Softening::EnergyTensor && m_material.beta == 0.0f;
	}

	/// Rows are written one by one; this sets the padding only. Reused tables keep their memory.
	void shape( AlignedArray<float>& array, float padding ) const
	{
		array.resize( std::size_t( m_tables.moments.padded ) );
		std::fill( array.begin() + m_cut.count(), array.end(), padding );
	}

	void allocate()
	{
		RegionMoments& moments = m_tables.moments;
		moments.count = m_cut.count();
		moments.padded = ( moments.count + kLanes - 1 ) / kLanes * kLanes;
		for ( AlignedArray<float>* array : { &moments.nodeWeight, &moments.inverseCover, &moments.inverseMass, &moments.centre[0],
				  &moments.centre[1], &moments.centre[2], &m_tables.pull } )
		{
			shape( *array, 0.0f );
		}
		for ( int k = 0; k < 6; ++k )
		{
			shape( moments.moment[k], k < 3 ? 1.0f : 0.0f );
			shape( moments.inverseMoment[k], 0.0f );
			shape( m_tables.outOfPlane[k], 0.0f );
		}
		if ( scalesOnly() || m_tables.plan || !m_stiffness.empty() )
		{
			shape( moments.regionWeight, 1.0f );
		}
		if ( !scalesOnly() )
		{
			shape( m_tables.beta, 0.0f );
			shape( m_tables.eta, 0.0f );
		}
		if ( m_settings.softening == Softening::EnergyTensor )
		{
			for ( int k = 0; k < 9; ++k )
			{
				shape( m_tables.blend[k], k % 4 == 0 ? 1.0f : 0.0f );
			}
		}
		m_tables.regions.halfWidth = m_material.regionHalfWidth;
	}

	/// `before`: null, or the tables that rows were copied from.
	bool hasFlat( const RegionTables* before ) const
	{
		if ( std::any_of( m_hasFlat.begin(), m_hasFlat.end(), []( char flat ) { return flat != 0; } ) )
		{
			return true;
		}
		const auto isZero = []( float value ) { return value == 0.0f; };
		return before && !before->outOfPlane[0].empty() &&
			std::any_of( std::begin( m_tables.outOfPlane ), std::end( m_tables.outOfPlane ),
				[&isZero]( const AlignedArray<float>& component ) { return !std::all_of( component.begin(), component.end(), isZero ); } );
	}

	/// Returns the end of the run of rows from r on that equal consecutive previous rows.
	static int endOfRun( const std::vector<std::uint32_t>& before, int r, int last )
	{
		if ( before[std::size_t( r )] == kNoNode )
		{
			return r;
		}
		int end = r + 1;
		while ( end < last && before[std::size_t( end )] == before[std::size_t( r )] + std::uint32_t( end - r ) )
		{
			++end;
		}
		return end;
	}

	/// Entries `old`, old + 1, ... of `source` become entries `first` to end - 1 of `to`; an empty source is all zero.
	static void copyRun( const AlignedArray<float>& source, AlignedArray<float>& to, int old, int first, int end )
	{
		if ( !to.empty() && source.empty() )
		{
			std::fill( to.begin() + first, to.begin() + end, 0.0f );
		}
		else if ( !to.empty() )
		{
			std::copy( source.begin() + old, source.begin() + old + ( end - first ), to.begin() + first );
		}
	}

	/// Copies data that fillRegion would compute again: it depends on the row alone.
	void copyRegions( const RegionTables& from, int old, int first, int end )
	{
		const auto copy = [old, first, end](
							  const AlignedArray<float>& source, AlignedArray<float>& to ) { copyRun( source, to, old, first, end ); };
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

	void moveCentres( const Vec3d& shift, int first, int end )
	{
		for ( int k = 0; k < 3; ++k )
		{
			AlignedArray<float>& centre = m_tables.moments.centre[k];
			for ( int r = first; shift[k] != 0.0 && r < end; ++r )
			{
				centre[std::size_t( r )] = float( double( centre[std::size_t( r )] ) - shift[k] );
			}
		}
	}

	/// With `before`, nodes whose row and regions are unchanged keep their weights.
	void fillNodes( const TablesBefore* before )
	{
		const int count = m_cut.count();
		if ( !before )
		{
			for ( int i = 0; i < count; ++i )
			{
				fillNode( i );
			}
			return;
		}
		std::vector<std::uint32_t> same = before->region;
		for ( int r = 0; r < count; ++r )
		{
			for ( std::uint32_t k = m_matrix.start[r]; before->region[std::size_t( r )] == kNoNode && k < m_matrix.start[r + 1]; ++k )
			{
				same[m_matrix.member[k]] = kNoNode; // membership is symmetric
			}
		}
		const RegionMoments& old = before->tables->moments;
		for ( int i = 0; i < count; )
		{
			const int end = endOfRun( same, i, count );
			if ( end > i )
			{
				const int was = int( same[std::size_t( i )] );
				copyRun( old.nodeWeight, m_tables.moments.nodeWeight, was, i, end );
				copyRun( old.inverseCover, m_tables.moments.inverseCover, was, i, end );
				copyRun( before->tables->pull, m_tables.pull, was, i, end );
				i = end;
				continue;
			}
			fillNode( i++ );
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
		const double eta = quadraticEta(
			m_base.octree, m_cut, m_matrix, std::uint32_t( region ), m_base.moments, rest, m_lattice.cellSize, beta );
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

	/// Returns true where the region is flat.
	bool fillRegion( int r )
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

		// Among finest cells only, the region equals the finest one: exactly no softening.
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
			return rest.isFlat;
		}
		beta = 1.0 - ( 1.0 - beta ) * ( 1.0 - m_material.beta );
		m_tables.beta[r] = float( beta );
		m_tables.eta[r] = float( eta );
		if ( m_settings.softening == Softening::EnergyTensor )
		{
			const Eigen::Matrix3d c = isFinest ? Eigen::Matrix3d( Eigen::Matrix3d::Identity() )
											   : energyBlend( fineMoment( m_base.moments, node ), rest.moment );
			for ( int k = 0; k < 9; ++k )
			{
				m_tables.blend[k][r] = float( c( k / 3, k % 3 ) );
			}
		}
		return rest.isFlat;
	}

	void fillNode( int i )
	{
		double cover = 0.0, pull = 0.0;
		for ( std::uint32_t k = m_matrix.start[i]; k < m_matrix.start[i + 1]; ++k )
		{
			const std::uint32_t r = m_matrix.member[k];
			const double fraction = m_matrix.fraction[k];
			cover += fraction;
			const float weight = m_tables.moments.regionWeight.empty() ? 1.0f : m_tables.moments.regionWeight[r];
			pull += fraction * ( scalesOnly() ? weight : weight * ( 1.0f - m_tables.eta[r] ) );
		}
		RegionMoments& moments = m_tables.moments;
		if ( m_tables.plan )
		{
			// With a sum plan every member has the same weight in all regions: weights belong to nodes, not to matrix entries.
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
	std::vector<char> m_hasFlat; ///< of each task
};

} // namespace

std::shared_ptr<const RegionTables> buildLevelTables( const LevelBase& base, const Lattice& lattice, const Cut& cut,
	const LevelRegions& regions, const LevelSettings& settings, const TablesBefore& before )
{
	const std::shared_ptr<RegionTables> tables = before.scratch ? before.scratch : std::make_shared<RegionTables>();
	tables->matrix = regions.matrix;
	tables->plan = regions.plan;
	Filler( base, lattice, cut, *tables->matrix, settings, *tables ).run( before );
	return tables;
}

void fillSkippedRows( const LevelBase& base, const Lattice& lattice, const Cut& cut, const LevelSettings& settings,
	const std::vector<std::uint32_t>& rows, RegionTables& tables )
{
	Filler( base, lattice, cut, *tables.matrix, settings, tables ).fillRows( rows );
}

} // namespace pliant
