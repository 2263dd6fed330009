#pragma once

// What the bodies show that one body has come apart into. Ohta et al. 2009, "Fracturing".
//
// Together their cracks are those of the one body they were: no face between two of them stands, and no side of a crack is two bodies' own. So
// there is one crack surface for the whole family, which only ever grows by what breaks, and a body's drawing is copied out of it: its
// cells' triangles and their vertices. A CrackSurface made from a body's own lattice is the slow twin.

#include "surface/blade_path.h"
#include "surface/crack_surface.h"

#include <memory>
#include <mutex>
#include <vector>

namespace pliant {

/// What a body shows. Borrowed from the family while the body is all of it; then its own.
struct CrackView
{
	const SkinBinding* binding = nullptr; ///< nodes: the body's cells
	const std::array<std::uint32_t, 3>* triangles = nullptr;
	const std::uint32_t* sources = nullptr; ///< CrackSurface::sources
	const float* texture = nullptr;         ///< u, v of each vertex
	int triangleCount = 0;
	CrackSurface::Change change; ///< since the view was last asked for; all of it, where that was of other cells

	SkinBinding ownBinding;
	std::vector<std::array<std::uint32_t, 3>> ownTriangles;
	std::vector<std::uint32_t> ownSources;
	std::vector<float> ownTexture;
};

/// Safe to use from several threads, for different views.
class CrackFamily
{
public:
	/// `whole`: of all cells, nothing broken; it is copied. `texture`: u, v of the input's vertices, or null; it must outlive the family.
	CrackFamily( const CrackSurface& whole, const float* texture );

	/// Links that broke, by the template's numbers. They are kept until somebody looks.
	void breakLinks( const std::vector<CellLink>& links );
	/// Where a blade went through links: cells and rest places of the template. To be said before the links break.
	void follow( const std::vector<CutTrace>& traces );
	/// Whether links have broken since anybody looked.
	bool hasNews() const { return !m_pending.empty(); }

	/// What a body of these cells (ascending) shows. `shift`: its mass centre seen from the template's, m.
	void show( const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view );

	/// The crack surface of all, as anybody has seen it last.
	const CrackSurface& whole() const { return m_whole; }
	std::size_t bytes() const { return m_whole.bytes() + m_texture.size() * sizeof( float ); }

private:
	void catchUp();
	void showWhole( CrackView& view ) const;
	std::size_t trianglesOf( std::uint32_t cell ) const;
	void gatherTriangles( const std::vector<std::uint32_t>& cells, CrackView& view );
	void gatherSides( std::uint32_t cell, CrackView& view );
	void gatherTriangle( std::uint32_t triangle, CrackView& view );
	void gatherVertices( const Vec3& shift, CrackView& view );

	std::mutex m_mutex;
	CrackSurface m_whole;
	const float* m_input;
	std::vector<float> m_texture;
	std::vector<CellLink> m_pending;
	std::unique_ptr<BladePath> m_path; ///< null: nothing has been cut
	std::vector<CutTrace> m_newTraces;

	// Room kept between calls.
	std::vector<std::uint32_t> m_cellNow;             ///< by cell: its number in the body at hand
	std::vector<std::uint32_t> m_vertexNow, m_groupNow, m_carrierNow; ///< the same of vertices, groups of normals, and who carries, as far as marked
	std::vector<std::uint32_t> m_vertexMark, m_groupMark, m_carrierMark;
	std::vector<std::uint32_t> m_vertex;              ///< of the body at hand
	std::uint32_t m_round = 0;
};

} // namespace pliant
