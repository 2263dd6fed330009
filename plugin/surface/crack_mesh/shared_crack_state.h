#pragma once

// The drawn cracks of all bodies that one body has broken into. Ohta et al. 2009, "Fracturing".
//
// Their cracks are those of the original body: every face between two of them is broken, and no side of a crack belongs to two of them. As
// long as the body is one and breaks little by little, there is one crack surface, which grows with each break. Afterwards there is only
// the connectivity of its cells (CrackSides), and each body's mesh is assembled from its cells' patches. A CrackSurface made from a body's
// own lattice is the reference implementation.

#include "surface/crack_complex/blade_path.h"
#include "surface/crack_mesh/crack_view.h"

#include <memory>
#include <mutex>
#include <vector>

namespace pliant {

/// Callable from several threads for different views.
class SharedCrackState
{
public:
	/// `whole`: of all cells, nothing broken. `patches`: made from it with `texture`: u, v of the input's vertices, or null. `whole` and
	/// `texture` must outlive this object. `shatters`: uses patches from the first crack on, for a body that breaks into pieces at once.
	SharedCrackState( const CrackSurface& whole, std::shared_ptr<const CrackPatches> patches, const float* texture, bool shatters = false );

	/// Does ahead of time what the first cracks need; nothing where there are cracks.
	void prepare();

	/// Adds broken links, as indices of the template. They are processed at the next request.
	void breakLinks( const std::vector<CellLink>& links );
	/// Adds cuts by a blade: cells and rest positions of the template. To be called before the links break.
	void follow( const std::vector<CutTrace>& traces );
	/// True where links have broken since the last request.
	bool hasNews() const { return !m_pending.empty(); }

	/// Processes the broken links on the runner's threads, for a request by a body of this many cells. Otherwise the next `show` does it.
	void catchUp( std::size_t cells, TaskRunner* runner );
	/// Makes the view of a body of these cells (ascending). `shift`: its mass centre relative to the template's, m. `runner`: divides the
	/// work among its threads; null: none.
	void show( const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view, TaskRunner* runner = nullptr );

	/// The crack surface of all cells as of the last request; null before the first one and once patches are used.
	const CrackSurface* whole() const { return m_whole.get(); }
	const CrackSides* sides() const { return m_sides.get(); }

private:
	std::vector<std::uint32_t> pendingFaces() const;
	void startGrowing();
	void startSides( TaskRunner* runner );
	void updateTexture();
	void processBreaks( bool isWhole, TaskRunner* runner );
	void showWhole( CrackView& view ) const;

	std::mutex m_mutex;
	std::shared_ptr<const CrackPatches> m_patches;
	const CrackSurface* m_unbroken; ///< without broken faces
	const float* m_input;
	bool m_shatters;
	std::unique_ptr<CrackSurface> m_whole;
	std::vector<float> m_texture; ///< of m_whole
	std::unique_ptr<CrackSides> m_sides;
	std::vector<std::unique_ptr<CrackGatherer>> m_gatherer; ///< unused ones
	std::vector<CellLink> m_pending;
	std::unique_ptr<BladePath> m_path; ///< null: nothing has been cut
	std::vector<CutTrace> m_newTraces;
};

} // namespace pliant
