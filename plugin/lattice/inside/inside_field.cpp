// Closes rims with caps so that counting along rows works, and stores how to subtract the caps again. The unpaired edges of a surface form
// closed loops (the boundary of a boundary is empty), so a fan over each connected set of them closes it.

#include "lattice/inside/inside_field.h"

#include "lattice/constants.h"
#include "lattice/union_find.h"

#include <algorithm>
#include <cmath>

namespace pliant {

InsideField::InsideField( WeldedMesh& mesh, const std::vector<RimEdge>& rim ) : m_mesh( mesh )
{
	if ( rim.empty() )
	{
		return;
	}
	if ( double( rim.size() ) > kMaxRimFraction * double( mesh.triangle.size() ) )
	{
		m_isSoup = true;
		m_smooth = std::make_unique<WindingTree>( mesh.position, mesh.triangle );
		return;
	}
	const std::size_t vertices = mesh.position.size();
	UnionFind loops( vertices );
	for ( const RimEdge& edge : rim )
	{
		loops.join( edge.from, edge.to );
	}
	std::vector<std::uint32_t> apexOf( vertices, 0 ); // 0 is never an apex: apexes follow the vertices
	std::vector<Vec3d> middle;
	std::vector<double> weight;
	for ( const RimEdge& edge : rim )
	{
		std::uint32_t& apex = apexOf[loops.find( edge.from )];
		if ( apex == 0 )
		{
			apex = std::uint32_t( vertices + middle.size() );
			middle.push_back( Vec3d::Zero() );
			weight.push_back( 0.0 );
		}
		middle[apex - vertices] += 0.5 * ( mesh.position[edge.from] + mesh.position[edge.to] );
		weight[apex - vertices] += 1.0;
	}
	for ( std::size_t k = 0; k < middle.size(); ++k )
	{
		mesh.position.push_back( middle[k] / weight[k] );
	}
	std::vector<Triangle> reversedCaps;
	for ( const RimEdge& edge : rim )
	{
		const std::uint32_t apex = apexOf[loops.find( edge.from )];
		for ( int k = 0; k < edge.count; ++k )
		{
			m_caps.push_back( { edge.to, edge.from, apex } );
			reversedCaps.push_back( { edge.from, edge.to, apex } );
		}
	}
	m_smooth = std::make_unique<WindingTree>( mesh.position, std::move( reversedCaps ) );
}

bool InsideField::isInside( int count, const Vec3d& point ) const
{
	return m_smooth ? std::abs( winding( count, point ) ) > kInsideWinding : count != 0;
}

bool InsideField::isCrossed( const Vec3d& from, const Vec3d& to ) const
{
	if ( m_isSoup )
	{
		return m_smooth->isCrossed( from, to );
	}
	std::call_once( m_fullTreeOnce, [this]() { m_fullTree = std::make_unique<WindingTree>( m_mesh.position, m_mesh.triangle ); } );
	return m_fullTree->isCrossed( from, to );
}

InsideField::Survey InsideField::survey() const
{
	Survey survey;
	const Vec3d size = m_mesh.high - m_mesh.low;
	const auto probe = [&]( int perAxis, int code ) {
		const Vec3d at( code % perAxis + 0.5, code / perAxis % perAxis + 0.5, code / perAxis / perAxis + 0.5 );
		return Vec3d( m_mesh.low + size.cwiseProduct( at / perAxis ) );
	};
	for ( int code = 0; code < kWorkProbes * kWorkProbes * kWorkProbes; ++code )
	{
		survey.work += m_smooth->workAt( probe( kWorkProbes, code ) ) / ( kWorkProbes * kWorkProbes * kWorkProbes );
	}
	constexpr int kProbes = kVolumeProbes * kVolumeProbes * kVolumeProbes;
	if ( m_isSoup && survey.work * kProbes < kMaxSurveyWork )
	{
		for ( int code = 0; code < kProbes; ++code )
		{
			const double winding = m_smooth->at( probe( kVolumeProbes, code ) );
			const bool isInside = std::abs( winding ) > kInsideWinding;
			survey.volume += isInside ? size.prod() / kProbes : 0.0;
			survey.opposed += isInside && winding < 0.0 ? size.prod() / kProbes : 0.0;
		}
		survey.opposed = std::min( survey.opposed, survey.volume - survey.opposed );
	}
	// Caps close the surface: its volume is that of both.
	if ( !m_isSoup )
	{
		for ( const std::vector<Triangle>* triangles : { &m_mesh.triangle, &m_caps } )
		{
			for ( const Triangle& t : *triangles )
			{
				const Vec3d a = m_mesh.position[t[0]] - m_mesh.low;
				survey.volume += a.dot( ( m_mesh.position[t[1]] - m_mesh.low ).cross( m_mesh.position[t[2]] - m_mesh.low ) ) / 6.0;
			}
		}
		survey.volume = std::abs( survey.volume );
	}
	return survey;
}

} // namespace pliant
