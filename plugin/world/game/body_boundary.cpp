#include "world/game/body_boundary.h"

#include "body/levels/levels.h"

namespace pliant {

// The map of a node from the rest shape: its rotation and plastic flow; on bodies with levels, where nodes are large, its whole
// deformation.
void BodyBoundary::measureMaps( const Body& body )
{
	using RowMajor = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
	const std::size_t count = std::size_t( body.nodeCount() );
	m_map.resize( count );
	if ( body.levels() )
	{
		m_gradients.resize( 9 * std::size_t( body.nodes().padded ) );
		body.nodeDeformations( m_gradients.data() );
		for ( std::size_t i = 0; i < count; ++i )
		{
			m_map[i] = Eigen::Map<const RowMajor>( m_gradients.data() + 9 * i );
		}
		return;
	}
	m_rotations.resize( 4 * count );
	body.nodeRotations( m_rotations.data() );
	const bool hasFlowed = body.hasFlowed();
	if ( hasFlowed )
	{
		m_flow.resize( 9 * count );
		body.nodeFlow( m_flow.data() );
	}
	for ( std::size_t i = 0; i < count; ++i )
	{
		m_map[i] = Eigen::Map<const Eigen::Quaternionf>( m_rotations.data() + 4 * i ).toRotationMatrix();
		if ( hasFlowed )
		{
			m_map[i] *= Eigen::Map<const RowMajor>( m_flow.data() + 9 * i );
		}
	}
}

void BodyBoundary::update( const Body& body, unsigned version )
{
	if ( !m_isKnown || m_version != version )
	{
		m_cells = findBoundary( body.lattice() );
		m_version = version;
		m_isKnown = true;
	}
	measureMaps( body );
	const NodeState& nodes = body.nodes();
	m_position.resize( std::size_t( count() ) );
	m_area.assign( std::size_t( count() ), Vec3d::Zero() );
	m_volume.assign( std::size_t( m_cells.surfaceCount() ), 0.0 );
	m_parts.assign( std::size_t( body.nodeCount() ), 0.0f );
	for ( int p = 0; p < count(); ++p )
	{
		const Vec3 rest = m_cells.restPosition[std::size_t( p )];
		Vec3d sum = Vec3d::Zero();
		forNodes( body, p, [&]( int node, double fraction ) {
			sum += fraction * ( nodes.x.get( node ) + m_map[std::size_t( node )] * ( rest - nodes.x0.get( node ) ) ).cast<double>();
			m_parts[std::size_t( node )] += float( fraction );
		} );
		m_position[std::size_t( p )] = sum;
	}
	for ( const std::array<std::uint32_t, 4>& quad : m_cells.quads )
	{
		const Vec3d area = 0.5 * ( m_position[quad[2]] - m_position[quad[0]] ).cross( m_position[quad[3]] - m_position[quad[1]] );
		Vec3d middle = Vec3d::Zero();
		for ( const std::uint32_t point : quad )
		{
			m_area[point] += 0.25 * area;
			middle += 0.25 * m_position[point];
		}
		m_volume[m_cells.surface[quad[0]]] += middle.dot( area ) / 3.0;
	}
}

Vec3d BodyBoundary::velocity( const Body& body, int point ) const
{
	Vec3d sum = Vec3d::Zero();
	forNodes( body, point, [&]( int node, double fraction ) { sum += fraction * body.nodes().v.get( node ).cast<double>(); } );
	return sum;
}

double BodyBoundary::mass( const Body& body, int point ) const
{
	double sum = 0.0;
	forNodes( body, point, [&]( int node, double fraction ) {
		sum += fraction * double( body.nodes().mass[node] ) / double( m_parts[std::size_t( node )] );
	} );
	return sum;
}

} // namespace pliant
