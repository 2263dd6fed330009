#pragma once

// What the bodies show that one body has come apart into. Ohta et al. 2009, "Fracturing".
//
// Together their cracks are those of the one body they were: no face between two of them stands, and no side of a crack is two bodies' own.
// As long as the body is one and breaks little by little, there is one crack surface, which only ever grows by what breaks. From then on
// there is only how its cells hang together (CrackSides), and each body's drawing is put together from its cells' patches. A CrackSurface
// made from a body's own lattice is the slow twin.

#include "surface/crack_complex/blade_path.h"
#include "surface/crack_mesh/crack_view.h"

#include <memory>
#include <mutex>
#include <vector>

namespace pliant {

/// Safe to use from several threads, for different views.
class SharedCrackState
{
public:
	/// `whole`: of all cells, nothing broken. `patches`: of the same, made with `texture`: u, v of the input's vertices, or null. What is
	/// not shared must outlive the family.
	SharedCrackState( const CrackSurface& whole, std::shared_ptr<const CrackPatches> patches, const float* texture );

	/// Copies `whole` now, and not when a body that is whole is first shown with cracks: some that come to pieces at once never need it.
	void prepare();

	/// Links that broke, by the template's numbers. They are kept until somebody looks.
	void breakLinks( const std::vector<CellLink>& links );
	/// Where a blade went through links: cells and rest places of the template. To be said before the links break.
	void follow( const std::vector<CutTrace>& traces );
	/// Whether links have broken since anybody looked.
	bool hasNews() const { return !m_pending.empty(); }

	/// Takes in what has broken, on the runner's threads, for a body of so many cells that is to be shown; else the next who is shown does
	/// it alone.
	void catchUp( std::size_t cells, TaskRunner* runner );
	/// What a body of these cells (ascending) shows. `shift`: its mass centre seen from the template's, m. `runner`: whose threads share
	/// the work.
	void show( const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view, TaskRunner* runner = nullptr );

	/// The crack surface of all, as anybody has seen it last; null before anybody has, and from when it is drawn in patches.
	const CrackSurface* whole() const { return m_whole.get(); }
	const CrackSides* sides() const { return m_sides.get(); }
	std::size_t bytes() const;

private:
	std::vector<std::uint32_t> pendingFaces() const;
	void growWhole();
	void takeInTexture();
	void takeIn( bool isWhole, TaskRunner* runner );
	void showWhole( CrackView& view ) const;

	std::mutex m_mutex;
	std::shared_ptr<const CrackPatches> m_patches;
	const CrackSurface* m_untouched; ///< nothing of it is broken
	const float* m_input;
	std::unique_ptr<CrackSurface> m_whole;
	std::vector<float> m_texture; ///< of the whole
	std::unique_ptr<CrackSides> m_sides;
	std::vector<std::unique_ptr<CrackGatherer>> m_gatherer; ///< that nobody uses at the moment
	std::vector<CellLink> m_pending;
	std::unique_ptr<BladePath> m_path; ///< null: nothing has been cut
	std::vector<CutTrace> m_newTraces;
};

} // namespace pliant
