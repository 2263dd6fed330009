// The table of contents of preprocessing: weld, orient, close, cut into cells, link, centre.

#include "lattice/build_lattice.h"

#include "lattice/constants.h"
#include "lattice/links.h"
#include "lattice/region.h"
#include "lattice/slivers.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <optional>
#include <sstream>

namespace pliant {

namespace {

constexpr int kMostMaxCells = 10000000;
constexpr int kMostMaxTriangles = 100000000;
constexpr int kMostSamplesPerEdge = 8;
constexpr float kMostWeldTolerance = 0.01f;
constexpr float kMostMinimumFill = 0.5f;

template <class T>
bool isWithin( T value, T low, T high )
{
	return value >= low && value <= high; // false for NaN
}

template <class... Words>
std::string sentence( const Words&... words )
{
	std::ostringstream out;
	( out << ... << words );
	return out.str();
}

/// One build from mesh to lattice.
class Builder
{
public:
	Builder( const MeshView& mesh, const LatticeSettings& settings, LatticeBuild& out )
		: m_view( mesh ), m_settings( settings ), m_out( out ), m_progress( settings )
	{
	}

	Status build()
	{
		if ( Status status = prepare(); !status.ok() )
		{
			return status;
		}
		return m_settings.cellSize > 0.0f ? buildAt( double( m_settings.cellSize ) ) : buildNearTarget();
	}

private:
	Status cancelled() const { return { ResultCode::Cancelled, "The progress callback asked to stop." }; }

	Status prepare()
	{
		if ( Status status = weldMesh( m_view, m_settings, m_mesh, m_out.report ); !status.ok() )
		{
			return status;
		}
		if ( !m_progress.report( 0.1f ) )
		{
			return cancelled();
		}
		cleanTriangles( m_mesh, m_out.report );
		if ( m_mesh.triangle.empty() )
		{
			return { ResultCode::ZeroVolume, "Every triangle is degenerate or drawn from both sides: there is no inside." };
		}
		const std::vector<RimEdge> rim = orientTriangles( m_mesh, m_out.report );
		m_out.weldedVertex = std::move( m_mesh.weldedVertex );
		if ( !m_progress.report( 0.2f ) )
		{
			return cancelled();
		}
		m_field.emplace( m_mesh, rim );
		if ( !m_field->isWhole() )
		{
			m_survey = m_field->survey();
		}
		m_area = 0.0;
		for ( const Triangle& t : m_mesh.triangle )
		{
			m_area += 0.5 * ( m_mesh.position[t[1]] - m_mesh.position[t[0]] ).cross( m_mesh.position[t[2]] - m_mesh.position[t[0]] ).norm();
		}
		if ( !m_field->isWhole() && !m_field->isSoup() && m_survey.volume <= kRoundingShare * m_area * ( m_mesh.high - m_mesh.low ).norm() )
		{
			return { ResultCode::ZeroVolume, "The mesh is a flat sheet: closed along its rims it holds nothing." };
		}
		return m_progress.report( 0.3f ) ? Status{} : cancelled();
	}

	double cellsAskedFor() const { return m_settings.cellSize > 0.0f ? m_settings.maxCells : m_settings.targetCells; }
	double mostCrossings() const { return kMostCrossingsAtLeast + kMostCrossingsPerCell * cellsAskedFor(); }

	/// Winding numbers asked for, each position once, each sample of a cut one, and each run between crossings.
	bool isTooMuchWork( const Grid& grid, double crossings ) const
	{
		const double positions = double( grid.positions() );
		const double cut = std::min( positions, 2.0 * m_area / ( grid.cellSize * grid.cellSize ) );
		const double answers = positions + cut * grid.samplesPerCell() + crossings;
		return !m_field->isWhole() && answers * m_survey.work > kMostWorkPerCell * std::max( cellsAskedFor(), 1000.0 );
	}

	Status tooFolded() const
	{
		return { ResultCode::TooManyTriangles, sentence( "The surface has ", m_area, " m^2 folded into a box of ", ( m_mesh.high - m_mesh.low ).norm(),
			" m, or is open so widely that telling inside from outside takes too long. Close its holes, use fewer triangles, or lower "
			"LatticeSettings::samplesPerEdge." ) };
	}

	double volume()
	{
		if ( !m_volume )
		{
			m_volume = m_field->isWhole() ? estimateVolume( m_mesh, *m_field, mostCrossings() ) : m_survey.volume;
		}
		return *m_volume;
	}

	/// The mesh spans no more of these than there are coordinates for.
	double smallestSize() const { return ( m_mesh.high - m_mesh.low ).maxCoeff() / ( kMaxExtent - 2 ); }

	/// The cell edge that gives about so many cells: N = V / d^3 + c A / d^2, solved by halving.
	double sizeForCells( double cells )
	{
		double low = smallestSize();
		double high = 2.0 * std::max( std::cbrt( volume() / cells ), std::sqrt( kCellsPerArea * m_area / cells ) );
		high = std::max( std::min( high, ( m_mesh.high - m_mesh.low ).maxCoeff() ), low );
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
		for ( int attempt = 1;; ++attempt )
		{
			const Status status = buildAt( double( float( d ) ) );
			const double ratio = m_out.lattice.cellCount() / target;
			const bool isNear = std::abs( ratio - 1.0 ) <= ( m_field->isWhole() ? kTargetSlack : kTargetSlackWhenOpen );
			if ( !status.ok() || isNear || attempt == ( m_field->isWhole() ? kTargetTries : kTargetTriesWhenOpen ) )
			{
				return status;
			}
			d = std::max( d * std::cbrt( ratio ), smallestSize() );
		}
	}

	Status tooManyCells( double d )
	{
		// A tenth to spare, so that the proposal does fit.
		const double fits = sizeForCells( m_settings.maxCells / ( 1.0 + kTargetSlack ) );
		return { ResultCode::TooManyCells, sentence( "With cells of ", d, " m the mesh fills more than LatticeSettings::maxCells = ", m_settings.maxCells,
			"; a cellSize of ", float( std::max( fits, 1.01 * d ) ), " m would fit." ) };
	}

	Status makeGridAt( double d, Grid& grid )
	{
		const double farthest = std::max( m_mesh.low.cwiseAbs().maxCoeff(), m_mesh.high.cwiseAbs().maxCoeff() );
		if ( d > kLargestDiagonal )
		{
			return { ResultCode::ExtentOutOfRange, "LatticeSettings::cellSize is above the 1e7 m that float arithmetic bears." };
		}
		if ( !( d > kRoundingShare * farthest ) )
		{
			return { ResultCode::ExtentOutOfRange, sentence( "Cells of ", d, " m are below float rounding ", farthest,
				" m from the origin; move the mesh nearer or raise LatticeSettings::cellSize." ) };
		}
		if ( !makeGrid( m_mesh.low, m_mesh.high, d, m_settings.samplesPerEdge, grid ) )
		{
			return { ResultCode::ExtentOutOfRange, sentence( "With cells of ", d, " m the mesh spans more than ", kMaxExtent,
				" of them; raise LatticeSettings::cellSize to at least ", float( ( m_mesh.high - m_mesh.low ).maxCoeff() / ( kMaxExtent - 2 ) ), " m." ) };
		}
		return {};
	}

	Status buildAt( double d )
	{
		Grid grid;
		if ( Status status = makeGridAt( d, grid ); !status.ok() )
		{
			return status;
		}
		const SnappedSurface surface( m_mesh, *m_field, grid );
		if ( surface.expectedCrossings() > mostCrossings() )
		{
			if ( m_settings.cellSize > 0.0f && sizeForCells( m_settings.maxCells ) > d )
			{
				return tooManyCells( d );
			}
			return tooFolded();
		}
		if ( isTooMuchWork( grid, surface.expectedCrossings() ) )
		{
			return tooFolded();
		}
		VoxelizeOptions options{ std::max( m_mesh.tolerance, 2.0 * grid.quantum() ), double( m_settings.maxCells ), m_settings.runner, m_progress };
		Voxels voxels;
		const ResultCode code = voxelize( surface, options, voxels );
		if ( code == ResultCode::TooManyCells )
		{
			return tooManyCells( d );
		}
		return code == ResultCode::Cancelled ? cancelled() : makeCells( grid, voxels );
	}

	Status makeCells( const Grid& grid, const Voxels& voxels )
	{
		Lattice& lattice = m_out.lattice;
		lattice = Lattice{};
		std::optional<Parts> parts( std::in_place, voxels, *m_field, m_settings.minimumFill, m_settings.runner );
		if ( parts->cells().empty() )
		{
			// Thin everywhere: better thin cells than none.
			parts.emplace( voxels, *m_field, 0.0f, m_settings.runner );
		}
		if ( parts->cells().size() > std::size_t( m_settings.maxCells ) )
		{
			return tooManyCells( grid.cellSize );
		}
		if ( !parts->cells().empty() )
		{
			m_out.report.cutLinks = linkCells( *parts, *m_field, m_settings.runner, lattice );
			writeCells( parts->cells(), grid );
			return m_progress.report( 1.0f ) ? Status{} : cancelled();
		}
		const std::vector<CellDraft> slivers = findSliverCells( m_mesh, *m_field, grid, mostCrossings() );
		if ( slivers.empty() )
		{
			return { ResultCode::ZeroVolume, sentence( "No inside was found with cells of ", grid.cellSize,
				" m: the mesh is flat, or open so widely that it holds nothing." ) };
		}
		if ( slivers.size() > std::size_t( m_settings.maxCells ) )
		{
			return tooManyCells( grid.cellSize );
		}
		linkAllNeighbours( slivers, grid, lattice );
		writeCells( slivers, grid );
		return m_progress.report( 1.0f ) ? Status{} : cancelled();
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
		m_out.report.cells = int( cells.size() );
		m_out.report.volume = mass * d * d * d;
		m_out.report.components = countComponents( lattice );
	}

	const MeshView& m_view;
	const LatticeSettings& m_settings;
	LatticeBuild& m_out;
	Progress m_progress;
	WeldedMesh m_mesh;
	std::optional<InsideField> m_field;
	std::optional<double> m_volume;
	InsideField::Survey m_survey; ///< of an open surface
	double m_area = 0.0;
};

} // namespace

Status checkSettings( const LatticeSettings& settings )
{
	const auto bad = []( std::string words ) { return Status{ ResultCode::BadSettings, std::move( words ) }; };
	if ( !( settings.cellSize >= 0.0f && std::isfinite( settings.cellSize ) ) )
	{
		return bad( "LatticeSettings::cellSize must be 0 (chosen from targetCells) or above." );
	}
	if ( !isWithin( settings.maxCells, 1, kMostMaxCells ) )
	{
		return bad( sentence( "LatticeSettings::maxCells must be 1 to ", kMostMaxCells, "." ) );
	}
	if ( settings.cellSize == 0.0f && !isWithin( settings.targetCells, 1, settings.maxCells ) )
	{
		return bad( "LatticeSettings::targetCells must be 1 to maxCells." );
	}
	if ( !isWithin( settings.maxTriangles, 1, kMostMaxTriangles ) )
	{
		return bad( sentence( "LatticeSettings::maxTriangles must be 1 to ", kMostMaxTriangles, "." ) );
	}
	if ( !isWithin( settings.samplesPerEdge, 1, kMostSamplesPerEdge ) )
	{
		return bad( sentence( "LatticeSettings::samplesPerEdge must be 1 to ", kMostSamplesPerEdge, "." ) );
	}
	if ( !isWithin( settings.weldTolerance, 0.0f, kMostWeldTolerance ) )
	{
		return bad( sentence( "LatticeSettings::weldTolerance must be 0 to ", kMostWeldTolerance, "." ) );
	}
	if ( !isWithin( settings.minimumFill, 0.0f, kMostMinimumFill ) )
	{
		return bad( sentence( "LatticeSettings::minimumFill must be 0 to ", kMostMinimumFill, "." ) );
	}
	if ( !isWithin( int( settings.skinning ), int( Skinning::NearbyNodes ), int( Skinning::None ) ) )
	{
		return bad( "LatticeSettings::skinning is none of Skinning's values." );
	}
	return {};
}

Status outOfMemory() noexcept
{
	Status status;
	status.code = ResultCode::OutOfMemory;
	try
	{
		status.sentence = "Not enough memory to build the body; a larger LatticeSettings::cellSize needs less.";
	}
	catch ( const std::bad_alloc& )
	{
		status.sentence = "Out of memory."; // short enough to be kept without an allocation
	}
	return status;
}

Result<LatticeBuild> buildLattice( const MeshView& mesh, const LatticeSettings& settings )
{
	const auto start = std::chrono::steady_clock::now();
	Result<LatticeBuild> result;
	try
	{
		result.status = checkSettings( settings );
		if ( result.ok() )
		{
			result.status = Builder( mesh, settings, result.value ).build();
		}
	}
	catch ( const std::bad_alloc& )
	{
		result.status = outOfMemory();
	}
	if ( !result.ok() )
	{
		result.value = LatticeBuild{};
		return result;
	}
	result.value.report.seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
	return result;
}

} // namespace pliant
