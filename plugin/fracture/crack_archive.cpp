#include "archive/archive.h"
#include "fracture/plane_cracks.h"

namespace pliant {

void PlaneCracks::Plane::archive( Archive& archive )
{
	archive( point, normal, low, high, age );
	archive.require( point.allFinite() && normal.allFinite() && low.allFinite() && high.allFinite(), "A crack's plane is not finite." );
}

void PlaneCracks::archive( Archive& archive )
{
	archive( m_breakStrain, m_growthFraction, m_planes );
}

} // namespace pliant
