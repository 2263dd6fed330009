#include "surface/crack_complex/blade_path.h"

#include "surface/constants.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pliant {

namespace {

/// Entries of a symmetric matrix: xx, yy, zz, yz, xz, xy.
constexpr int kRow[6] = { 0, 1, 2, 1, 0, 0 }, kColumn[6] = { 0, 1, 2, 2, 2, 1 };

} // namespace

BladePath::BladePath( std::shared_ptr<const CellComplex> complex ) :
	m_complex( std::move( complex ) ), m_start( m_complex->cellCount(), CellComplex::kNone ),
	m_outward( m_complex->pointCount(), std::array<float, 6>{} )
{
	std::vector<float> whole( m_complex->pointCount(), 0.0f );
	for ( const auto& corner : m_complex->triangle )
	{
		const auto at = [&]( std::size_t k ) { return m_complex->pointRest[m_complex->vertexPoint[corner[k]]]; };
		const Vec3 across = ( at( 1 ) - at( 0 ) ).cross( at( 2 ) - at( 0 ) );
		const float area = across.norm();
		for ( std::size_t k = 0; area > 0.0f && k < 3; ++k )
		{
			const std::uint32_t point = m_complex->vertexPoint[corner[k]];
			whole[point] += area;
			for ( int e = 0; e < 6; ++e )
			{
				m_outward[point][std::size_t( e )] += across[kRow[e]] * across[kColumn[e]] / area;
			}
		}
	}
	for ( std::size_t point = 0; point < whole.size(); ++point )
	{
		for ( float& entry : m_outward[point] )
		{
			entry = whole[point] > 0.0f ? entry / whole[point] : 0.0f;
		}
	}
}

std::vector<std::uint32_t> BladePath::add( const std::vector<CutTrace>& traces )
{
	std::vector<std::uint32_t> points;
	for ( const CutTrace& trace : traces )
	{
		const std::uint32_t cells[2] = { trace.link.a, trace.link.b };
		m_next.push_back( { m_start[cells[0]], m_start[cells[1]] } );
		for ( std::uint32_t k = 0; k < 2; ++k )
		{
			m_start[cells[k]] = std::uint32_t( 2 * m_trace.size() ) + k;
			points.insert( points.end(), m_complex->pointsOfCell.begin( cells[k] ), m_complex->pointsOfCell.end( cells[k] ) );
		}
		m_trace.push_back( trace );
	}
	std::sort( points.begin(), points.end() );
	points.erase( std::unique( points.begin(), points.end() ), points.end() );
	return points;
}

std::vector<BladePath::Near> BladePath::nearTo( std::uint32_t point, const Vec3& at ) const
{
	std::vector<Near> near;
	const std::uint32_t* const first = m_complex->cellsOfPoint.begin( point );
	const std::uint32_t* const last = m_complex->cellsOfPoint.end( point );
	const float softening = kNearTrace * m_complex->cellSize * kNearTrace * m_complex->cellSize;
	for ( const std::uint32_t* cell = first; cell != last; ++cell )
	{
		for ( std::uint32_t entry = m_start[*cell]; entry != CellComplex::kNone; entry = m_next[entry / 2][entry % 2] )
		{
			const CutTrace& trace = m_trace[entry / 2];
			const bool isBetween = std::binary_search( first, last, entry % 2 == 0 ? trace.link.b : trace.link.a );
			if ( isBetween && entry % 2 == 1 )
			{
				continue; // listed with its first cell
			}
			const float height = trace.normal.dot( at - trace.point );
			near.push_back( Near{
				entry / 2, 1.0f / ( ( at - trace.point ).squaredNorm() + softening ), entry % 2 == 0 ? -height : height, isBetween } );
		}
	}
	std::sort( near.begin(), near.end(),
		[]( const Near& a, const Near& b ) { return a.weight != b.weight ? a.weight > b.weight : a.trace < b.trace; } );
	return near;
}

/// The displacement m that leads one metre further along `normal`: it minimises | m |^2 + k m^T S m + k' | S m |^2 subject to n . m = 1,
/// with S from m_outward. With K = ( 1 + k S + k' S^2 )^-1 it is K n / ( n . K n ): along the normal inside, along the outer surface on it,
/// along the edge in a crease.
Vec3 BladePath::exitDisplacement( std::uint32_t point, const Vec3& normal ) const
{
	Eigen::Matrix3f outward;
	for ( int e = 0; e < 6; ++e )
	{
		outward( kRow[e], kColumn[e] ) = outward( kColumn[e], kRow[e] ) = m_outward[point][std::size_t( e )];
	}
	const Eigen::Matrix3f stiff = Eigen::Matrix3f::Identity() + kSlide * outward + kSlideFlat * outward * outward;
	const Vec3 along = stiff.inverse() * normal;
	return along / normal.dot( along );
}

/// Moves a position onto the surface given by the nearest trace and those of similar normal, and removes these from the list.
Vec3 BladePath::moved( std::uint32_t point, const Vec3& at, std::vector<Near>& near ) const
{
	const Vec3 leading = m_trace[near.front().trace].normal;
	Vec3 normal = Vec3::Zero();
	float height = 0.0f, side = 0.0f, weight = 0.0f;
	bool isBetween = false;
	const auto isLike = [&]( const Near& one ) { return std::abs( m_trace[one.trace].normal.dot( leading ) ) > kSameSurface; };
	for ( const Near& one : near )
	{
		if ( !isLike( one ) )
		{
			continue;
		}
		const CutTrace& trace = m_trace[one.trace];
		const float turn = trace.normal.dot( leading ) < 0.0f ? -1.0f : 1.0f;
		normal += one.weight * turn * trace.normal;
		height += one.weight * turn * trace.normal.dot( at - trace.point );
		side += one.weight * one.side;
		weight += one.weight;
		isBetween = isBetween || one.isBetween;
	}
	near.erase( std::remove_if( near.begin(), near.end(), isLike ), near.end() );
	if ( !isBetween && side >= 0.0f )
	{
		return at; // it is on its own side
	}
	const Vec3 move = -height / weight * exitDisplacement( point, normal.normalized() );
	const float length = move.norm(), most = kFarthestMove * m_complex->cellSize;
	return at + ( length > most ? most / length : 1.0f ) * move;
}

Vec3 BladePath::positionOf( std::uint32_t point ) const
{
	const Vec3& rest = m_complex->pointRest[point];
	if ( m_trace.empty() )
	{
		return rest;
	}
	std::vector<Near> near = nearTo( point, rest );
	if ( near.empty() )
	{
		return rest;
	}
	Vec3 at = moved( point, rest, near );
	// Where a second cut crosses the first, the point lies on both.
	return near.empty() ? at : moved( point, at, near );
}

} // namespace pliant
