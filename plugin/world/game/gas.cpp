// Gas in the cavities of a hollow body. Once a crack has opened a cavity, its gas is gone.

#include "lattice/attempt.h"
#include "lattice/ranges.h"
#include "world/bodies/placing.h"
#include "world/bodies/soft_body_impl.h"
#include "world/game/constants.h"
#include "world/game/force_fields.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pliant {

namespace {

bool haveCommonCell( const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b )
{
	std::vector<std::uint32_t> common;
	std::set_intersection( a.begin(), a.end(), b.begin(), b.end(), std::back_inserter( common ) );
	return !common.empty();
}

std::vector<std::uint32_t> wallOf( const Body& body, const CellBoundary& cells, int surface )
{
	std::vector<std::uint32_t> wall;
	for ( int p = 0; p < cells.pointCount(); ++p )
	{
		if ( cells.surface[std::size_t( p )] != std::uint32_t( surface ) )
		{
			continue;
		}
		for ( std::uint32_t k = cells.cellStart[std::size_t( p )]; k < cells.cellStart[std::size_t( p ) + 1]; ++k )
		{
			wall.push_back( body.firstCells().empty() ? cells.cell[k] : body.firstCells()[cells.cell[k]] );
		}
	}
	std::sort( wall.begin(), wall.end() );
	wall.erase( std::unique( wall.begin(), wall.end() ), wall.end() );
	return wall;
}

/// The absolute pressure of an ideal gas that pushes its walls away meanwhile: p = amount / ( volume + give ( p - before ) ), Pa.
double idealPressure( double amount, double volume, double give, double before )
{
	if ( give <= 0.0 )
	{
		return volume > 0.0 ? amount / volume : before;
	}
	const double b = volume - give * before;
	return ( std::sqrt( b * b + 4.0 * give * amount ) - b ) / ( 2.0 * give );
}

} // namespace

std::unique_ptr<SurfaceForces> SurfaceForces::ofPiece( const SurfaceForces* whole, unsigned version )
{
	if ( !whole || whole->gas.law == GasLaw::None )
	{
		return nullptr;
	}
	auto forces = std::make_unique<SurfaceForces>();
	forces->gas = whole->gas;
	forces->cavities = whole->cavities;
	forces->cavityVersion = version; // found again before use
	return forces;
}

void SurfaceForces::findCavities( const Body& body, unsigned version, bool isNew )
{
	const CellBoundary& cells = boundary.cells();
	std::vector<GasCavity> found;
	for ( int s = 0; s < cells.surfaceCount(); ++s )
	{
		if ( cells.restVolume[std::size_t( s )] >= 0.0 )
		{
			continue;
		}
		GasCavity cavity;
		cavity.cells = wallOf( body, cells, s );
		cavity.surface = s;
		bool isFilled = isNew;
		cavity.pressure = double( gas.pressure );
		cavity.amount = ( double( gas.outside ) + cavity.pressure ) * -boundary.volume( s );
		for ( const GasCavity& before : cavities )
		{
			if ( !isFilled && haveCommonCell( before.cells, cavity.cells ) )
			{
				cavity.amount = before.amount;
				cavity.pressure = before.pressure;
				isFilled = true;
			}
		}
		if ( isFilled )
		{
			found.push_back( std::move( cavity ) );
		}
	}
	cavities = std::move( found );
	cavityVersion = version;
}

// A stiff gas between light walls swings faster than a substep: the pressure is that at the end of the substep, with the walls moved by
// their velocity and by the change of pressure, which is exact at rest and stable at any stiffness.
void SurfaceForces::pushWalls( const Body& body, unsigned version, double h )
{
	if ( cavityVersion != version )
	{
		findCavities( body, version, false );
	}
	const NodeState& nodes = body.nodes();
	for ( GasCavity& cavity : cavities )
	{
		cavityNodeForce.assign( std::size_t( nodes.count ), Vec3d::Zero() );
		double growth = 0.0; // of the volume, m^3/s
		for ( int p = 0; p < boundary.count(); ++p )
		{
			if ( boundary.cells().surface[std::size_t( p )] == std::uint32_t( cavity.surface ) )
			{
				growth -= boundary.velocity( body, p ).dot( boundary.area( p ) );
				boundary.forNodes(
					body, p, [&]( int node, double fraction ) { cavityNodeForce[std::size_t( node )] -= fraction * boundary.area( p ); } );
			}
		}
		double give = 0.0; // of the volume in a substep to a pressure, m^3/Pa
		for ( int i = 0; i < nodes.count; ++i )
		{
			give += h * h * double( nodes.freedom[i] / nodes.mass[i] ) * cavityNodeForce[std::size_t( i )].squaredNorm();
		}
		if ( gas.law == GasLaw::Ideal )
		{
			const double outside = double( gas.outside );
			cavity.pressure = idealPressure(
								  cavity.amount, h * growth - boundary.volume( cavity.surface ), give, cavity.pressure + outside ) -
				outside;
		}
		for ( int p = 0; p < boundary.count(); ++p )
		{
			if ( boundary.cells().surface[std::size_t( p )] == std::uint32_t( cavity.surface ) )
			{
				add( body, p, -cavity.pressure * boundary.area( p ) );
			}
		}
	}
}

Status SoftBody::setGas( const Gas& gas )
{
	return attempt( [&]() {
		insist( m_impl->checkTime( "setGas" ) );
		const bool isLaw = isChoice( gas.law, GasLaw::Ideal );
		const bool isGood = isLaw && std::isfinite( gas.pressure ) && btFabs( gas.pressure ) <= kMostPressure && gas.outside >= 0 &&
			gas.outside <= kMostPressure && ( gas.law != GasLaw::Ideal || gas.pressure > -gas.outside );
		rejectIf( !isGood, ResultCode::BadSettings, "setGas: the law or a pressure is out of range." );
		auto forces = std::make_unique<SurfaceForces>();
		forces->gas = gas;
		if ( gas.law != GasLaw::None )
		{
			forces->boundary.update( *m_impl->body, m_impl->fractureVersion );
			forces->findCavities( *m_impl->body, m_impl->fractureVersion, true );
			rejectIf( forces->cavities.empty(), "setGas", "the body has no closed cavity (LatticeSettings::shell, Shell::Always)." );
		}
		m_impl->forces = std::move( forces );
		activate( true );
	} );
}

Gas SoftBody::gas() const
{
	return m_impl->forces ? m_impl->forces->gas : Gas{};
}

btScalar SoftBody::gasPressure( int cavity ) const
{
	const bool isThere = m_impl->forces && cavity >= 0 && cavity < int( m_impl->forces->cavities.size() );
	return isThere ? btScalar( m_impl->forces->cavities[std::size_t( cavity )].pressure ) : btScalar( 0 );
}

btScalar SoftBody::gasVolume( int cavity ) const
{
	if ( !m_impl->forces )
	{
		return btScalar( 0 );
	}
	SurfaceForces& forces = *m_impl->forces;
	forces.boundary.update( *m_impl->body, m_impl->fractureVersion );
	if ( forces.cavityVersion != m_impl->fractureVersion )
	{
		forces.findCavities( *m_impl->body, m_impl->fractureVersion, false ); // it has broken since
	}
	if ( cavity < 0 || cavity >= int( forces.cavities.size() ) )
	{
		return btScalar( 0 );
	}
	return btScalar( -forces.boundary.volume( forces.cavities[std::size_t( cavity )].surface ) );
}

} // namespace pliant
