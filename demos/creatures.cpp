// +-----------------------------------------------------------------------------------------------------------------+
// | A palm with thin fingers.                                                                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/creatures.h"

#include "demos/solids.h"

#include <algorithm>

namespace pliant_demos {

using pliant_glue::ModelMesh;

namespace {

ModelMesh named( const char* name, ModelMesh mesh )
{
	mesh.name = name;
	mesh.submeshNames = { name };
	mesh.submeshOfTriangle.assign( mesh.triangleCount(), 0 );
	return mesh;
}

} // namespace

ModelMesh makePalm( const PalmPlan& plan )
{
	const float d = plan.cell;
	const Point half = { plan.width( 0 ) / 2, plan.width( 1 ) / 2, plan.width( 2 ) / 2 };
	const float length = d * float( plan.fingerCells );
	const auto field = [&]( const Point& p ) {
		float inside = roundBox( p, half, half, 1.5f * d );
		for( const auto& at : plan.fingers )
		{
			const Point top = { d * float( at[0] ), 2 * d, d * float( at[1] ) }, tip = { top[0], d - length, top[2] };
			inside = std::max( inside, rod( p, top, tip, d, d ) );
		}
		return inside;
	};
	// Off the faces of the palm, so that no corner of the grid lies on them.
	const float margin = 1.37f * d;
	return named( "palm", marchSurface( field, { -margin, -length - margin, -margin },
									{ 2 * half[0] + margin, 2 * half[1] + margin, 2 * half[2] + margin }, 0.55f * d ) );
}

} // namespace pliant_demos
