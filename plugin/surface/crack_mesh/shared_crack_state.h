#pragma once

// The drawn cracks of all bodies that one body has broken into. Ohta et al. 2009, "Fracturing".
//
// Their cracks are those of the original body: every face between two of them is broken, and no side of a crack belongs to two of them. So
// there is one connectivity of its cells (CrackSides), and each body's mesh is assembled from its cells' patches.

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
	explicit SharedCrackState( std::shared_ptr<const CrackPatches> patches ) : m_sides( std::move( patches ) ) {}

	/// Does ahead of time what the first cracks need; nothing where a body has been drawn with cracks.
	void prepare();

	/// Adds broken links, as indices of the template. They are processed at the next request.
	void breakLinks( const std::vector<CellLink>& links );
	/// Adds cuts by a blade: cells and rest positions of the template. To be called before the links break.
	void follow( const std::vector<CutTrace>& traces );
	/// True where links have broken since the last request.
	bool hasNews() const { return !m_pending.empty(); }

	/// Processes the broken links on the runner's threads. Otherwise the next `show` does it.
	void catchUp( TaskRunner* runner );
	/// Makes the view of a body of these cells (ascending). `shift`: its mass centre relative to the template's, m. `runner`: divides the
	/// work among its threads; null: none.
	void show( const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view, TaskRunner* runner = nullptr );

	/// As of the last request.
	const CrackSides& sides() const { return m_sides; }

private:
	void processBreaks( TaskRunner* runner );

	std::mutex m_mutex;
	CrackSides m_sides;
	std::vector<std::unique_ptr<CrackGatherer>> m_gatherer; ///< unused ones
	std::vector<CellLink> m_pending;
	std::unique_ptr<BladePath> m_path; ///< null: nothing has been cut or prepared
	std::vector<CutTrace> m_newTraces;
};

} // namespace pliant
