// What LatticeMatcher does for nodes on several levels: other tables while it runs, and the regions' stretch.

#include "matching/lattice_matcher.h"

namespace pliant {

void LatticeMatcher::setTables( std::shared_ptr<const RegionTables> tables, const FlowHeirs& heirs )
{
	const std::vector<std::uint32_t>& heir = heirs.heir;
	if ( m_plastic )
	{
		m_plastic->carryOver( *m_tables, *tables, heirs );
	}
	AlignedArray<float> quaternion[4], residual[3];
	for ( int k = 0; k < 4; ++k )
	{
		quaternion[k].swap( m_quaternion[k] );
	}
	for ( int k = 0; k < 3; ++k )
	{
		residual[k].swap( m_residual[k] );
	}
	m_tables = std::move( tables );
	m_strain = {};
	allocate();
	for ( std::size_t i = 0; i < heir.size(); ++i )
	{
		for ( int k = 0; k < 4; ++k )
		{
			m_quaternion[k][i] = quaternion[k][heir[i]];
		}
		for ( int k = 0; k < 3; ++k )
		{
			m_residual[k][i] = residual[k][heir[i]];
		}
	}
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
	for ( int k = 0; k < 9; ++k )
	{
		v.blend[k] = dataOrNull( m_tables->blend[k] );
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

void LatticeMatcher::deformations( NodeState& nodes, float* gradients )
{
	// From the positions as they are: what the last substep left of them may be those of other nodes.
	MatchView v = view( nodes );
	float sum[kFrameSums] = {};
	m_kernels.frameSums( v, 0, nodes.padded, sum );
	setFrame( v, Vec3d( sum[0], sum[1], sum[2] ) / double( sum[12] ) );
	m_kernels.nodeRecords( v, 0, nodes.padded );
	sumNodeRecords( v, nullptr );
	m_kernels.deformations( v, 0, nodes.padded, gradients );
	// F turns with the body's frame: what the kernels see is R_b^T F.
	const Eigen::Matrix3f frame = m_frame.toRotationMatrix().cast<float>();
	for ( int i = 0; i < nodes.count; ++i )
	{
		Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> f( gradients + 9 * i );
		f = frame * f;
	}
}

} // namespace pliant
