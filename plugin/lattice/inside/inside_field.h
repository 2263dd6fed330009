#pragma once

// Where the inside is, for any surface: a whole number counted along rows, plus a smooth rest for what is not closed.

#include "lattice/mesh/weld.h"
#include "lattice/mesh/winding_number.h"

#include <memory>
#include <mutex>

namespace pliant {

/// W = (signed crossings of surface and caps along any row) + (smooth part).
/// A closed surface needs no smooth part. Rims are closed by caps, fans to each rim's middle; the smooth part takes their winding number
/// away again. In a soup of triangles nothing is counted and the smooth part is all.
class InsideField
{
public:
	/// Adds the middles of rims to mesh.position; `mesh` must outlive the field.
	InsideField( WeldedMesh& mesh, const std::vector<RimEdge>& rim );

	const std::vector<Triangle>& caps() const { return m_caps; }
	bool isSoup() const { return m_isSoup; }
	/// The count along rows says it all.
	bool isWhole() const { return !m_smooth; }

	/// W at a point whose row count is known.
	double winding( int count, const Vec3d& point ) const { return m_smooth ? count + m_smooth->at( point ) : double( count ); }
	bool isInside( int count, const Vec3d& point ) const;
	/// Whether the surface passes between two points, for ways that are no rows.
	bool isCrossed( const Vec3d& from, const Vec3d& to ) const;

	/// For a surface that is not whole: volume inside, m^3, and work for one answer, both from a coarse grid of points.
	struct Survey
	{
		double volume = 0.0;
		double opposed = 0.0; ///< of it, what the surface winds around the other way than around the most; of a soup only
		double work = 0.0;
	};
	Survey survey() const;

private:
	const WeldedMesh& m_mesh;
	std::vector<Triangle> m_caps;
	std::unique_ptr<WindingTree> m_smooth;
	bool m_isSoup = false;
	mutable std::once_flag m_wholeOnce; // most meshes never ask
	mutable std::unique_ptr<WindingTree> m_whole;
};

} // namespace pliant
