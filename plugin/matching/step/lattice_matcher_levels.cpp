// LatticeMatcher for nodes on several levels: replacing the tables at run time, and the regions' deformations.

#include "matching/step/lattice_matcher.h"

#include "matching/step/settle_region.h"

#include <algorithm>

namespace pliant {

void LatticeMatcher::setTables( std::shared_ptr<const RegionTables> tables, const FlowSources& sources )
{
	const std::vector<std::uint32_t>& source = sources.source;
	if ( m_plastic )
	{
		m_plastic->carryOver( *m_tables, *tables, sources );
	}
	m_tables = std::move( tables );
	++m_tablesVersion;
	m_strain.clear();
	m_stretch.clear();
	m_volumeSize.clear();
	const std::size_t padded = std::size_t( m_tables->moments.padded );
	for ( AlignedArray<float>* array : history() )
	{
		m_historyScratch.assign( padded, array == &m_quaternion[0] ? 1.0f : 0.0f );
		for ( std::size_t i = 0; i < source.size(); ++i )
		{
			m_historyScratch[i] = ( *array )[source[i]];
		}
		array->swap( m_historyScratch );
	}
	allocateScratch();
	m_isHistoryForeign = true;
}

void LatticeMatcher::viewLevels( MatchView& v ) const
{
	const auto dataOrNull = []( const AlignedArray<float>& array ) { return array.empty() ? nullptr : array.data(); };
	if ( m_tables->plan )
	{
		v.start = m_tables->plan->start.data();
		v.member = m_tables->plan->term.data();
	}
	else
	{
		v.start = m_tables->matrix->start.data();
		v.member = m_tables->matrix->member.data();
		v.memberMass = m_tables->matrix->mass.data();
		v.memberFraction = m_tables->matrix->fraction.data();
	}
	v.regionBeta = dataOrNull( m_tables->beta );
	v.regionEta = dataOrNull( m_tables->eta );
}

void LatticeMatcher::viewBlend( MatchView& v ) const
{
	for ( int k = 0; k < 9; ++k )
	{
		v.blend[k] = m_tables->blend[k].empty() ? nullptr : m_tables->blend[k].data();
	}
}

bool LatticeMatcher::nodeFlow( int count, float* stretches ) const
{
	for ( int i = 0; m_plastic && i < count; ++i )
	{
		Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>( stretches + 9 * std::size_t( i ) ) = m_plastic->stretch( i ).cast<float>();
	}
	return hasFlowed();
}

std::array<AlignedArray<float>*, 7> LatticeMatcher::history()
{
	return { &m_quaternion[0], &m_quaternion[1], &m_quaternion[2], &m_quaternion[3], &m_residual[0], &m_residual[1], &m_residual[2] };
}

void LatticeMatcher::reserveNodes( int count )
{
	const std::size_t reserved = std::size_t( count ) + kLanes, touched = std::size_t( kScratchFraction * m_tables->moments.padded );
	for ( AlignedArray<float>* array : history() )
	{
		reserveScratch( *array, reserved, touched );
	}
	for ( AlignedArray<float>* array : { &m_historyScratch, &m_change[0], &m_change[1], &m_change[2] } )
	{
		reserveScratch( *array, reserved, touched );
	}
	reserveScratch( m_open, reserved, touched );
	for ( AlignedArray<float>* records : { &m_nodeRecord, &m_regionRecord } )
	{
		reserveScratch( *records, reserved * kRecordFloats, std::size_t( kScratchFraction * double( records->size() ) ) );
	}
}

/// The view that `deformations` needs, from the current positions: the last substep's records may belong to other nodes.
MatchView LatticeMatcher::currentView( NodeState& nodes )
{
	MatchView v = view( nodes );
	float sum[kFrameSums] = {};
	m_kernels.frameSums( v, 0, nodes.padded, sum );
	setFrame( v, Vec3d( sum[0], sum[1], sum[2] ) / double( sum[12] ) );
	m_kernels.nodeRecords( v, 0, nodes.padded );
	sumNodeRecords( v, nullptr );
	return v;
}

namespace {

using Matrix3fRows = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

} // namespace

void LatticeMatcher::deformations( NodeState& nodes, float* gradients )
{
	const MatchView v = currentView( nodes );
	m_kernels.deformations( v, 0, nodes.padded, gradients );
	// The kernels return R_b^T F, relative to the body's frame.
	const Eigen::Matrix3f frame = m_frame.toRotationMatrix().cast<float>();
	for ( int i = 0; i < nodes.count; ++i )
	{
		Eigen::Map<Matrix3fRows> f( gradients + 9 * i );
		f = frame * f;
	}
}

void LatticeMatcher::deformationsOf( NodeState& nodes, const std::vector<std::uint32_t>& which, float* gradients )
{
	if ( which.empty() )
	{
		return;
	}
	const MatchView v = currentView( nodes );
	const Eigen::Matrix3f frame = m_frame.toRotationMatrix().cast<float>();
	float tile[9 * kTile];
	for ( std::size_t k = 0; k < which.size(); )
	{
		const int first = int( which[k] ) / kTile * kTile;
		m_kernels.deformations( v, first, std::min( first + kTile, nodes.padded ), tile );
		for ( ; k < which.size() && int( which[k] ) / kTile * kTile == first; ++k )
		{
			Eigen::Map<Matrix3fRows> f( gradients + 9 * k );
			f = frame * Eigen::Map<const Matrix3fRows>( tile + 9 * ( int( which[k] ) - first ) );
		}
	}
}

// Marks the tiles of the given nodes and of their regions. With a sum plan any region may contribute.
void LatticeMatcher::markTiles( const MatchView& view, const std::vector<std::uint32_t>& which )
{
	const std::size_t tiles = std::size_t( view.nodeCount + kTile - 1 ) / kTile;
	m_neededNodeTiles.assign( tiles, 0 );
	m_neededRegionTiles.assign( tiles, m_tables->plan ? 1 : 0 );
	for ( const std::uint32_t i : which )
	{
		m_neededNodeTiles[i / kTile] = 1;
		for ( std::uint32_t k = view.start[i]; k < view.start[i + 1] && !m_tables->plan; ++k )
		{
			m_neededRegionTiles[view.member[k] / kTile] = 1;
		}
	}
}

void LatticeMatcher::fitTiles( const MatchView& view )
{
	const int padded = m_tables->moments.padded;
	for ( std::size_t tile = 0; tile < m_neededRegionTiles.size(); ++tile )
	{
		const int first = int( tile ) * kTile;
		const int open = m_neededRegionTiles[tile] == 0
			? 0
			: m_kernels.fitRegions( view, first, std::min( first + kTile, padded ), m_open.data() );
		for ( int k = 0; k < open; ++k )
		{
			settleRegion( m_kernels, view, int( m_open[std::size_t( k )] ) );
		}
	}
}

void LatticeMatcher::offsetsOf( NodeState& nodes, const std::vector<std::uint32_t>& which, float* offsets )
{
	MatchView v = currentView( nodes );
	// The step's own kernels with a material without resistance: L = R + beta ( F - R ) = F
	v.beta = 1.0f;
	v.volumeFraction = 0.0f;
	v.regionBeta = v.regionEta = v.regionWeight = v.pull = nullptr;
	std::fill( std::begin( v.blend ), std::end( v.blend ), nullptr );
	markTiles( v, which );
	fitTiles( v );
	if ( m_tables->plan )
	{
		depthSum( *m_tables->plan, m_regionRecord.data() );
	}
	float unused[kImpulseSums] = {};
	for ( std::size_t tile = 0; tile < m_neededNodeTiles.size(); ++tile )
	{
		if ( m_neededNodeTiles[tile] != 0 )
		{
			m_kernels.scatter( v, int( tile ) * kTile, std::min( int( tile + 1 ) * kTile, nodes.padded ), unused );
		}
	}
	const Eigen::Matrix3f frame = m_frame.toRotationMatrix().cast<float>() * m_cellSize;
	for ( std::size_t k = 0; k < which.size(); ++k )
	{
		const Vec3 e( m_residual[0][which[k]], m_residual[1][which[k]], m_residual[2][which[k]] );
		Eigen::Map<Vec3>( offsets + 3 * k ) = frame * e;
	}
	for ( AlignedArray<float>& residual : m_residual ) // all other residuals depend on regions that were not fitted
	{
		std::fill( residual.begin(), residual.end(), 0.0f );
	}
}

// From the records of fitRegions: b ( g - x ) = D q + t - b ( 1 - eta ) u, D and t the region's record, u the node's displacement in the
// body's rotating frame. The pulls of a region sum to zero, so a constant vector may be added to its nodes' positions:
// x - c - R S ( q - c0 ) becomes u + ( 1 - R S )( q - c0 ).
RegionWork LatticeMatcher::workOf( const MatchView& view, std::uint32_t r ) const
{
	const RegionMatrix& matrix = *m_tables->matrix;
	const float* const record = view.regionRecord + std::size_t( r ) * kRecordFloats;
	const Eigen::Matrix3d pull = Eigen::Map<const Matrix3fRows>( record ).cast<double>();
	const Vec3d shift = Eigen::Map<const Vec3>( record + 9 ).cast<double>();
	const double own = double( view.regionWeight ? view.regionWeight[r] : 1.0f ) *
		( 1.0 - double( view.regionEta ? view.regionEta[r] : 0.0f ) );
	const Eigen::Quaterniond rotation( m_quaternion[0][r], m_quaternion[1][r], m_quaternion[2][r], m_quaternion[3][r] );
	Eigen::Matrix3d rest = rotation.toRotationMatrix();
	if ( m_plastic )
	{
		rest *= m_plastic->stretch( int( r ) );
	}
	rest = Eigen::Matrix3d::Identity() - rest;
	const Vec3d centre( view.centre[0][r], view.centre[1][r], view.centre[2][r] );
	RegionWork work;
	for ( std::uint32_t k = matrix.start[r]; k < matrix.start[r + 1]; ++k )
	{
		const std::uint32_t a = matrix.member[k];
		const Vec3d &q = m_nodeMotion[a].q, &u = m_nodeMotion[a].u, &v = m_nodeMotion[a].v;
		const Vec3d displacement = pull * q + shift - own * u;
		const double mass = matrix.mass[k] * matrix.unit[a];
		work.springs -= 0.5 * mass * ( u + rest * ( q - centre ) ).dot( displacement );
		work.power += mass * v.dot( displacement );
	}
	return work;
}

RegionWork LatticeMatcher::workOf( NodeState& nodes, const std::vector<std::uint32_t>& regions )
{
	const MatchView v = currentView( nodes );
	m_neededRegionTiles.assign( std::size_t( v.nodeCount + kTile - 1 ) / kTile, 0 );
	for ( const std::uint32_t r : regions )
	{
		m_neededRegionTiles[r / kTile] = 1;
	}
	fitTiles( v );
	const Eigen::Matrix3d toFrame = m_frame.toRotationMatrix().transpose();
	m_nodeMotion.resize( std::size_t( v.nodeCount ) );
	for ( std::size_t a = 0; a < m_nodeMotion.size(); ++a ) // each is a member of many regions
	{
		m_nodeMotion[a] = NodeMotion{ Vec3d( v.x0[0][a], v.x0[1][a], v.x0[2][a] ) * double( v.cellsPerMetre ),
			Vec3d( v.change[0][a], v.change[1][a], v.change[2][a] ), toFrame * Vec3d( v.v[0][a], v.v[1][a], v.v[2][a] ) };
	}
	RegionWork sum;
	for ( const std::uint32_t r : regions )
	{
		const RegionWork work = workOf( v, r );
		sum.springs += work.springs;
		sum.power += work.power;
	}
	const double d = double( m_cellSize );
	return RegionWork{ sum.springs * d * d, sum.power * d };
}

} // namespace pliant
