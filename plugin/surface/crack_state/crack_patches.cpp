#include "surface/crack_state/crack_patches.h"

#include "surface/crack_state/crack_surface.h"

#include <algorithm>
#include <iterator>
#include <limits>

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
	if ( !made->addPatches( texture ) )
	{
		return nullptr;
	}
	made->findUnshared();
	made->numberKinds();
	made->numberPanels();
	made->sortIntoClasses();
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
	return std::uint32_t( std::lower_bound( complex->cellsOfPoint.begin( point ), complex->cellsOfPoint.end( point ), cell ) -
		complex->cellsOfPoint.entry.data() );
}

/// Adds a triangle to the latest patch. Returns false where the patch has too many vertices.
bool CrackPatches::addCorners( const std::array<Corner, 3>& corners )
{
	std::array<std::uint16_t, 3> numbers;
	const std::uint32_t first = patch.back().firstVertex;
	std::size_t most = 0;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		std::size_t found = first;
		while ( found < vertex.size() && ( vertex[found].slot != corners[k].slot || appearance[found].kind != corners[k].appearance.kind ) )
		{
			++found;
		}
		if ( found == vertex.size() )
		{
			vertex.push_back( { corners[k].slot, 0, std::uint8_t( corners[k].appearance.kind >= CrackSurface::kInside ), 0 } );
			appearance.push_back( corners[k].appearance );
		}
		most = std::max( most, found - first );
		numbers[k] = std::uint16_t( found - first );
	}
	triangle.push_back( numbers );
	return most <= std::numeric_limits<std::uint16_t>::max();
}

bool CrackPatches::addPatches( const float* texture )
{
	bool isGood = true;
	const auto begin = [this] { patch.push_back( { std::uint32_t( vertex.size() ), std::uint32_t( triangle.size() ) } ); };
	const auto cornerOf = [&]( std::uint32_t point, std::uint32_t cell, std::uint32_t kind ) {
		Corner corner{ slotOf( point, cell ), { point, kind, 0.0f, 0.0f } };
		CrackSurface::textureOf( *complex, point, kind, texture, &corner.appearance.u );
		return corner;
	};
	for ( std::uint32_t cell = 0; cell < complex->cellCount(); ++cell )
	{
		begin();
		for ( std::uint32_t t = complex->cellTriangleStart[cell]; t < complex->cellTriangleStart[cell + 1]; ++t )
		{
			const auto& v = complex->triangle[t];
			const auto corner = [&]( std::size_t k ) { return cornerOf( complex->vertexPoint[v[k]], cell, v[k] ); };
			isGood = addCorners( { corner( 0 ), corner( 1 ), corner( 2 ) } ) && isGood;
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
				isGood = addCorners( { corner( 0 ), corner( isA ? 1 : 2 ), corner( isA ? 2 : 1 ) } ) && isGood;
			}
		}
	}
	begin();
	return isGood;
}

/// A point has few kinds, so they are searched linearly.
void CrackPatches::numberKinds()
{
	struct Kind
	{
		std::uint32_t kind, next;
	};
	std::vector<Kind> known;
	std::vector<std::uint32_t> newest( complex->pointCount(), kNone );
	std::vector<std::uint16_t> count( complex->pointCount(), 0 );
	for ( std::size_t v = 0; v < vertex.size(); ++v )
	{
		const Appearance& of = appearance[v];
		std::uint32_t k = newest[of.point];
		std::uint16_t younger = 0;
		while ( k != kNone && known[k].kind != of.kind )
		{
			k = known[k].next;
			++younger;
		}
		if ( k == kNone )
		{
			known.push_back( { of.kind, newest[of.point] } );
			newest[of.point] = std::uint32_t( known.size() - 1 );
			++count[of.point];
			younger = 0;
		}
		vertex[v].kindAt = std::uint16_t( count[of.point] - 1 - younger );
	}
	std::vector<std::uint8_t> isUnshared( pointOfSlot.size(), 0 );
	for ( const Vertex& of : vertex )
	{
		isUnshared[of.slot] = of.isUnshared;
	}
	std::uint32_t numbers = 0;
	for ( std::size_t slot = 0; slot < pointOfSlot.size(); ++slot )
	{
		numbersOfSlot.push_back( numbers );
		numbers += isUnshared[slot] != 0 ? 0 : kNumbersOfSide + count[pointOfSlot[slot]];
	}
	numbersOfSlot.push_back( numbers );
	for ( std::uint32_t v = 0; v < complex->inputVertices; ++v )
	{
		numbersOfInput.push_back( numbersOfSlot[complex->cellsOfPoint.start[complex->vertexPoint[v]]] );
	}
}

void CrackPatches::numberPanels()
{
	std::vector<std::uint16_t> kindAt( complex->vertexPoint.size(), 0 );
	for ( std::size_t v = 0; v < vertex.size(); ++v )
	{
		if ( appearance[v].kind < CrackSurface::kInside )
		{
			kindAt[appearance[v].kind] = vertex[v].kindAt;
		}
	}
	const auto numberOf = [&]( std::uint32_t v ) {
		return numbersOfSlot[complex->cellsOfPoint.start[complex->vertexPoint[v]]] + kNumbersOfSide + kindAt[v];
	};
	const Panels& panels = complex->panels;
	std::transform( panels.border.entry.begin(), panels.border.entry.end(), std::back_inserter( numberOfBorder ), numberOf );
	for ( const std::array<std::uint32_t, 3>& corner : panels.corner )
	{
		numbersOfCorners.push_back( { numberOf( corner[0] ), numberOf( corner[1] ), numberOf( corner[2] ) } );
	}
}

void CrackPatches::findUnshared()
{
	std::vector<std::uint8_t> uses( pointOfSlot.size(), 0 );
	for ( const Vertex& of : vertex )
	{
		uses[of.slot] = std::uint8_t( std::min( uses[of.slot] + 1, 2 ) );
	}
	for ( Vertex& of : vertex )
	{
		const std::uint32_t point = pointOfSlot[of.slot];
		const bool isOfOneFace = complex->cellsOfPoint.size( point ) == 2 && complex->facesOfPoint.size( point ) == 1;
		of.isUnshared = isOfOneFace && of.isInside != 0 && uses[of.slot] == 1 ? 1 : 0;
	}
}

void CrackPatches::sortIntoClasses()
{
	// Each class is represented by one of its points; classes with the same first cell are searched linearly.
	std::vector<std::uint32_t> pointOf, next, newest( complex->cellCount() + 1, kNone );
	const auto rowOf = [this]( std::uint32_t point ) {
		return std::pair(
			complex->bindCell.begin() + complex->bindStart[point], complex->bindCell.begin() + complex->bindStart[point + 1] );
	};
	Table cells;
	classOfPoint.resize( complex->pointCount() );
	firstOfClass.push_back( 0 );
	for ( std::uint32_t point = 0; point < complex->pointCount(); ++point )
	{
		const auto [first, last] = rowOf( point );
		std::uint32_t& known = newest[first == last ? complex->cellCount() : *first];
		std::uint32_t found = known;
		const auto isOther = [&rowOf, a = first, b = last]( std::uint32_t other ) {
			const auto [c, d] = rowOf( other );
			return !std::equal( a, b, c, d );
		};
		while ( found != kNone && isOther( pointOf[found] ) )
		{
			found = next[found];
		}
		if ( found == kNone )
		{
			found = std::uint32_t( pointOf.size() );
			pointOf.push_back( point );
			next.push_back( known );
			known = found;
			firstOfClass.push_back( firstOfClass.back() + std::uint32_t( last - first ) );
			cells.entry.insert( cells.entry.end(), first, last );
		}
		classOfPoint[point] = found;
	}
	cells.start = firstOfClass;
	classesOfCell = turned( cells, complex->cellCount() );
}

void CrackPatches::addTies()
{
	std::vector<std::uint8_t> bitOfCell( complex->cellCount(), kNoBit );
	bitOfSlot.resize( pointOfSlot.size(), kNoBit );
	for ( std::uint32_t point = 0; point < complex->pointCount(); ++point )
	{
		slotTieStart.push_back( std::uint32_t( slotTie.size() ) );
		looseTieStart.push_back( std::uint32_t( looseTie.size() ) );
		const std::uint32_t firstSlot = complex->cellsOfPoint.start[point];
		for ( const std::uint32_t* f = complex->facesOfPoint.begin( point ); f != complex->facesOfPoint.end( point ); ++f )
		{
			const CrackFace& face = complex->face[*f];
			slotTie.push_back( { *f, std::uint16_t( slotOf( point, face.cellA ) - firstSlot ),
				std::uint16_t( slotOf( point, face.cellB ) - firstSlot ) } );
		}
		const std::uint32_t first = complex->bindStart[point], last = complex->bindStart[point + 1];
		for ( std::uint32_t k = first; k < last; ++k )
		{
			bitOfCell[complex->bindCell[k]] = std::uint8_t( k - first );
		}
		if ( classOfPoint[point] == carrierTieStart.size() ) // the first of its class
		{
			addCarrierTies( point, bitOfCell );
		}
		addLooseTies( point, bitOfCell );
		for ( std::uint32_t k = first; k < last; ++k )
		{
			bitOfCell[complex->bindCell[k]] = kNoBit;
		}
	}
	slotTieStart.push_back( std::uint32_t( slotTie.size() ) );
	carrierTieStart.push_back( std::uint32_t( carrierTie.size() ) );
	looseTieStart.push_back( std::uint32_t( looseTie.size() ) );
}

template <class Take>
void CrackPatches::forCarriersBeside( std::uint32_t cell, const std::vector<std::uint8_t>& bitOfCell, Take&& take ) const
{
	for ( const std::uint32_t* f = complex->facesOfCell.begin( cell ); f != complex->facesOfCell.end( cell ); ++f )
	{
		const CrackFace& face = complex->face[*f];
		const std::uint8_t bit = bitOfCell[face.cellA == cell ? face.cellB : face.cellA];
		if ( bit != kNoBit )
		{
			take( *f, bit );
		}
	}
}

void CrackPatches::addCarrierTies( std::uint32_t point, const std::vector<std::uint8_t>& bitOfCell )
{
	carrierTieStart.push_back( std::uint32_t( carrierTie.size() ) );
	for ( std::uint32_t k = complex->bindStart[point]; k < complex->bindStart[point + 1]; ++k )
	{
		const std::uint8_t own = bitOfCell[complex->bindCell[k]];
		forCarriersBeside( complex->bindCell[k], bitOfCell, [&]( std::uint32_t face, std::uint8_t bit ) {
			if ( own < bit ) // each pair once
			{
				carrierTie.push_back( { face, own, bit } );
			}
		} );
	}
}

void CrackPatches::addLooseTies( std::uint32_t point, const std::vector<std::uint8_t>& bitOfCell )
{
	const std::uint32_t first = complex->cellsOfPoint.start[point];
	for ( std::uint32_t slot = first; slot < complex->cellsOfPoint.start[point + 1]; ++slot )
	{
		const std::uint32_t cell = complex->cellsOfPoint.entry[slot];
		bitOfSlot[slot] = bitOfCell[cell];
		if ( bitOfSlot[slot] == kNoBit )
		{
			forCarriersBeside( cell, bitOfCell, [&]( std::uint32_t face, std::uint8_t bit ) {
				looseTie.push_back( { face, std::uint16_t( slot - first ), bit } );
			} );
		}
	}
}

} // namespace pliant
