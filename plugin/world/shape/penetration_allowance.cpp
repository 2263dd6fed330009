#include "world/shape/penetration_allowance.h"

#include "adapt/octree/octree.h"

#include <algorithm>
#include <limits>

namespace pliant {

void PenetrationAllowance::follow( const std::vector<std::uint32_t>& nodeNow, int nodeCount )
{
	std::vector<float> leave( std::size_t( nodeCount ), std::numeric_limits<float>::infinity() );
	for ( std::size_t before = 0; before < nodeNow.size(); ++before )
	{
		if ( nodeNow[before] != kNoNode )
		{
			leave[nodeNow[before]] = isAny() ? m_leave[before] : 0.0f;
		}
	}
	m_leave.swap( leave );
	m_found.assign( m_leave.size(), 0.0f );
}

PenetrationAllowance PenetrationAllowance::of( const PenetrationAllowance& parent, const std::vector<std::uint32_t>& nodeBefore )
{
	PenetrationAllowance own;
	for ( std::size_t node = 0; parent.isAny() && node < nodeBefore.size(); ++node )
	{
		own.m_leave.push_back( parent.m_leave[nodeBefore[node]] );
	}
	own.m_found.assign( own.m_leave.size(), 0.0f );
	return own;
}

double PenetrationAllowance::leave( int node, double depth )
{
	const std::size_t i = std::size_t( node );
	if ( !isAny() || !( m_leave[i] > 0.0f ) )
	{
		return 0.0;
	}
	const double given = std::min( depth, double( m_leave[i] ) );
	m_found[i] = std::max( m_found[i], float( given ) );
	return given;
}

void PenetrationAllowance::endPhase( double out )
{
	bool isAnyLeft = false;
	for ( std::size_t i = 0; i < m_leave.size(); ++i )
	{
		m_leave[i] = std::max( 0.0f, m_found[i] - float( out ) );
		m_found[i] = 0.0f;
		isAnyLeft = isAnyLeft || m_leave[i] > 0.0f;
	}
	if ( !isAnyLeft )
	{
		m_leave.clear();
	}
}

} // namespace pliant
