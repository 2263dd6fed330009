// Samples of a cut cell belong to one piece when a path between adjacent samples leads through material: straight along the axes where no
// gap was found, and diagonally where no sample next to the path is inside (a slanted sheet thinner than two samples).

#include "lattice/build/parts.h"

#include "lattice/constants.h"
#include "lattice/guarded_tasks.h"
#include "lattice/union_find.h"

#include <algorithm>
#include <array>

namespace pliant {

namespace {

constexpr std::uint8_t kSolid = kInside | kSliver;

std::vector<Eigen::Vector3i> makeDiagonalSteps()
{
	std::vector<Eigen::Vector3i> steps;
	for ( int code = 14; code < 27; ++code ) // the second half of the 27, after the centre
	{
		const Eigen::Vector3i step( code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1 );
		if ( step.cwiseAbs().sum() > 1 )
		{
			steps.push_back( step );
		}
	}
	return steps;
}

} // namespace

const std::vector<Eigen::Vector3i>& diagonalSteps()
{
	static const std::vector<Eigen::Vector3i> steps = makeDiagonalSteps();
	return steps;
}

bool isUnobstructed( const InsideField& field, const Grid& grid, const Eigen::Vector3i& sample, const Eigen::Vector3i& step )
{
	const double spacing = grid.cellSize / grid.samples;
	const Vec3d from = grid.corner + spacing * ( sample.cast<double>() + Vec3d::Constant( 0.5 ) );
	return !field.isCrossed( from, from + spacing * step.cast<double>() );
}

Parts::Parts( const Voxels& voxels, const InsideField& field, float minimumFill, TaskRunner* runner ) : m_voxels( voxels )
{
	const std::size_t count = voxels.cut.size();
	const std::size_t tasks = std::min( kMaxTasks, count );
	std::vector<Pieces> pieces( tasks );
	auto cutSome = [&]( int task ) {
		for ( std::size_t k = count * std::size_t( task ) / tasks; k < count * ( std::size_t( task ) + 1 ) / tasks; ++k )
		{
			cutPieces( k, minimumFill, field, pieces[std::size_t( task )] );
		}
	};
	runGuarded( runner, int( tasks ), cutSome );
	mergeWithFull( pieces );
}

std::uint32_t Parts::labelSamples( std::size_t cutCell, const InsideField& field, std::vector<std::uint16_t>& label ) const
{
	const int s = m_voxels.grid.samples;
	const std::size_t perCell = m_voxels.samplesPerCell();
	const std::uint8_t* flags = &m_voxels.flags[cutCell * perCell];
	const std::array<std::size_t, 3> stride = { 1, std::size_t( s ), std::size_t( s * s ) };
	UnionFind sets( perCell );
	for ( std::size_t p = 0; p < perCell; ++p )
	{
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			const bool isLast = p / stride[axis] % std::size_t( s ) == std::size_t( s - 1 );
			if ( !isLast && ( flags[p] & kSolid ) && ( flags[p + stride[axis]] & kSolid ) && !( flags[p] & kBlocked[axis] ) )
			{
				sets.join( std::uint32_t( p ), std::uint32_t( p + stride[axis] ) );
			}
		}
	}
	const auto number = [&]() {
		std::uint32_t groups = 0;
		for ( std::size_t p = 0; p < perCell; ++p )
		{
			if ( flags[p] & kSolid )
			{
				const std::uint32_t root = sets.find( std::uint32_t( p ) );
				label[p] = root == p ? std::uint16_t( groups++ ) : label[root];
			}
		}
		return groups;
	};
	label.assign( perCell, 0 );
	const std::uint32_t groups = number();
	if ( groups < 2 )
	{
		return groups;
	}
	joinDiagonally( cutCell, field, sets );
	return number();
}

void Parts::joinDiagonally( std::size_t cutCell, const InsideField& field, UnionFind& sets ) const
{
	const int s = m_voxels.grid.samples;
	const std::uint8_t* flags = &m_voxels.flags[cutCell * m_voxels.samplesPerCell()];
	const Eigen::Vector3i origin = s * m_voxels.grid.at( m_voxels.cut[cutCell] );
	const auto isSolid = [&]( const Eigen::Vector3i& p ) { return ( flags[sampleNumber( p )] & kSolid ) != 0; };
	for ( int code = 0; code < s * s * s; ++code )
	{
		const Eigen::Vector3i p( code % s, code / s % s, code / s / s );
		for ( const Eigen::Vector3i& step : diagonalSteps() )
		{
			const Eigen::Vector3i q = p + step;
			if ( !isSolid( p ) || q.minCoeff() < 0 || q.maxCoeff() >= s || !isSolid( q ) )
			{
				continue;
			}
			const std::uint32_t a = std::uint32_t( sampleNumber( p ) );
			const std::uint32_t b = std::uint32_t( sampleNumber( q ) );
			bool isFree = sets.find( a ) != sets.find( b );
			for ( int corner = 1; corner < 7 && isFree; ++corner )
			{
				// Corners of the box that the step spans, except its ends.
				const Eigen::Vector3i r = p + step.cwiseProduct( Eigen::Vector3i( corner & 1, corner >> 1 & 1, corner >> 2 ) );
				isFree = r == p || r == q || !isSolid( r );
			}
			const bool isSliver = ( ( flags[a] | flags[b] ) & kSliver ) != 0;
			if ( isFree && ( isSliver || isUnobstructed( field, m_voxels.grid, origin + p, step ) ) )
			{
				sets.join( a, b );
			}
		}
	}
}

void Parts::cutPieces( std::size_t cutCell, float minimumFill, const InsideField& field, Pieces& out ) const
{
	const int s = m_voxels.grid.samples;
	const std::size_t perCell = m_voxels.samplesPerCell();
	const std::uint8_t* flags = &m_voxels.flags[cutCell * perCell];
	std::vector<std::uint16_t> label;
	const std::uint32_t groups = labelSamples( cutCell, field, label );

	// Samples are counted as integers, so that a full cell is exactly full; thin runs contribute their own fractions.
	std::vector<Vec3d> sum( groups, Vec3d::Zero() );
	std::vector<double> weight( groups, 0.0 );
	std::vector<std::uint8_t> isReplaced( perCell, 0 );
	const Vec3d origin = m_voxels.grid.at( m_voxels.cut[cutCell] ).cast<double>();
	const auto sliver = std::lower_bound( m_voxels.slivers.begin(), m_voxels.slivers.end(), std::int32_t( cutCell ),
		[]( const Sliver& a, std::int32_t wanted ) { return a.cutCell < wanted; } );
	for ( auto it = sliver; it != m_voxels.slivers.end() && it->cutCell == std::int32_t( cutCell ); ++it )
	{
		const double fraction = double( it->fraction ) * double( perCell );
		sum[label[it->sample]] += fraction * double( s ) * ( it->point - origin );
		weight[label[it->sample]] += fraction;
		isReplaced[it->sample] |= std::uint8_t( it->hasSample ? 1 : 0 );
	}
	for ( std::size_t p = 0; p < perCell; ++p )
	{
		if ( ( flags[p] & kInside ) && !isReplaced[p] )
		{
			const int n = int( p );
			sum[label[p]] += Vec3d( n % s + 0.5, n / s % s + 0.5, n / s / s + 0.5 );
			weight[label[p]] += 1.0;
		}
	}

	std::int32_t kept = 0;
	std::vector<std::int32_t> cellOfLabel( groups, kNone );
	for ( std::uint32_t g = 0; g < groups; ++g )
	{
		const float fill = float( std::min( 1.0, weight[g] / double( perCell ) ) );
		if ( fill > 0.0f && fill >= minimumFill )
		{
			cellOfLabel[g] = kept++;
			const Vec3d within = ( sum[g] / ( weight[g] * s ) ).cwiseMax( 0.0 ).cwiseMin( 1.0 );
			out.cell.push_back( { m_voxels.cut[cutCell], std::int32_t( cutCell ), fill, origin + within } );
		}
	}
	const bool isSimple = groups == std::uint32_t( kept ) && groups <= 1;
	out.pieceCount.push_back( isSimple ? std::uint8_t( groups ) : kSeveral );
	if ( !isSimple )
	{
		out.label.insert( out.label.end(), label.begin(), label.end() );
		out.cellOfLabel.insert( out.cellOfLabel.end(), cellOfLabel.begin(), cellOfLabel.end() );
		out.labelCount.push_back( groups );
	}
}

void Parts::mergeWithFull( std::vector<Pieces>& pieces )
{
	std::int32_t labels = 0;
	std::int32_t maps = 0;
	std::size_t cells = m_voxels.full.size();
	for ( Pieces& some : pieces )
	{
		std::size_t labelled = 0;
		for ( const std::uint8_t count : some.pieceCount )
		{
			m_labelStart.push_back( count == kSeveral ? labels : kNone );
			if ( count == kSeveral )
			{
				++labels;
				m_mapStart.push_back( maps );
				maps += std::int32_t( some.labelCount[labelled++] );
			}
		}
		m_label.insert( m_label.end(), some.label.begin(), some.label.end() );
		m_cellOfLabel.insert( m_cellOfLabel.end(), some.cellOfLabel.begin(), some.cellOfLabel.end() );
		cells += some.cell.size();
	}
	m_cells.reserve( cells );
	m_keys.reserve( cells );
	auto full = m_voxels.full.begin();
	const auto add = [this]( const CellDraft& cell ) {
		m_cells.push_back( cell );
		m_keys.push_back( cell.key );
	};
	const auto addFull = [&]() {
		add( { *full, kNone, 1.0f, m_voxels.grid.at( *full ).cast<double>() + Vec3d::Constant( 0.5 ) } );
		++full;
	};
	for ( const Pieces& some : pieces )
	{
		for ( const CellDraft& cell : some.cell )
		{
			while ( full != m_voxels.full.end() && *full < cell.key )
			{
				addFull();
			}
			add( cell );
		}
	}
	while ( full != m_voxels.full.end() )
	{
		addFull();
	}
	m_index = std::make_unique<PositionIndex>( m_voxels.grid, m_keys );
}

std::pair<std::int32_t, std::int32_t> Parts::cellsAt( std::uint64_t key ) const
{
	const std::int32_t first = m_index->find( key );
	std::int32_t last = first;
	while ( last != PositionIndex::kNone && std::size_t( last ) < m_keys.size() && m_keys[std::size_t( last )] == key )
	{
		++last;
	}
	return { first, last };
}

std::int32_t Parts::cellAt( const Eigen::Vector3i& position, const Eigen::Vector3i& sample ) const
{
	const std::int32_t first = m_index->find( m_voxels.grid.key( position.x(), position.y(), position.z() ) );
	if ( first == PositionIndex::kNone || m_cells[std::size_t( first )].cutCell == kNone )
	{
		return first;
	}
	const std::size_t cutCell = std::size_t( m_cells[std::size_t( first )].cutCell );
	const std::size_t perCell = m_voxels.samplesPerCell();
	const std::size_t p = sampleNumber( sample );
	if ( !( m_voxels.flags[cutCell * perCell + p] & kSolid ) )
	{
		return kNone;
	}
	const std::int32_t labelled = m_labelStart[cutCell];
	if ( labelled == kNone )
	{
		return first;
	}
	const std::size_t label = m_label[std::size_t( labelled ) * perCell + p];
	const std::int32_t piece = m_cellOfLabel[std::size_t( m_mapStart[std::size_t( labelled )] ) + label];
	return piece == kNone ? kNone : first + piece;
}

} // namespace pliant
