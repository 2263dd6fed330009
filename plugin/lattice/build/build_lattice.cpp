// The steps of preprocessing: weld, orient, close, cut into cells, link, centre.

#include "lattice/build/build_lattice.h"

#include "lattice/attempt.h"
#include "lattice/build/box_cells.h"
#include "lattice/build/contact_patches.h"
#include "lattice/build/links.h"
#include "lattice/build/sentence.h"
#include "lattice/build/shell.h"
#include "lattice/build/slivers.h"
#include "lattice/constants.h"
#include "lattice/region.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace pliant {

namespace {

/// One build from mesh to lattice.
class Builder
{
public:
	Builder( const MeshView& mesh, const LatticeSettings& settings, LatticeBuild& out ) :
		m_view( mesh ), m_settings( settings ), m_out( out ), m_progress( settings )
	{}

	Status build()
	{
		prepare();
		return m_settings.cellSize > 0.0f ? buildAt( double( m_settings.cellSize ) ) : buildWithTarget();
	}

private:
	void report( float fraction )
	{
		rejectIf( !m_progress.report( fraction ), ResultCode::Cancelled, "The progress callback asked to stop." );
	}
	bool mayHaveShell() const { return m_settings.shell != Shell::Never; }
	Status buildWithTarget() { return m_isShellOnly ? buildShellNearTarget() : buildNearTarget(); }

	void prepare()
	{
		insist( weldMesh( m_view, m_settings, m_mesh, m_out.report ) );
		report( 0.1f );
		cleanTriangles( m_mesh, m_out.report );
		m_area = areaOf( m_mesh, m_mesh.triangle );
		m_drawnArea = m_area + areaOf( m_mesh, m_mesh.leftOut );
		rejectIf( m_drawnArea == 0.0, ResultCode::ZeroVolume, "No triangle of the mesh has an area." );
		if ( m_mesh.triangle.empty() && !mayHaveShell() )
		{
			insist( noInside( "Every triangle is degenerate or drawn from both sides" ) );
		}
		const std::vector<RimEdge> rim = orientTriangles( m_mesh, m_out.report );
		m_out.weldedVertex = std::move( m_mesh.weldedVertex );
		report( 0.2f );
		m_isShellOnly = m_settings.shell == Shell::Always || m_mesh.triangle.empty();
		if ( !m_isShellOnly )
		{
			m_field.emplace( m_mesh, rim );
			m_survey = m_field->isClosed() ? InsideField::Survey{} : m_field->survey();
			const bool isThin = m_survey.volume <= kRoundingFraction * m_area * ( m_mesh.high - m_mesh.low ).norm();
			const bool isSheet = isThin && !m_field->isClosed() && !m_field->isSoup();
			if ( isSheet && !mayHaveShell() )
			{
				insist( noInside( "The mesh is a flat sheet: closed along its rims it has no inside" ) );
			}
			m_isShellOnly = isSheet || ( mayHaveShell() && m_survey.opposed > kMaxOpposedFraction * m_survey.volume );
		}
		report( 0.3f );
	}

	static Status noInside( const std::string& reason )
	{
		return { ResultCode::ZeroVolume, reason + ". With LatticeSettings::shell other than Never the surface itself becomes material." };
	}

	double requestedCells() const { return m_settings.cellSize > 0.0f ? m_settings.maxCells : m_settings.targetCells; }
	double maxCrossings() const { return kBaseCrossings + kMaxCrossingsPerCell * requestedCells(); }

	/// Winding number queries: one per position, one per sample of a cut position, and one per run between crossings.
	bool isTooMuchWork( const Grid& grid, double crossings ) const
	{
		const double positions = double( grid.positions() );
		const double cut = std::min( positions, 2.0 * m_area / ( grid.cellSize * grid.cellSize ) );
		const double answers = positions + cut * grid.samplesPerCell() + crossings;
		const double expected = m_survey.volume / ( grid.cellSize * grid.cellSize * grid.cellSize ) + 0.5 * kCellsPerArea * cut;
		const double cells = m_settings.cellSize > 0.0f ? std::min( requestedCells(), expected ) : requestedCells();
		return !m_field->isClosed() && answers * m_survey.work > kMaxWorkPerCell * std::max( cells, 1000.0 );
	}

	Status tooFolded() const
	{
		return { ResultCode::TooFolded,
			sentence( "The surface has ", m_area, " m^2 folded into a box of ", ( m_mesh.high - m_mesh.low ).norm(),
				" m, or is open so widely that telling inside from outside takes too long. Close its holes, use fewer triangles, or let "
				"LatticeSettings::shell make the surface itself material." ) };
	}

	double volume()
	{
		if ( !m_volume )
		{
			m_volume = m_field->isClosed() ? estimateVolume( m_mesh, *m_field, maxCrossings() ) : m_survey.volume;
		}
		return *m_volume;
	}

	/// At this cell size the mesh spans the maximum number of lattice coordinates.
	double smallestSize() const { return ( m_mesh.high - m_mesh.low ).maxCoeff() / ( kMaxExtent - 2 ); }

	/// Returns the cell edge that gives about `cells` cells: N = V / d^3 + c A / d^2, solved by bisection. For a shell N = c A / d^2, with
	/// at least a line of cells.
	double sizeForCells( double cells )
	{
		const double longest = ( m_mesh.high - m_mesh.low ).maxCoeff();
		if ( m_isShellOnly )
		{
			return std::max(
				{ std::min( std::sqrt( kShellCellsPerArea * m_drawnArea / cells ), longest ), longest / cells, smallestSize() } );
		}
		double low = smallestSize();
		double high = 2.0 * std::max( std::cbrt( volume() / cells ), std::sqrt( kCellsPerArea * m_area / cells ) );
		high = std::max( std::min( high, longest ), low );
		while ( high - low > kOverhang * low )
		{
			const double d = 0.5 * ( low + high );
			( volume() / ( d * d * d ) + kCellsPerArea * m_area / ( d * d ) > cells ? low : high ) = d;
		}
		return high;
	}

	Status buildNearTarget()
	{
		const double target = m_settings.targetCells;
		double d = sizeForCells( target );
		if ( !m_isShellOnly && m_field->isClosed() && isBox( m_mesh.high - m_mesh.low, m_area, volume() ) )
		{
			if ( const double fitting = cellEdgeOfBox( m_mesh.high - m_mesh.low, d, target ); fitting > 0.0 )
			{
				return buildAt( double( float( fitting ) ) );
			}
		}
		for ( int attempt = 1;; ++attempt )
		{
			const Status status = buildAt( double( float( d ) ) );
			if ( m_isShellOnly )
			{
				return buildShellNearTarget(); // no inside was found
			}
			const double ratio = countForTarget() / target;
			const bool isNear = std::abs( ratio - 1.0 ) <= ( m_field->isClosed() ? kTargetSlack : kTargetSlackWhenOpen );
			if ( !status.ok() || isNear || attempt == ( m_field->isClosed() ? kTargetTries : kTargetTriesWhenOpen ) )
			{
				return status;
			}
			d = std::max( d * std::cbrt( ratio ), smallestSize() );
		}
	}

	/// A few cells on thin parts must not change the size of all others.
	double countForTarget() const
	{
		const int shell = m_out.report.shellCells, all = m_out.lattice.cellCount();
		return shell <= kMaxShellFraction * all ? all - shell : all;
	}

	/// The exponent of the cell count in the cell size depends on the shape: it is estimated from successive attempts.
	Status buildShellNearTarget()
	{
		const double target = m_settings.targetCells;
		double d = sizeForCells( target ), power = 2.0, lastSize = 0.0, lastCells = 0.0;
		for ( int attempt = 1;; ++attempt )
		{
			const Status status = buildAt( double( float( d ) ) );
			if ( status.code == ResultCode::TooManyCells && attempt < kShellTries )
			{
				d *= 2.0;
				lastCells = 0.0;
				continue;
			}
			const double cells = m_out.lattice.cellCount();
			if ( !status.ok() || std::abs( cells / target - 1.0 ) <= kShellTargetSlack || attempt == kShellTries )
			{
				return status;
			}
			if ( lastCells > 0.0 && lastSize != d )
			{
				power = std::clamp( std::log( cells / lastCells ) / std::log( lastSize / d ), kMinShellPower, kMaxShellPower );
			}
			lastSize = d;
			lastCells = cells;
			d = std::max( d * std::pow( cells / target, 1.0 / power ), smallestSize() );
		}
	}

	Status tooManyCells( double d )
	{
		// A margin of a tenth, so that the proposed size fits; larger for a shell, whose count depends on its orientation.
		const double fits = sizeForCells( m_settings.maxCells / ( 1.0 + ( m_isShellOnly ? kTargetSlackWhenOpen : kTargetSlack ) ) );
		return { ResultCode::TooManyCells,
			sentence( "With cells of ", d, " m the mesh fills more than LatticeSettings::maxCells = ", m_settings.maxCells,
				"; a cellSize of ", float( std::max( fits, 1.01 * d ) ), " m would fit." ) };
	}

	Grid makeGridAt( double d, int samples ) const
	{
		Grid grid;
		const double farthest = std::max( m_mesh.low.cwiseAbs().maxCoeff(), m_mesh.high.cwiseAbs().maxCoeff() );
		rejectIf( d > kLargestDiagonal, ResultCode::ExtentOutOfRange,
			"LatticeSettings::cellSize is above the 1e7 m that float arithmetic supports." );
		if ( !( d > kRoundingFraction * farthest ) )
		{
			reject( ResultCode::ExtentOutOfRange,
				sentence( "Cells of ", d, " m are below float rounding ", farthest,
					" m from the origin; move the mesh nearer or raise LatticeSettings::cellSize." ) );
		}
		if ( !makeGrid( m_mesh.low, m_mesh.high, d, samples, grid ) )
		{
			reject( ResultCode::ExtentOutOfRange,
				sentence( "With cells of ", d, " m the mesh spans more than ", kMaxExtent,
					" of them; raise LatticeSettings::cellSize to at least ", float( smallestSize() ), " m." ) );
		}
		return grid;
	}

	Status buildAt( double d )
	{
		std::vector<CellDraft> cells;
		m_out.lattice = Lattice{};
		m_out.report.shellCells = m_out.report.samplesPerEdge = 0;
		const Grid grid = makeGridAt( d, m_settings.samplesPerEdge );
		if ( !m_isShellOnly )
		{
			Status status = fillInside( d, cells );
			m_isShellOnly = mayHaveShell() && ( status.code == ResultCode::ZeroVolume || status.code == ResultCode::TooFolded );
			if ( !status.ok() && !m_isShellOnly )
			{
				return status;
			}
		}
		if ( m_isShellOnly )
		{
			cells.clear();
			m_out.lattice = Lattice{};
			m_out.report.samplesPerEdge = m_out.report.cutLinks = 0;
		}
		if ( Status status = mayHaveShell() ? addShellCells( grid, cells ) : Status{}; !status.ok() )
		{
			return status;
		}
		writeCells( cells, grid );
		report( 1.0f );
		return {};
	}

	Status addShellCells( const Grid& grid, std::vector<CellDraft>& cells )
	{
		const double d = grid.cellSize, maxCells = m_settings.maxCells;
		const double thickness = m_settings.shellThickness > 0.0f ? double( m_settings.shellThickness ) / d : 1.0;
		const bool hasKnownInside = !m_isShellOnly && m_field->isClosed();
		const int added = addShell( m_mesh, grid, { thickness, m_drawnArea / ( d * d ), hasKnownInside, maxCells }, cells, m_out.lattice );
		m_out.report.shellCells = std::max( added, 0 );
		return added < 0 ? tooManyCells( d ) : Status{};
	}

	/// Uses fewer samples where the requested number would take too long: finding the inside should take a fraction of a second.
	Status fillInside( double d, std::vector<CellDraft>& cells )
	{
		for ( int samples = m_settings.samplesPerEdge; samples > 0; --samples )
		{
			const Grid grid = makeGridAt( d, samples );
			const SnappedSurface surface( m_mesh, *m_field, grid );
			const double crossings = surface.expectedCrossings();
			if ( crossings > maxCrossings() && m_settings.cellSize > 0.0f && sizeForCells( m_settings.maxCells ) > d )
			{
				return tooManyCells( d );
			}
			if ( crossings <= maxCrossings() && !isTooMuchWork( grid, crossings ) )
			{
				m_out.report.samplesPerEdge = samples;
				return fillCells( surface, cells );
			}
		}
		return tooFolded();
	}

	Status fillCells( const SnappedSurface& surface, std::vector<CellDraft>& cells )
	{
		const Grid& grid = surface.grid();
		const double tolerance = std::max( m_mesh.tolerance, 2.0 * grid.quantum() ); // m
		VoxelizeOptions options{ tolerance, double( m_settings.maxCells ), m_settings.runner, m_progress };
		Voxels voxels;
		const ResultCode code = voxelize( surface, options, voxels );
		rejectIf( code == ResultCode::Cancelled, code, "The progress callback asked to stop." );
		if ( code != ResultCode::Ok )
		{
			return tooManyCells( grid.cellSize );
		}
		std::optional<Parts> parts( std::in_place, voxels, *m_field, m_settings.minimumFill, m_settings.runner );
		if ( parts->cells().empty() )
		{
			parts.emplace( voxels, *m_field, 0.0f, m_settings.runner ); // thin everywhere: thin cells are better than none
		}
		if ( parts->cells().size() > std::size_t( m_settings.maxCells ) )
		{
			return tooManyCells( grid.cellSize );
		}
		if ( !parts->cells().empty() )
		{
			m_out.report.cutLinks = linkCells( *parts, *m_field, m_settings.runner, m_out.lattice );
			cells = parts->cells();
			const bool hasSmallParts = std::size_t( kMinCellsPerPart * countComponents( m_out.lattice ) ) > cells.size();
			const bool isFragmented = hasSmallParts && mayHaveShell() && !m_field->isClosed();
			return isFragmented && cells.size() > std::size_t( kMinCellsPerPart ) ? noInside( "The inside is fragmented" ) : Status{};
		}
		cells = findSliverCells( m_mesh, *m_field, grid, maxCrossings() );
		if ( cells.empty() )
		{
			return noInside( sentence( "With cells of ", grid.cellSize, " m there is no inside: the mesh is flat or open too widely" ) );
		}
		if ( cells.size() > std::size_t( m_settings.maxCells ) )
		{
			return tooManyCells( grid.cellSize );
		}
		linkAllNeighbours( cells, grid, m_out.lattice );
		return {};
	}

	void writeCells( const std::vector<CellDraft>& cells, const Grid& grid )
	{
		Lattice& lattice = m_out.lattice;
		const double d = grid.cellSize;
		double mass = 0.0;
		Vec3d moment = Vec3d::Zero();
		for ( const CellDraft& cell : cells )
		{
			mass += double( cell.fill );
			moment += double( cell.fill ) * cell.centre;
		}
		const Vec3d middle = moment / mass;
		lattice.cellSize = float( d );
		lattice.corner = grid.corner;
		lattice.massCentre = grid.corner + d * middle;
		lattice.extent = grid.extent;
		m_out.report.splitCells = 0;
		for ( std::size_t i = 0; i < cells.size(); ++i )
		{
			lattice.coordinate.push_back( grid.at( cells[i].key ).cast<std::int16_t>() );
			lattice.fill.push_back( cells[i].fill );
			lattice.restCentre.push_back( ( d * ( cells[i].centre - middle ) ).cast<float>() );
			const bool isSecond = i > 0 && cells[i].key == cells[i - 1].key;
			const bool isThird = isSecond && i > 1 && cells[i].key == cells[i - 2].key;
			m_out.report.splitCells += isSecond && !isThird;
		}
		if ( !m_isShellOnly )
		{
			fitContactPatches( m_mesh, grid, m_settings.runner, lattice );
		}
		m_out.report.cells = int( cells.size() );
		m_out.report.volume = mass * d * d * d;
		m_out.report.components = countComponents( lattice );
	}

	const MeshView& m_view;
	const LatticeSettings& m_settings;
	LatticeBuild& m_out;
	Progress m_progress;
	WeldedMesh m_mesh;
	std::optional<InsideField> m_field; ///< empty where only the surface is material from the start
	std::optional<double> m_volume;
	InsideField::Survey m_survey; ///< of an open surface
	bool m_isShellOnly = false;   ///< requested, or no inside was found
	double m_area = 0.0;
	double m_drawnArea = 0.0; ///< including triangles that bound no inside
};

} // namespace

Result<LatticeBuild> buildLattice( const MeshView& mesh, const LatticeSettings& settings )
{
	const auto start = std::chrono::steady_clock::now();
	Result<LatticeBuild> result;
	result.status = withinMemory( kNoMemoryToBuild, [&]() {
		const Status checked = checkSettings( settings );
		return checked.ok() ? Builder( mesh, settings, result.value ).build() : checked;
	} );
	if ( !result.ok() )
	{
		result.value = LatticeBuild{};
		return result;
	}
	result.value.report.seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
	return result;
}

} // namespace pliant
