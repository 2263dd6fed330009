#pragma once

// Determines the inside of any surface: an integer counted along rows, plus a smooth remainder for surfaces that are not closed.

#include "lattice/mesh/weld.h"
#include "lattice/mesh/winding_number.h"

#include <memory>
#include <mutex>

namespace pliant {

/// W = (signed crossings of surface and caps along any row) + (smooth part). A closed surface needs no smooth part. Rims are closed by
/// caps, fans to each rim's centroid; the smooth part subtracts their winding number again. In a triangle soup no crossings are counted and
/// the smooth part is everything.
class InsideField
{
public:
	/// Adds the centroids of rims to mesh.position; `mesh` must outlive the field.
	InsideField( WeldedMesh& mesh, const std::vector<RimEdge>& rim );

	const std::vector<Triangle>& caps() const { return m_caps; }
	bool isSoup() const { return m_isSoup; }
	/// True where the count along rows alone determines the inside.
	bool isClosed() const { return !m_smooth; }

	/// W at a point whose row count is known.
	double winding( int count, const Vec3d& point ) const { return m_smooth ? count + m_smooth->at( point ) : double( count ); }
	bool isInside( int count, const Vec3d& point ) const;
	/// True where the surface passes between two points, for segments that are not along rows.
	bool isCrossed( const Vec3d& from, const Vec3d& to ) const;

	/// For a surface that is not closed: volume inside, m^3, and cost of one query, both from a coarse grid of points.
	struct Survey
	{
		double volume = 0.0;
		double opposed = 0.0; ///< part of the volume with the minority orientation; only for a soup
		double work = 0.0;
	};
	Survey survey() const;

private:
	const WeldedMesh& m_mesh;
	std::vector<Triangle> m_caps;
	std::unique_ptr<WindingTree> m_smooth;
	bool m_isSoup = false;
	mutable std::once_flag m_fullTreeOnce; // most meshes never need it
	mutable std::unique_ptr<WindingTree> m_fullTree;
};

} // namespace pliant
