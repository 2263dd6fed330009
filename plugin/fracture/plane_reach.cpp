// Determines, without measuring strain, the cells where existing cracks can grow.

#include "fracture/plane_cracks.h"

#include "fracture/constants.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace pliant {

double PlaneCracks::Plane::distanceOf( const Vec3d& at ) const
{
	return std::sqrt( ( at - at.cwiseMax( low ).cwiseMin( high ) ).squaredNorm() );
}

// Where no crack may start, a cell matters only to a crack within whose thickness it lies, and only if some of its links cross the plane or
// it extends the crack's box. Late in a fracture, most cells along a crack do neither.
void PlaneCracks::findActive( const Lattice& lattice )
{
	if ( m_planes.size() > kMaxPlaneBits )
	{
		return; // all cells are active
	}
	const double thickness = kCrackThickness * lattice.cellSize;
	m_scratch.above.assign( m_scratch.rest.size(), 0 );
	m_scratch.inSlabs.assign( m_scratch.rest.size(), 0 );
	for ( std::size_t p = 0; p < m_planes.size(); ++p )
	{
		for ( std::uint32_t cell = 0; cell < std::uint32_t( m_scratch.rest.size() ); ++cell )
		{
			const double height = heightOver( m_planes[p], cell );
			m_scratch.above[cell] |= std::uint64_t( height >= 0.0 ? 1 : 0 ) << p;
			m_scratch.inSlabs[cell] |= std::uint64_t( std::fabs( height ) <= thickness ? 1 : 0 ) << p;
		}
	}
	for ( std::uint32_t cell = 0; cell < std::uint32_t( m_scratch.rest.size() ); ++cell )
	{
		m_scratch.isActive[cell] = m_scratch.inSlabs[cell] != 0 && hasEffect( lattice, cell ) ? 1 : 0;
	}
}

bool PlaneCracks::hasEffect( const Lattice& lattice, std::uint32_t cell ) const
{
	const std::uint64_t inSlabs = m_scratch.inSlabs[cell];
	std::uint64_t crossed = 0;
	Vec3d low = m_scratch.rest[cell], high = low;
	for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
	{
		const std::uint32_t j = lattice.linkTo[k];
		crossed |= m_scratch.above[cell] ^ m_scratch.above[j];
		low = low.cwiseMin( m_scratch.rest[j] );
		high = high.cwiseMax( m_scratch.rest[j] );
	}
	bool result = ( crossed & inSlabs ) != 0;
	for ( std::uint64_t open = inSlabs; open != 0 && !result; open &= open - 1 )
	{
		const Plane& plane = m_planes[std::size_t( std::countr_zero( open ) )];
		result = ( low.array() < plane.low.array() ).any() || ( high.array() > plane.high.array() ).any();
	}
	return result;
}

// Only cells that a crack reaches can break links: they lie within its plane's thickness and near its box, or near another such cell that
// extends the box.
void PlaneCracks::dropUnreachable( const Lattice& lattice )
{
	std::vector<std::uint8_t>& isReached = m_scratch.mark;
	isReached.assign( std::size_t( lattice.cellCount() ), 0 );
	const double reach = kCrackReach * lattice.cellSize, thickness = kCrackThickness * lattice.cellSize;
	const Vec3d ring = Vec3d::Constant( 2.0 * lattice.cellSize ); // centres of material in neighbouring cells are no farther apart
	for ( const Plane& plane : m_planes )
	{
		m_scratch.inSlab.clear();
		for ( const std::uint32_t cell : m_scratch.stretched )
		{
			if ( std::fabs( heightOver( plane, cell ) ) <= thickness )
			{
				m_scratch.inSlab.push_back( cell );
			}
		}
		Plane grown = plane;
		for ( std::size_t before = m_scratch.inSlab.size() + 1; m_scratch.inSlab.size() < before; )
		{
			before = m_scratch.inSlab.size();
			const auto isNear = [&]( std::uint32_t cell ) {
				const Vec3d& at = m_scratch.rest[cell];
				if ( grown.distanceOf( at ) > reach )
				{
					return false;
				}
				isReached[cell] = 1;
				grown.low = grown.low.cwiseMin( at - ring );
				grown.high = grown.high.cwiseMax( at + ring );
				return true;
			};
			m_scratch.inSlab.erase( std::remove_if( m_scratch.inSlab.begin(), m_scratch.inSlab.end(), isNear ), m_scratch.inSlab.end() );
		}
	}
	std::vector<std::uint32_t>& cells = m_scratch.stretched;
	cells.erase( std::remove_if( cells.begin(), cells.end(), [&]( std::uint32_t cell ) { return isReached[cell] == 0; } ), cells.end() );
}

/// Returns the cracks in whose planes the cell lies and is pulled across, a bit each; all bits if there are more planes than bits.
std::uint64_t PlaneCracks::planesOf( std::uint32_t cell, const Pull& near, double cellSize ) const
{
	std::uint64_t planes = 0;
	for ( std::size_t p = 0; p < m_planes.size(); ++p )
	{
		if ( std::fabs( heightOver( m_planes[p], cell ) ) <= kCrackThickness * cellSize &&
			std::fabs( m_planes[p].normal.dot( near.normal ) ) >= kSameCrackCosine )
		{
			planes |= m_planes.size() > kMaxPlaneBits ? ~std::uint64_t( 0 ) : std::uint64_t( 1 ) << p;
		}
	}
	return planes;
}

/// Returns the planes with an overloaded cell that is still out of reach. The order of processing affects a cell's assignment only if one
/// of these is among its planes, and only relative to other such cells.
std::uint64_t PlaneCracks::unreachedPlanes( double cellSize ) const
{
	if ( m_planes.size() > kMaxPlaneBits )
	{
		return ~std::uint64_t( 0 );
	}
	std::uint64_t far = 0;
	for ( const Overload& overload : m_scratch.found )
	{
		for ( std::uint64_t open = overload.planes & ~far; open != 0; open &= open - 1 )
		{
			const std::size_t p = std::size_t( std::countr_zero( open ) );
			far |= m_planes[p].distanceOf( m_scratch.rest[overload.cell] ) > kCrackReach * cellSize ? std::uint64_t( 1 ) << p : 0;
		}
	}
	return far;
}

} // namespace pliant
