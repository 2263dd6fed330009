#include "surface/crack_patches.h"

#include "surface/crack_surface.h"

#include <algorithm>

namespace pliant {

std::shared_ptr<const CrackPatches> CrackPatches::make( const CrackSurface& whole, const float* texture )
{
	const std::shared_ptr<CrackPatches> made( new CrackPatches( whole.m_complex ) );
	const CellComplex& complex = *made->complex;
	for ( std::size_t p = 0; p < complex.pointCount(); ++p )
	{
		if ( complex.bindStart[p + 1] - complex.bindStart[p] > kMostCarriers )
		{
			return nullptr;
		}
		made->pointOfSlot.insert( made->pointOfSlot.end(), complex.cellsOfPoint.size( p ), std::uint32_t( p ) );
	}
	made->addPatches( texture );
	made->addTies();
	made->normalShift.resize( complex.vertexPoint.size(), Vec3::Zero() );
	for ( std::uint32_t v = 0; v < whole.vertexCount(); ++v )
	{
		if ( const std::uint32_t kind = whole.m_vertex[v].kind; kind < CrackSurface::kInside )
		{
			made->normalShift[kind] = whole.binding().normalShift[v];
		}
	}
	return made;
}

std::uint32_t CrackPatches::slotOf( std::uint32_t point, std::uint32_t cell ) const
{
	return std::uint32_t( std::lower_bound( complex->cellsOfPoint.begin( point ), complex->cellsOfPoint.end( point ), cell ) - complex->cellsOfPoint.entry.data() );
}

/// The latest patch's three more corners, each numbered as the patch has it.
void CrackPatches::addCorners( const std::array<Vertex, 3>& corners )
{
	std::array<std::uint32_t, 3> numbers;
	const std::uint32_t first = patch.back().firstVertex;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		const auto isSame = [&]( const Vertex& known ) { return known.slot == corners[k].slot && known.kind == corners[k].kind; };
		const auto found = std::find_if( vertex.begin() + first, vertex.end(), isSame );
		numbers[k] = std::uint32_t( found - vertex.begin() ) - first;
		if ( found == vertex.end() )
		{
			vertex.push_back( corners[k] );
		}
	}
	triangle.push_back( numbers );
}

void CrackPatches::addPatches( const float* texture )
{
	const auto begin = [this] { patch.push_back( { std::uint32_t( vertex.size() ), std::uint32_t( triangle.size() ) } ); };
	const auto cornerOf = [&]( std::uint32_t point, std::uint32_t cell, std::uint32_t kind ) {
		Vertex corner{ slotOf( point, cell ), point, kind, 0.0f, 0.0f };
		CrackSurface::textureOf( *complex, point, kind, texture, &corner.u );
		return corner;
	};
	for ( std::uint32_t cell = 0; cell < complex->cellCount(); ++cell )
	{
		begin();
		for ( std::uint32_t t = complex->cellTriangleStart[cell]; t < complex->cellTriangleStart[cell + 1]; ++t )
		{
			const auto& v = complex->triangle[t];
			const auto corner = [&]( std::size_t k ) { return cornerOf( complex->vertexPoint[v[k]], cell, v[k] ); };
			addCorners( { corner( 0 ), corner( 1 ), corner( 2 ) } );
		}
	}
	for ( std::uint32_t cell = 0; cell < complex->cellCount(); ++cell )
	{
		for ( const std::uint32_t* f = complex->facesOfCell.begin( cell ); f != complex->facesOfCell.end( cell ); ++f )
		{
			begin();
			const CrackFace& face = complex->face[*f];
			const bool isA = face.cellA == cell;
			for ( std::uint32_t t = face.firstTriangle; t < face.lastTriangle; ++t )
			{
				const auto& p = complex->faceTriangle[t];
				const std::uint32_t kind = CrackSurface::kInside + ( complex->faceAxis[t] ^ ( isA ? 0u : 1u ) );
				const auto corner = [&]( std::size_t k ) { return cornerOf( p[k], cell, kind ); };
				addCorners( { corner( 0 ), corner( isA ? 1 : 2 ), corner( isA ? 2 : 1 ) } );
			}
		}
	}
	begin();
}

void CrackPatches::addTies()
{
	std::vector<std::uint8_t> bitOfCell( complex->cellCount(), kNoBit );
	bitOfSlot.resize( pointOfSlot.size(), kNoBit );
	for ( std::uint32_t point = 0; point < complex->pointCount(); ++point )
	{
		slotTieStart.push_back( std::uint32_t( slotTie.size() ) );
		carrierTieStart.push_back( std::uint32_t( carrierTie.size() ) );
		looseTieStart.push_back( std::uint32_t( looseTie.size() ) );
		const std::uint32_t firstSlot = complex->cellsOfPoint.start[point];
		for ( const std::uint32_t* f = complex->facesOfPoint.begin( point ); f != complex->facesOfPoint.end( point ); ++f )
		{
			const CrackFace& face = complex->face[*f];
			slotTie.push_back( { *f, std::uint16_t( slotOf( point, face.cellA ) - firstSlot ), std::uint16_t( slotOf( point, face.cellB ) - firstSlot ) } );
		}
		const std::uint32_t first = complex->bindStart[point], last = complex->bindStart[point + 1];
		for ( std::uint32_t k = first; k < last; ++k )
		{
			bitOfCell[complex->bindCell[k]] = std::uint8_t( k - first );
		}
		addCarrierTies( point, bitOfCell );
		for ( std::uint32_t k = first; k < last; ++k )
		{
			bitOfCell[complex->bindCell[k]] = kNoBit;
		}
	}
	slotTieStart.push_back( std::uint32_t( slotTie.size() ) );
	carrierTieStart.push_back( std::uint32_t( carrierTie.size() ) );
	looseTieStart.push_back( std::uint32_t( looseTie.size() ) );
}

void CrackPatches::addCarrierTies( std::uint32_t point, const std::vector<std::uint8_t>& bitOfCell )
{
	const auto forNeighbours = [&]( std::uint32_t cell, auto&& take ) {
		for ( const std::uint32_t* f = complex->facesOfCell.begin( cell ); f != complex->facesOfCell.end( cell ); ++f )
		{
			const CrackFace& face = complex->face[*f];
			const std::uint8_t bit = bitOfCell[face.cellA == cell ? face.cellB : face.cellA];
			if ( bit != kNoBit )
			{
				take( *f, bit );
			}
		}
	};
	for ( std::uint32_t k = complex->bindStart[point]; k < complex->bindStart[point + 1]; ++k )
	{
		const std::uint8_t own = bitOfCell[complex->bindCell[k]];
		forNeighbours( complex->bindCell[k], [&]( std::uint32_t face, std::uint8_t bit ) {
			if ( own < bit ) // else it is the other's
			{
				carrierTie.push_back( { face, own, bit } );
			}
		} );
	}
	const std::uint32_t first = complex->cellsOfPoint.start[point];
	for ( std::uint32_t slot = first; slot < complex->cellsOfPoint.start[point + 1]; ++slot )
	{
		const std::uint32_t cell = complex->cellsOfPoint.entry[slot];
		bitOfSlot[slot] = bitOfCell[cell];
		if ( bitOfSlot[slot] == kNoBit )
		{
			forNeighbours( cell, [&]( std::uint32_t face, std::uint8_t bit ) { looseTie.push_back( { face, std::uint16_t( slot - first ), bit } ); } );
		}
	}
}

std::size_t CrackPatches::bytes() const
{
	const auto sizeOf = []( const auto& list ) { return list.size() * sizeof( list[0] ); };
	return sizeOf( patch ) + sizeOf( vertex ) + sizeOf( triangle ) + sizeOf( pointOfSlot ) + sizeOf( normalShift ) + sizeOf( slotTieStart ) +
		sizeOf( carrierTieStart ) + sizeOf( looseTieStart ) + sizeOf( slotTie ) + sizeOf( carrierTie ) + sizeOf( looseTie ) + sizeOf( bitOfSlot );
}

} // namespace pliant
