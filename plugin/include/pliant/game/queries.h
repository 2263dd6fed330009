#pragma once

// Questions about the surface and the volume of a soft body in its present shape.

#include "pliant/export.h"

#include <LinearMath/btVector3.h>

#include <memory>

namespace pliant {

class SoftBody;

/// The point of a surface that is nearest to another point.
struct NearestPoint
{
	btVector3 point = btVector3( 0, 0, 0 );  ///< world, m
	btVector3 normal = btVector3( 0, 1, 0 ); ///< of the surface there, outwards, of unit length
	btScalar distance = btScalar( 0 );       ///< m; negative where the other point is inside of the body
	int node = -1;                           ///< the body's node nearest to the surface point
	int triangle = -1;                       ///< of the drawn surface (SurfaceView); -1 where the surface is that of the cells
};

/// The surface of a body at the time of construction: the drawn one, with its cracks, if it is closed; otherwise that of its cells
/// (Skinning::None, open or inconsistent meshes). Construct it once a step and query it often; it does not follow the body's motion. Do not
/// construct it during a step.
class PLIANT_API SurfaceQuery
{
public:
	/// Copies the surface as it is now; the body may end before.
	explicit SurfaceQuery( const SoftBody& body );
	~SurfaceQuery();
	SurfaceQuery( const SurfaceQuery& ) = delete;
	SurfaceQuery& operator=( const SurfaceQuery& ) = delete;

	/// The surface point nearest to a world position, m. For bad numbers: node -1 and zeros.
	[[nodiscard]] NearestPoint nearest( const btVector3& position ) const;
	/// Whether a world position, m, is in the body's material; a cavity is not. False for bad numbers.
	[[nodiscard]] bool isInside( const btVector3& position ) const;
	/// Whether a sphere touches the body or is inside of it; radius in m. False for bad numbers and for a radius below 0.
	[[nodiscard]] bool touchesSphere( const btVector3& centre, btScalar radius ) const;
	/// Volume inside of the surface, without cavities, m^3.
	[[nodiscard]] btScalar volume() const;
	/// Area of the surface, m^2.
	[[nodiscard]] btScalar area() const;
	/// Whether the drawn surface is used.
	[[nodiscard]] bool isDrawn() const;

private:
	struct Data;
	std::unique_ptr<Data> m_data;
};

} // namespace pliant
