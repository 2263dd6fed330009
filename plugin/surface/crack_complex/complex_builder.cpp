// Steps: weld, clip, trace faces, find owners, draw, number.

#include "surface/crack_complex/complex_builder.h"

#include "lattice/attempt.h"
#include "lattice/constants.h"
#include "lattice/inside/inside_field.h"
#include "lattice/mesh/weld.h"
#include "lattice/mesh/winding_number.h"
#include "lattice/table.h"
#include "surface/crack_complex/face_drawing.h"
#include "surface/crack_complex/surface_pieces.h"
#include "surface/crack_shapes/bent_chain.h"
#include "surface/skin/skinning.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pliant {

namespace {

class ComplexBuilder
{
public:
	ComplexBuilder( const MeshView& mesh, const Lattice& lattice, const CrackSettings& settings, CellComplex& out ) :
		m_view( mesh ), m_lattice( lattice ), m_settings( settings ), m_out( out ),
		m_warp( double( settings.noiseAmplitude ), double( settings.noiseWavelength ), settings.noiseSeed )
	{}

	void build( const SkinBinding& skin, const LatticeSettings& buildSettings )
	{
		m_out.settings = m_settings;
		m_out.cellSize = m_lattice.cellSize;
		prepareMesh( buildSettings );
		clip( buildSettings.shell == Shell::Always );
		drawSurface();
		numberPoints();
		fillTables();
		m_out.skinning = skin.kind;
		if ( skin.kind != Skinning::None )
		{
			bindPoints( skin );
			shade( skin );
			m_out.panels = findPanels( m_view, m_out );
		}
		else
		{
			m_out.bindStart.assign( m_out.pointCount() + 1, 0 );
			m_out.boundPoints.start.assign( std::size_t( m_lattice.cellCount() ) + 1, 0 );
		}
	}

private:
	void prepareMesh( const LatticeSettings& buildSettings )
	{
		BuildReport report;
		insist( weldMesh( m_view, buildSettings, m_mesh, report ) );
		m_weldedCount = m_mesh.position.size();
		cleanTriangles( m_mesh, report );
		const bool isShell = buildSettings.shell == Shell::Always;
		rejectIf( m_mesh.triangle.empty() && !isShell, ResultCode::ZeroVolume,
			"Every triangle is degenerate or drawn from both sides: there is no inside." );
		const std::vector<RimEdge> rim = orientTriangles( m_mesh, report );
		m_field.emplace( m_mesh, isShell ? std::vector<RimEdge>{} : rim );
	}

	void clip( bool isShell )
	{
		std::vector<Vec3d> cells;
		cells.reserve( m_mesh.position.size() );
		for ( const Vec3d& p : m_mesh.position )
		{
			cells.push_back( ( p - m_lattice.corner ) / double( m_lattice.cellSize ) );
		}
		// Caps close the holes of the mesh; they bound faces, but are not drawn.
		std::vector<Triangle> triangles = m_mesh.triangle;
		triangles.insert( triangles.end(), m_field->caps().begin(), m_field->caps().end() );
		m_surface = clipSurface( { cells, triangles, m_lattice.extent, m_warp, longestBentEdge( m_settings ) } );
		const std::vector<FaceEdge> edges = makeFaceEdges( m_surface, m_warp, m_settings );
		m_merged = mergeClosePoints( m_surface, edges );
		simplifyCuts( m_surface, edges, double( m_settings.bendTolerance ), m_merged );
		FaceParts parts = traceFaces( m_surface, edges, m_merged );
		MarchingSquares squares( m_surface, m_warp, m_merged );
		if ( isShell || m_field->isSoup() )
		{
			parts = FaceParts{}; // a shell has no faces; for a soup, whose crossings are incomplete, every face is tested
			parts.broken = isShell ? std::vector<std::uint64_t>{} : facesOfLattice();
		}
		if ( !parts.broken.empty() )
		{
			closeBroken( parts, edges );
		}
		m_owners = findOwners( m_lattice, m_surface, parts, m_merged );
		m_faces = drawFaces( m_surface, parts, m_owners, m_warp, m_settings, squares );
		m_out.report.fallbacks = int( parts.broken.size() );
		m_out.report.adopted = m_owners.adopted;
		m_out.report.faces = int( m_faces.face.size() );
	}

	/// Faces between positions that both have cells.
	std::vector<std::uint64_t> facesOfLattice() const
	{
		std::vector<std::uint64_t> keys, faces;
		for ( const auto& at : m_lattice.coordinate )
		{
			keys.push_back( positionKey( m_lattice.extent, at.cast<int>() ) );
		}
		for ( const std::uint64_t key : keys )
		{
			for ( int axis = 0; axis < 3; ++axis )
			{
				const Eigen::Vector3i above = positionOfKey( m_lattice.extent, key ) + Eigen::Vector3i::Unit( axis );
				const std::uint64_t next = positionKey( m_lattice.extent, above );
				if ( above[axis] < m_lattice.extent[axis] && std::binary_search( keys.begin(), keys.end(), next ) )
				{
					faces.push_back( 3 * key + std::uint64_t( axis ) );
				}
			}
		}
		faces.erase( std::unique( faces.begin(), faces.end() ), faces.end() );
		return faces;
	}

	void closeBroken( FaceParts& parts, const std::vector<FaceEdge>& edges )
	{
		const WindingTree tree( m_mesh.position, m_mesh.triangle );
		const auto isInside = [&]( const Vec3d& rest ) {
			return std::abs( tree.at( m_lattice.corner + double( m_lattice.cellSize ) * rest ) ) > kInsideWinding;
		};
		MarchingSquares squares( m_surface, m_warp, m_merged, isInside );
		closeByMarchingSquares( parts, edges, m_surface, squares, m_merged );
	}

	void drawSurface()
	{
		std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
		for ( const auto& t : m_faces.triangle )
		{
			for ( std::size_t k = 0; k < 3; ++k )
			{
				const auto [a, b] = std::minmax( t[k], t[( k + 1 ) % 3] );
				if ( !m_surface.point[a].origin.isInterior() && !m_surface.point[b].origin.isInterior() )
				{
					edges.emplace_back( a, b );
				}
			}
		}
		std::sort( edges.begin(), edges.end() );
		m_pieces = drawPieces( { m_view, m_mesh, m_lattice, std::move( edges ) }, m_surface, m_owners.ofPolygon, m_merged );
	}

	/// By point of the surface, the lowest cell that draws something there; kNone where none does.
	std::vector<std::uint32_t> lowestCells() const
	{
		std::vector<std::uint32_t> lowest( m_surface.point.size(), CellComplex::kNone );
		const auto see = [&lowest]( std::uint32_t point, std::uint32_t cell ) { lowest[point] = std::min( lowest[point], cell ); };
		for ( std::uint32_t cell = 0; cell + 1 < std::uint32_t( m_pieces.cellStart.size() ); ++cell )
		{
			for ( std::uint32_t t = m_pieces.cellStart[cell]; t < m_pieces.cellStart[cell + 1]; ++t )
			{
				for ( const std::uint32_t v : m_pieces.triangle[t] )
				{
					see( m_pieces.vertexPoint[v], cell );
				}
			}
		}
		for ( const CrackFace& face : m_faces.face )
		{
			for ( std::uint32_t t = face.firstTriangle; t < face.lastTriangle; ++t )
			{
				for ( const std::uint32_t point : m_faces.triangle[t] )
				{
					see( point, face.cellA );
				}
			}
		}
		return lowest;
	}

	/// Numbers the points of the mesh and all other drawn points; those of one cell are consecutive, so that crack faces access nearby
	/// memory.
	void numberPoints()
	{
		const std::vector<std::uint32_t> lowest = lowestCells();
		std::vector<std::uint8_t> isOfVertex( lowest.size(), 0 );
		for ( const std::uint32_t p : m_pieces.vertexPoint )
		{
			isOfVertex[p] = 1;
		}
		std::vector<std::pair<std::uint32_t, std::uint32_t>> order; // lowest cell, point
		for ( std::uint32_t p = 0; p < std::uint32_t( lowest.size() ); ++p )
		{
			if ( p < m_weldedCount || lowest[p] != CellComplex::kNone || isOfVertex[p] )
			{
				order.emplace_back( lowest[p], p );
			}
		}
		std::sort( order.begin(), order.end() );
		m_number.assign( m_surface.point.size(), CellComplex::kNone );
		for ( const auto& [cell, p] : order )
		{
			m_number[p] = std::uint32_t( m_out.pointRest.size() );
			const Vec3d at = p < m_weldedCount ? m_mesh.position[p]
											   : Vec3d( m_lattice.corner + double( m_lattice.cellSize ) * m_surface.point[p].rest );
			m_out.pointRest.push_back( ( at - m_lattice.massCentre ).cast<float>() );
		}
	}

	void fillTables()
	{
		std::vector<std::pair<std::uint32_t, std::uint32_t>> cellOf, faceOf, faceOfCell;
		m_out.inputVertices = std::uint32_t( m_view.vertexCount );
		for ( const std::uint32_t p : m_pieces.vertexPoint )
		{
			m_out.vertexPoint.push_back( m_number[p] );
		}
		m_out.addedOrigin = std::move( m_pieces.addedOrigin );
		m_out.triangle = std::move( m_pieces.triangle );
		m_out.triangleSource = std::move( m_pieces.source );
		m_out.cellTriangleStart = std::move( m_pieces.cellStart );
		const std::size_t cells = std::size_t( m_lattice.cellCount() );
		for ( std::uint32_t cell = 0; cell < cells; ++cell )
		{
			for ( std::uint32_t t = m_out.cellTriangleStart[cell]; t < m_out.cellTriangleStart[cell + 1]; ++t )
			{
				for ( const std::uint32_t v : m_out.triangle[t] )
				{
					cellOf.emplace_back( m_out.vertexPoint[v], cell );
				}
			}
		}
		m_out.face = std::move( m_faces.face );
		for ( std::uint32_t f = 0; f < m_out.face.size(); ++f )
		{
			faceOfCell.emplace_back( m_out.face[f].cellA, f );
			faceOfCell.emplace_back( m_out.face[f].cellB, f );
		}
		for ( const auto& [point, face] : m_faces.incidence )
		{
			if ( m_number[point] != CellComplex::kNone )
			{
				faceOf.emplace_back( m_number[point], face );
				cellOf.emplace_back( m_number[point], m_out.face[face].cellA );
				cellOf.emplace_back( m_number[point], m_out.face[face].cellB );
			}
		}
		m_out.cellsOfPoint = makeTable( cellOf, m_out.pointCount() );
		m_out.facesOfPoint = makeTable( faceOf, m_out.pointCount() );
		m_out.facesOfCell = makeTable( faceOfCell, cells );
		m_out.pointsOfCell = turned( m_out.cellsOfPoint, cells );
		m_out.pointsOfFace = turned( m_out.facesOfPoint, m_out.face.size() );
		fillFaces();
		findHolders();
		for ( std::uint32_t cell = 0; cell < cells; ++cell )
		{
			const bool isDrawn = m_out.cellTriangleStart[cell] != m_out.cellTriangleStart[cell + 1];
			m_out.report.emptyCells += !isDrawn && m_out.facesOfCell.size( cell ) == 0;
		}
	}

	void fillFaces()
	{
		m_out.faceAxis = std::move( m_faces.axis );
		for ( std::array<std::uint32_t, 3> t : m_faces.triangle )
		{
			for ( std::uint32_t& p : t )
			{
				p = m_number[p];
			}
			m_out.faceTriangle.push_back( t );
		}
		for ( CrackFace& face : m_out.face )
		{
			double area = 0.0;
			for ( std::uint32_t t = face.firstTriangle; t < face.lastTriangle; ++t )
			{
				const auto& c = m_out.faceTriangle[t];
				const Vec3d a = m_out.pointRest[c[0]].cast<double>();
				area += 0.5 * ( m_out.pointRest[c[1]].cast<double>() - a ).cross( m_out.pointRest[c[2]].cast<double>() - a ).norm();
			}
			face.area = float( area );
			face.isLinked = areLinked( m_lattice, face.cellA, face.cellB );
		}
	}

	void findHolders()
	{
		std::vector<std::pair<std::uint32_t, std::uint32_t>> held;
		m_out.holdersOfFace.start.push_back( 0 );
		for ( std::uint32_t f = 0; f < m_out.face.size(); ++f )
		{
			const CrackFace& face = m_out.face[f];
			if ( !face.isLinked )
			{
				forLinked( face.cellA, [&]( std::uint32_t first, std::uint32_t third ) {
					forLinked( third, [&]( std::uint32_t second, std::uint32_t fourth ) {
						const std::uint32_t last = fourth == face.cellB ? second : m_out.faceBetween( fourth, face.cellB );
						if ( fourth != face.cellA && last != CellComplex::kNone && m_out.face[last].isLinked )
						{
							m_out.holdersOfFace.entry.insert( m_out.holdersOfFace.entry.end(), { first, second, last } );
							held.insert( held.end(), { { first, f }, { second, f }, { last, f } } );
						}
					} );
				} );
			}
			m_out.holdersOfFace.start.push_back( std::uint32_t( m_out.holdersOfFace.entry.size() ) );
		}
		m_out.heldByFace = makeTable( held, m_out.face.size() );
	}

	/// Calls visit( face, neighbour ) for each cell linked to this one through a face.
	template <class F>
	void forLinked( std::uint32_t cell, F&& visit ) const
	{
		for ( const std::uint32_t* f = m_out.facesOfCell.begin( cell ); f != m_out.facesOfCell.end( cell ); ++f )
		{
			if ( m_out.face[*f].isLinked )
			{
				visit( *f, m_out.face[*f].cellA == cell ? m_out.face[*f].cellB : m_out.face[*f].cellA );
			}
		}
	}

	// === Binding of points to cells ===

	void bindPoints( const SkinBinding& skin )
	{
		std::vector<float> positions;
		positions.reserve( 3 * m_out.pointCount() );
		for ( const Vec3& p : m_out.pointRest )
		{
			const Vec3d at = p.cast<double>() + m_lattice.massCentre;
			positions.insert( positions.end(), { float( at.x() ), float( at.y() ), float( at.z() ) } );
		}
		std::vector<std::uint32_t> corners;
		corners.reserve( 3 * m_out.triangle.size() );
		for ( const auto& t : m_out.triangle )
		{
			for ( const std::uint32_t v : t )
			{
				corners.push_back( m_out.vertexPoint[v] );
			}
		}
		MeshView all;
		all.positions = positions.data();
		all.vertexCount = m_out.pointCount();
		all.indices = corners.data();
		all.triangleCount = m_out.triangle.size();
		const SkinBinding bound = bindSkin( all, m_lattice, {}, skin.kind );

		// Points of the input keep their cells, so that no vertex moves when the first crack opens.
		std::vector<std::uint32_t> inputOf( m_out.pointCount(), CellComplex::kNone );
		for ( std::uint32_t v = 0; v < m_out.inputVertices; ++v )
		{
			inputOf[m_out.vertexPoint[v]] = std::min( inputOf[m_out.vertexPoint[v]], v );
		}
		m_out.bindStart.push_back( 0 );
		for ( std::size_t p = 0; p < m_out.pointCount(); ++p )
		{
			const SkinBinding& from = inputOf[p] == CellComplex::kNone ? bound : skin;
			const std::size_t row = inputOf[p] == CellComplex::kNone ? p : inputOf[p];
			m_out.bindCell.insert( m_out.bindCell.end(), from.node.begin() + from.start[row], from.node.begin() + from.start[row + 1] );
			const float* const weight = from.weight.data();
			m_out.bindWeight.insert( m_out.bindWeight.end(), weight + from.start[row], weight + from.start[row + 1] );
			m_out.bindStart.push_back( std::uint32_t( m_out.bindCell.size() ) );
		}
		m_out.boundPoints = turned( { m_out.bindStart, m_out.bindCell }, std::size_t( m_lattice.cellCount() ) );
	}

	/// Normals between the input's vertices are interpolated, as a renderer does.
	void shade( const SkinBinding& skin )
	{
		m_out.vertexNormal = skin.restNormal;
		for ( const CellComplex::Origin& origin : m_out.addedOrigin )
		{
			Vec3 sum = Vec3::Zero();
			for ( std::size_t k = 0; k < 3 && origin.vertex[k] != CellComplex::kNone; ++k )
			{
				sum += origin.weight[k] * skin.restNormal[origin.vertex[k]];
			}
			m_out.vertexNormal.push_back( sum.isZero( 0.0f ) ? skin.restNormal[origin.vertex[0]] : Vec3( sum.normalized() ) );
		}
	}

	const MeshView& m_view;
	const Lattice& m_lattice;
	const CrackSettings& m_settings;
	CellComplex& m_out;
	NoiseWarp m_warp;
	WeldedMesh m_mesh;
	std::size_t m_weldedCount = 0;
	std::optional<InsideField> m_field;
	ClippedSurface m_surface;
	std::vector<std::uint32_t> m_merged;
	CellOwners m_owners;
	DrawnFaces m_faces;
	SurfacePieces m_pieces;
	std::vector<std::uint32_t> m_number; ///< by point of the surface: its index among the drawn points
};

} // namespace

void buildComplex( const MeshView& mesh, const Lattice& lattice, const SkinBinding& skin, const LatticeSettings& build,
	const CrackSettings& settings, CellComplex& out )
{
	ComplexBuilder( mesh, lattice, settings, out ).build( skin, build );
}

} // namespace pliant
