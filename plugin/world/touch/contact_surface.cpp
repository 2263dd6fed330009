#include "world/touch/contact_surface.h"

#include "body/body.h"
#include "lattice/constants.h"
#include "world/constants.h"

#include <Eigen/LU>

namespace pliant {

/// Present steps from a node to its neighbours, one along each axis of the lattice.
struct ContactSurface::Axes
{
	int neighbour[3] = { -1, -1, -1 };
	Eigen::Matrix3d step = Eigen::Matrix3d::Zero(); ///< as columns; zero without a neighbour
	int count = 0;
};

void ContactSurface::follow( const Body& body, unsigned version )
{
	const Lattice& lattice = body.lattice();
	if ( m_lattice == &lattice && m_version == version && m_links == lattice.linkTo.size() )
	{
		return;
	}
	m_lattice = &lattice;
	m_version = version;
	m_links = lattice.linkTo.size();
	m_cellSize = double( lattice.cellSize );
	m_hasPatches = false;
	m_neighbours.clear();
	m_patch.clear();
	if ( body.levels() )
	{
		return;
	}
	m_neighbours = findAxisNeighbours( lattice );
	followCracks();
	for ( const ContactPatch& patch : patches() )
	{
		m_hasPatches = m_hasPatches || patch.radius > 0.0f;
	}
}

// A crack leaves the drawn surface in front of its cells as it was. Cells from inside, of which it has opened one side, have a flat face
// there; those at a crack's edges keep their spheres.
void ContactSurface::followCracks()
{
	for ( std::size_t cell = 0; cell < patches().size(); ++cell )
	{
		if ( patches()[cell].links > 0 )
		{
			continue; // of the surface as it was built
		}
		const std::array<std::int32_t, 6>& beside = m_neighbours[cell];
		const std::ptrdiff_t open = std::count_if( beside.begin(), beside.end(), []( std::int32_t other ) { return other < 0; } );
		if ( open != 1 )
		{
			continue;
		}
		const int side = int(
			std::find_if( beside.begin(), beside.end(), []( std::int32_t other ) { return other < 0; } ) - beside.begin() );
		if ( m_patch.empty() )
		{
			m_patch = m_lattice->patch; // the first crack
		}
		ContactPatch& patch = m_patch[cell];
		patch.normal = Vec3::Zero();
		patch.normal[side / 2] = side % 2 == 0 ? -1.0f : 1.0f;
		patch.height = 0.5f * float( m_cellSize );
		patch.radius = float( kMaxPatchRadius * m_cellSize );
	}
}

// With the steps between neighbours on both sides as columns, D0 at rest and D now, F = D D0^-1. The surface normal transforms with the
// inverse transpose of F, which is D^-T D0^T, and D^-T is the cofactor matrix of D up to a factor.
bool ContactSurface::patchOf( const NodeState& nodes, int node, Patch& patch ) const
{
	if ( m_neighbours.empty() || patches().empty() )
	{
		return false;
	}
	const ContactPatch& rest = patches()[std::size_t( node )];
	if ( !( rest.radius > 0.0f ) )
	{
		return false;
	}
	Eigen::Matrix3d before, now;
	for ( int axis = 0; axis < 3; ++axis )
	{
		const std::array<std::int32_t, 6>& beside = m_neighbours[std::size_t( node )];
		const int low = beside[std::size_t( 2 * axis )], high = beside[std::size_t( 2 * axis + 1 )];
		if ( low < 0 && high < 0 )
		{
			return false;
		}
		const int from = low < 0 ? node : low, to = high < 0 ? node : high;
		before.col( axis ) = ( m_lattice->restCentre[std::size_t( to )] - m_lattice->restCentre[std::size_t( from )] ).cast<double>();
		now.col( axis ) = ( nodes.x.get( to ) - nodes.x.get( from ) ).cast<double>();
	}
	Eigen::Matrix3d cofactors;
	cofactors << now.col( 1 ).cross( now.col( 2 ) ), now.col( 2 ).cross( now.col( 0 ) ), now.col( 0 ).cross( now.col( 1 ) );
	const Vec3d normal = cofactors * ( before.transpose() * rest.normal.cast<double>() );
	const double length = normal.norm();
	if ( !( now.col( 0 ).dot( cofactors.col( 0 ) ) > kLeastPatchVolume * before.determinant() ) || !( length > 0.0 ) )
	{
		return false;
	}
	patch = Patch{ normal / length, double( rest.height ), double( rest.radius ) };
	return true;
}

double ContactSurface::rollingRadius( const NodeState& nodes, int node, const Vec3d& outwards ) const
{
	Patch patch;
	if ( !m_hasPatches || !patchOf( nodes, node, patch ) )
	{
		return 0.0;
	}
	const double cosine = patch.normal.dot( outwards ), sine = std::sqrt( std::max( 0.0, 1.0 - cosine * cosine ) );
	const double aside = ( patch.radius - patch.height ) * sine;
	return sine > kFlatSine && cosine > kLeastContactCosine && aside < kPatchHalfWidth * m_cellSize ? patch.radius : 0.0;
}

bool ContactSurface::axesOf( const NodeState& nodes, int node, const Vec3d& along, Axes& axes ) const
{
	const Vec3 at = nodes.x.get( node );
	for ( int axis = 0; axis < 3; ++axis )
	{
		int sides[2] = {
			m_neighbours[std::size_t( node )][std::size_t( 2 * axis )], m_neighbours[std::size_t( node )][std::size_t( 2 * axis + 1 )] };
		double most = 0.0;
		for ( const int other : sides )
		{
			if ( other < 0 || nodes.freedom[std::size_t( other )] == 0.0f )
			{
				continue;
			}
			const Vec3d step = ( nodes.x.get( other ) - at ).cast<double>();
			// The neighbour on the point's side; the other one only where that is missing.
			const double alignment = 2.0 + step.normalized().dot( along );
			if ( alignment > most )
			{
				most = alignment;
				axes.neighbour[axis] = other;
				axes.step.col( axis ) = step;
			}
		}
		axes.count += axes.neighbour[axis] >= 0 ? 1 : 0;
	}
	return axes.count > 0;
}

namespace {

/// Solves   steps b = offset,   by least squares where an axis has no neighbour.
bool solve( const Eigen::Matrix3d& steps, int count, const Vec3d& offset, Vec3d& b )
{
	if ( count == 3 )
	{
		const double size = steps.col( 0 ).norm() * steps.col( 1 ).norm() * steps.col( 2 ).norm();
		if ( !( std::abs( steps.determinant() ) > kLeastFractionVolume * size ) )
		{
			return false;
		}
		b = steps.inverse() * offset;
	}
	else
	{
		Eigen::Matrix3d normal = steps.transpose() * steps;
		for ( int axis = 0; axis < 3; ++axis )
		{
			normal( axis, axis ) = steps.col( axis ).isZero( 0.0 ) ? 1.0 : normal( axis, axis );
		}
		b = normal.inverse() * ( steps.transpose() * offset );
	}
	return b.allFinite() && b.cwiseAbs().maxCoeff() <= kMostFraction;
}

} // namespace

SharedNodes ContactSurface::sharedNodes( const NodeState& nodes, int node, const Vec3d& normal, Vec3d& at ) const
{
	SharedNodes shared = SharedNodes::only( node );
	Axes axes;
	const Vec3d along = at;
	at = Vec3d::Zero();
	if ( m_neighbours.empty() || !axesOf( nodes, node, along, axes ) )
	{
		return shared;
	}
	Vec3d press, rub;
	if ( !solve( axes.step, axes.count, along - along.dot( normal ) * normal, press ) || !solve( axes.step, axes.count, along, rub ) )
	{
		return shared;
	}
	at = axes.step * rub;
	for ( int axis = 0; axis < 3; ++axis )
	{
		if ( axes.neighbour[axis] < 0 || ( press[axis] == 0.0 && rub[axis] == 0.0 ) )
		{
			continue;
		}
		shared.node[shared.count] = axes.neighbour[axis];
		shared.press[shared.count] = press[axis];
		shared.rub[shared.count++] = rub[axis];
		shared.press[0] -= press[axis];
		shared.rub[0] -= rub[axis];
	}
	return shared;
}

} // namespace pliant
