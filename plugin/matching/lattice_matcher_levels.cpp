// What LatticeMatcher does for nodes on several levels: other tables while it runs, and the regions' stretch.

#include "matching/lattice_matcher.h"

#include <algorithm>

namespace pliant {

void LatticeMatcher::setTables( std::shared_ptr<const RegionTables> tables, const FlowHeirs& heirs )
{
	const std::vector<std::uint32_t>& heir = heirs.heir;
	if ( m_plastic )
	{
		m_plastic->carryOver( *m_tables, *tables, heirs );
	}
	m_tables = std::move( tables );
	++m_tablesVersion;
	m_strain.clear();
	m_stretch.clear();
	const std::size_t padded = std::size_t( m_tables->moments.padded );
	for ( AlignedArray<float>* array : history() )
	{
		m_historyRoom.assign( padded, array == &m_quaternion[0] ? 1.0f : 0.0f );
		for ( std::size_t i = 0; i < heir.size(); ++i )
		{
			m_historyRoom[i] = ( *array )[heir[i]];
		}
		array->swap( m_historyRoom );
	}
	allocateScratch();
	m_isHistoryNew = true;
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
		v.memberShare = m_tables->matrix->share.data();
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
	const std::size_t reserved = std::size_t( count ) + kLanes, touched = std::size_t( kRoomShare * m_tables->moments.padded );
	for ( AlignedArray<float>* array : history() )
	{
		makeRoom( *array, reserved, touched );
	}
	for ( AlignedArray<float>* array : { &m_historyRoom, &m_change[0], &m_change[1], &m_change[2] } )
	{
		makeRoom( *array, reserved, touched );
	}
	makeRoom( m_open, reserved, touched );
	for ( AlignedArray<float>* records : { &m_nodeRecord, &m_regionRecord } )
	{
		makeRoom( *records, reserved * kRecordFloats, std::size_t( kRoomShare * double( records->size() ) ) );
	}
}

/// The view that `deformations` needs, from the positions as they are: what the last substep left of them may be those of other nodes.
MatchView LatticeMatcher::viewOfNow( NodeState& nodes )
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
	const MatchView v = viewOfNow( nodes );
	m_kernels.deformations( v, 0, nodes.padded, gradients );
	// F turns with the body's frame: what the kernels see is R_b^T F.
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
	const MatchView v = viewOfNow( nodes );
	const Eigen::Matrix3f frame = m_frame.toRotationMatrix().cast<float>();
	float tile[9 * kTile];
	for ( std::size_t k = 0; k < which.size(); )
	{
		const int first = int( which[k] ) / kTile * kTile;
		m_kernels.deformations( v, first, std::min( first + kTile, nodes.padded ), tile );
		for ( ; k < which.size() && int( which[k] ) < first + kTile; ++k )
		{
			Eigen::Map<Matrix3fRows> f( gradients + 9 * k );
			f = frame * Eigen::Map<const Matrix3fRows>( tile + 9 * ( int( which[k] ) - first ) );
		}
	}
}

} // namespace pliant
