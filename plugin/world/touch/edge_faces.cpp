#include "world/touch/edge_faces.h"

#include "body/body.h"
#include "world/touch/edge_constants.h"

namespace pliant {

bool findEdgeFace( const ContactSurface& surface, const Body& body, int node, const Vec3d& at, ContactSurface::Patch& face )
{
	const Lattice& lattice = body.lattice();
	const NodeState& nodes = body.nodes();
	const Vec3 own = nodes.x.get( node );
	const double most = kEdgeFaceHeight * surface.sizeOf( node );
	bool isFound = false;
	double largest = 0.0;
	for ( std::uint32_t k = lattice.linkStart[std::size_t( node )]; k < lattice.linkStart[std::size_t( node ) + 1]; ++k )
	{
		const int other = int( lattice.linkTo[k] );
		ContactSurface::Patch patch;
		if ( !surface.patchOf( nodes, other, patch ) || !patch.isFlat( surface.sizeOf( other ) ) )
		{
			continue;
		}
		// A plane that the node is in front of belongs to a corner that is hollow.
		patch.height += ( nodes.x.get( other ) - own ).cast<double>().dot( patch.normal );
		const double gap = at.dot( patch.normal ) - patch.height;
		if ( patch.height > 0.0 && patch.height < most && ( !isFound || gap > largest ) )
		{
			isFound = true;
			largest = gap;
			face = patch;
		}
	}
	return isFound;
}

} // namespace pliant
