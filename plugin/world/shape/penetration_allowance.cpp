#include "world/shape/penetration_allowance.h"

#include "adapt/octree/octree.h"
#include "archive/archive.h"

#include <algorithm>
#include <limits>

namespace pliant {

void PenetrationAllowance::follow( const std::vector<std::uint32_t>& nodeNow, int nodeCount )
{
	std::vector<float> allowed( std::size_t( nodeCount ), std::numeric_limits<float>::infinity() );
	for ( std::size_t before = 0; before < nodeNow.size(); ++before )
	{
		if ( nodeNow[before] != kNoNode )
		{
			allowed[nodeNow[before]] = isAny() ? m_allowed[before] : 0.0f;
		}
	}
	m_allowed.swap( allowed );
	m_found.assign( m_allowed.size(), 0.0f );
}

PenetrationAllowance PenetrationAllowance::of( const PenetrationAllowance& parent, const std::vector<std::uint32_t>& nodeBefore )
{
	PenetrationAllowance own;
	for ( std::size_t node = 0; parent.isAny() && node < nodeBefore.size(); ++node )
	{
		own.m_allowed.push_back( parent.m_allowed[nodeBefore[node]] );
	}
	own.m_found.assign( own.m_allowed.size(), 0.0f );
	return own;
}

double PenetrationAllowance::allowedDepth( int node, double depth )
{
	const std::size_t i = std::size_t( node );
	if ( !isAny() || !( m_allowed[i] > 0.0f ) )
	{
		return 0.0;
	}
	const double given = std::min( depth, double( m_allowed[i] ) );
	m_found[i] = std::max( m_found[i], float( given ) );
	return given;
}

void PenetrationAllowance::endPhase( double out )
{
	bool isAnyLeft = false;
	for ( std::size_t i = 0; i < m_allowed.size(); ++i )
	{
		m_allowed[i] = std::max( 0.0f, m_found[i] - float( out ) );
		m_found[i] = 0.0f;
		isAnyLeft = isAnyLeft || m_allowed[i] > 0.0f;
	}
	if ( !isAnyLeft )
	{
		m_allowed.clear();
	}
}

void PenetrationAllowance::archive( Archive& archive, int nodeCount )
{
	archive( m_allowed, m_found );
	archive.require( ( m_allowed.empty() || m_allowed.size() == std::size_t( nodeCount ) ) &&
			( m_allowed.empty() || m_found.size() == m_allowed.size() ),
		"An allowance is that of another body." );
}

} // namespace pliant
