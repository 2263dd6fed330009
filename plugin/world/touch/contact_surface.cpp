#include "world/touch/contact_surface.h"

#include "body/body.h"
#include "lattice/constants.h"
#include "world/constants.h"
#include "world/touch/edge_constants.h"

#include <Eigen/LU>

namespace pliant {

/// Present steps from a node to its neighbours, one along each axis of the lattice.
struct ContactSurface::Axes
{
	int neighbour[3] = { -1, -1, -1 };
	Eigen::Matrix3d step = Eigen::Matrix3d::Zero(); ///< as columns; zero without a neighbour
	int count = 0;
};

namespace {

/// Whether another face is on the opposite side: both are those of a sheet.
template <class Iterator>
bool isThinAlong( const ContactPatch& face, Iterator first, Iterator last )
{
	return std::any_of(
		first, last, [&face]( const ContactPatch& other ) { return double( face.normal.dot( other.normal ) ) < -kOppositeCosine; } );
}

} // namespace

void ContactSurface::follow( const Body& body, unsigned numbering, unsigned links )
{
	const Lattice& lattice = body.lattice();
	const bool sameCells = m_lattice == &lattice && m_linkVersion == links && m_links == lattice.linkTo.size();
	if ( sameCells && m_numbering == numbering )
	{
		return;
	}
	m_numbering = numbering;
	if ( !sameCells || !body.levels() )
	{
		m_lattice = &lattice;
		m_linkVersion = links;
		m_links = lattice.linkTo.size();
		m_cellSize = double( lattice.cellSize );
		m_patch.clear();
		m_neighbours = findAxisNeighbours( lattice );
		followCracks();
		findThinCells();
		m_hasPatches = !lattice.edgeFace.empty() ||
			std::any_of( patches().begin(), patches().end(), []( const ContactPatch& patch ) { return patch.radius > 0.0f; } );
	}
	if ( !body.levels() || !m_hasPatches )
	{
		m_levels.reset();
		if ( body.levels() )
		{
			m_neighbours.clear(); // cells are no nodes
		}
		return;
	}
	if ( !m_levels )
	{
		m_levels = std::make_unique<LevelFaces>();
	}
	m_levels->build( lattice, *body.levels(), patches(), m_neighbours );
}

void ContactSurface::findThinCells()
{
	m_isThin.clear();
	for ( std::size_t cell = 0; cell + 1 < m_lattice->edgeFaceStart.size(); ++cell )
	{
		const auto first = m_lattice->edgeFace.begin() + m_lattice->edgeFaceStart[cell];
		const auto last = m_lattice->edgeFace.begin() + m_lattice->edgeFaceStart[cell + 1];
		if ( std::any_of( first, last, [&]( const ContactPatch& face ) { return isThinAlong( face, first, last ); } ) )
		{
			m_isThin.resize( m_lattice->edgeFaceStart.size() - 1, 0 );
			m_isThin[cell] = 1;
		}
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
bool ContactSurface::stepsAt( const NodeState& nodes, int node, Steps& steps ) const
{
	const std::array<std::int32_t, 6>& beside = neighbours()[std::size_t( node )];
	int missing = -1;
	for ( int axis = 0; axis < 3; ++axis )
	{
		const int low = beside[std::size_t( 2 * axis )], high = beside[std::size_t( 2 * axis + 1 )];
		if ( low < 0 && high < 0 )
		{
			if ( missing >= 0 )
			{
				return false;
			}
			missing = axis; // a layer of one node
			continue;
		}
		const int from = low < 0 ? node : low, to = high < 0 ? node : high;
		steps.before.col( axis ) = ( restCentre( to ) - restCentre( from ) ).cast<double>();
		steps.now.col( axis ) = ( nodes.x.get( to ) - nodes.x.get( from ) ).cast<double>();
	}
	if ( missing >= 0 )
	{
		const int next = ( missing + 1 ) % 3, last = ( missing + 2 ) % 3;
		steps.before.col( missing ) = steps.before.col( next ).cross( steps.before.col( last ) ).normalized();
		steps.now.col( missing ) = steps.now.col( next ).cross( steps.now.col( last ) ).normalized();
	}
	const Eigen::Matrix3d& now = steps.now;
	steps.cofactors << now.col( 1 ).cross( now.col( 2 ) ), now.col( 2 ).cross( now.col( 0 ) ), now.col( 0 ).cross( now.col( 1 ) );
	return now.col( 0 ).dot( steps.cofactors.col( 0 ) ) > kLeastPatchVolume * steps.before.determinant();
}

bool ContactSurface::cellPatchOf( const ContactPatch& rest, const Steps& steps, Patch& patch ) const
{
	const Vec3d normal = steps.cofactors * ( steps.before.transpose() * rest.normal.cast<double>() );
	const double length = normal.norm();
	patch = Patch{ normal / length, double( rest.height ), double( rest.radius ), kPatchDepth * m_cellSize };
	return length > 0.0;
}

// Of the faces that meet at an edge the one that the object is least behind: objects touch the drawn edge.
bool ContactSurface::edgeFaceOf( const NodeState& nodes, int node, const Vec3d& towards, bool withEdges, Patch& patch ) const
{
	const auto first = m_lattice->edgeFace.begin() + m_lattice->edgeFaceStart[std::size_t( node )];
	const auto last = m_lattice->edgeFace.begin() + m_lattice->edgeFaceStart[std::size_t( node ) + 1];
	Steps steps;
	if ( !hasEdgeFace( node, withEdges ) || !stepsAt( nodes, node, steps ) )
	{
		return false;
	}
	const ContactPatch* chosen = nullptr;
	double largest = 0.0;
	for ( auto face = first; face != last; ++face )
	{
		Patch now;
		if ( !cellPatchOf( *face, steps, now ) )
		{
			continue;
		}
		const double gap = towards.dot( now.normal ) - now.height;
		if ( !chosen || gap > largest )
		{
			chosen = &*face;
			largest = gap;
			patch = now;
		}
	}
	return chosen && ( withEdges || isThinAlong( *chosen, first, last ) );
}

bool ContactSurface::patchOf( const NodeState& nodes, int node, const Vec3d& towards, bool withEdges, Patch& patch ) const
{
	Steps steps;
	if ( !m_levels )
	{
		if ( m_neighbours.empty() || patches().empty() )
		{
			return false;
		}
		const ContactPatch& rest = patches()[std::size_t( node )];
		return rest.radius > 0.0f ? stepsAt( nodes, node, steps ) && cellPatchOf( rest, steps, patch )
								  : edgeFaceOf( nodes, node, towards, withEdges, patch );
	}
	if ( !m_levels->hasFaces( node ) || !stepsAt( nodes, node, steps ) )
	{
		return false;
	}
	const Vec3d at = steps.before * steps.now.inverse() * towards; // F^-1 towards
	const LevelFaces::Face* const face = m_levels->nearestFace( node, at );
	return face && ( face->isOwn || withEdges ) && patchOfFace( *face, steps, patch );
}

// The cell's sphere has its centre at c = F f - R n, f the foot. On the line through the node's centre and c, d = |c|, its surface has the
// height R - d. A plane has the height n.F f on its normal.
bool ContactSurface::patchOfFace( const LevelFaces::Face& face, const Steps& steps, Patch& patch ) const
{
	const Vec3d normal = ( steps.cofactors * ( steps.before.transpose() * face.normal.cast<double>() ) ).normalized();
	const Vec3d foot = steps.now * steps.before.inverse() * face.foot.cast<double>();
	const double radius = double( face.radius );
	patch = Patch{ normal, normal.dot( foot ), radius, kPatchDepth * m_cellSize };
	const Vec3d fromCentre = radius * normal - foot;
	const double distance = fromCentre.norm();
	if ( radius <= kPlaneRadius * m_cellSize && distance < radius && distance > kLeastCentreDistance * radius )
	{
		patch.normal = fromCentre / distance;
		patch.height = radius - distance;
	}
	return patch.height > 0.0;
}

double ContactSurface::rollingRadius( const NodeState& nodes, int node, const Vec3d& outwards ) const
{
	Patch patch;
	if ( !m_hasPatches || !patchOf( nodes, node, 0.5 * sizeOf( node ) * outwards, false, patch ) )
	{
		return 0.0;
	}
	const double cosine = patch.normal.dot( outwards ), sine = std::sqrt( std::max( 0.0, 1.0 - cosine * cosine ) );
	const double aside = ( patch.radius - patch.height ) * sine;
	return sine > kFlatSine && cosine > kLeastContactCosine && aside < kPatchHalfWidth * sizeOf( node ) ? patch.radius : 0.0;
}

bool ContactSurface::axesOf( const NodeState& nodes, int node, const Vec3d& along, Axes& axes ) const
{
	const Vec3 at = nodes.x.get( node );
	const std::array<std::int32_t, 6>& beside = neighbours()[std::size_t( node )];
	for ( int axis = 0; axis < 3; ++axis )
	{
		const int sides[2] = { beside[std::size_t( 2 * axis )], beside[std::size_t( 2 * axis + 1 )] };
		double most = 0.0;
		for ( const int other : sides )
		{
			if ( other < 0 )
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
	if ( neighbours().empty() || !axesOf( nodes, node, along, axes ) )
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
