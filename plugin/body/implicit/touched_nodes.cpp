#include "body/implicit/touched_nodes.h"

namespace pliant {

void TouchedNodes::begin( NodeState& nodes, const Vec3Array& velocityBefore, const ConnectedParts* parts )
{
	for ( const int node : m_touched )
	{
		m_index[std::size_t( node )] = -1;
	}
	m_touched.clear();
	m_index.resize( std::size_t( nodes.count ), -1 );
	m_all = &nodes;
	m_allBefore = &velocityBefore;
	m_allParts = parts;
	m_motion.beginFree( nodes );
}

int TouchedNodes::add( int node )
{
	int& index = m_index[std::size_t( node )];
	if ( index < 0 )
	{
		index = int( m_touched.size() );
		m_touched.push_back( node );
	}
	return index;
}

// Parts in the order of their first touched nodes; none where no node is touched.
void TouchedNodes::listParts()
{
	const std::uint32_t none = ~std::uint32_t( 0 );
	const int parts = m_allParts ? m_allParts->count() : 1;
	m_parts.of.clear();
	m_parts.node.clear();
	m_parts.start.assign( m_touched.empty() || parts > 1 ? 1 : 0, 0 );
	if ( !m_parts.areSeveral() )
	{
		return;
	}
	m_partIndex.assign( std::size_t( parts ), none );
	for ( const int node : m_touched )
	{
		std::uint32_t& part = m_partIndex[std::size_t( m_allParts ? m_allParts->partOf( node ) : 0 )];
		if ( part == none )
		{
			part = std::uint32_t( m_parts.start.size() ) - 1;
			m_parts.start.push_back( 0 );
		}
		m_parts.of.push_back( part );
		++m_parts.start[part + 1];
	}
	for ( std::size_t part = 1; part < m_parts.start.size(); ++part )
	{
		m_parts.start[part] += m_parts.start[part - 1];
	}
	m_parts.node.resize( m_touched.size() );
	for ( std::size_t k = 0; k < m_touched.size(); ++k )
	{
		m_parts.node[m_parts.start[m_parts.of[k]]++] = std::uint32_t( k ); // moves each start to the start of the next part
	}
	m_parts.start.insert( m_parts.start.begin(), 0 );
	m_parts.start.pop_back();
}

void TouchedNodes::finish()
{
	const std::size_t count = m_touched.size();
	m_nodes.count = int( count );
	m_nodes.padded = ( m_nodes.count + kLanes - 1 ) / kLanes * kLanes;
	m_nodes.origin = m_all->origin;
	for ( Vec3Array* array : { &m_nodes.x, &m_nodes.v, &m_before } )
	{
		array->resize( m_nodes.padded );
	}
	m_nodes.mass.assign( std::size_t( m_nodes.padded ), 0.0f );
	m_nodes.freedom.assign( std::size_t( m_nodes.padded ), 0.0f );
	for ( std::size_t k = 0; k < count; ++k )
	{
		const int node = m_touched[k];
		m_nodes.x.set( int( k ), m_all->x.get( node ) );
		m_nodes.v.set( int( k ), m_all->v.get( node ) );
		m_before.set( int( k ), m_allBefore->get( node ) );
		m_nodes.mass[k] = m_all->mass[std::size_t( node )];
		m_nodes.freedom[k] = m_all->freedom[std::size_t( node )];
	}
	listParts();
	m_motion.measureFree( m_nodes, &m_parts );
}

void TouchedNodes::store()
{
	for ( std::size_t k = 0; k < m_touched.size(); ++k )
	{
		m_all->v.set( m_touched[k], m_nodes.v.get( int( k ) ) );
	}
}

} // namespace pliant
