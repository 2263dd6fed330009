#include "surface/crack_state/crack_patches.h"

#include "lattice/union_find.h"
#include "surface/constants.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <iterator>
#include <unordered_map>
#include <utility>

namespace pliant {

namespace {

void addTexture( const CellComplex& complex, const float* input, CrackPatches::Appearance& of )
{
	if ( of.kind >= CrackPatches::kInside )
	{
		const std::uint32_t axis = ( of.kind - CrackPatches::kInside ) / 2;
		const Vec3& position = complex.pointRest[of.point]; // of the template, so that pieces match
		of.u = position[( axis + 1 ) % 3] / complex.settings.textureTile;
		of.v = position[( axis + 2 ) % 3] / complex.settings.textureTile;
		return;
	}
	CellComplex::Origin origin{ { of.kind, CellComplex::kNone, CellComplex::kNone }, { 1.0f, 0.0f, 0.0f } };
	origin = of.kind < complex.inputVertices ? origin : complex.addedOrigin[of.kind - complex.inputVertices];
	for ( std::size_t k = 0; input && k < 3 && origin.vertex[k] != CellComplex::kNone; ++k )
	{
		of.u += origin.weight[k] * input[2 * std::size_t( origin.vertex[k] )];
		of.v += origin.weight[k] * input[2 * std::size_t( origin.vertex[k] ) + 1];
	}
}

} // namespace

std::shared_ptr<const CrackPatches> CrackPatches::make( std::shared_ptr<const CellComplex> of, const float* texture )
{
	const std::shared_ptr<CrackPatches> made( new CrackPatches( std::move( of ) ) );
	const CellComplex& complex = *made->complex;
	for ( std::size_t p = 0; p < complex.pointCount(); ++p )
	{
		made->pointOfSlot.insert( made->pointOfSlot.end(), complex.cellsOfPoint.size( p ), std::uint32_t( p ) );
	}
	made->addPatches( texture );
	made->findUnshared();
	made->numberKinds();
	made->numberPanels();
	made->sortIntoClasses();
	made->addTies();
	made->findDivided();
	made->addNormalShifts();
	return made;
}

/// Areas are summed in the order of CrackGatherer: pieces, then panels that are shaded as one triangle.
void CrackPatches::addNormalShifts()
{
	const IntactPanels panels( complex->panels );
	std::vector<Vec3> area( complex->pointCount(), Vec3::Zero() );
	const auto add = [&]( const std::array<std::uint32_t, 3>& corner ) {
		const std::uint32_t p[3] = { complex->vertexPoint[corner[0]], complex->vertexPoint[corner[1]], complex->vertexPoint[corner[2]] };
		const Vec3 &a = complex->pointRest[p[0]], own = ( complex->pointRest[p[1]] - a ).cross( complex->pointRest[p[2]] - a );
		std::for_each( p, p + 3, [&]( std::uint32_t point ) { area[point] += own; } );
	};
	for ( std::uint32_t t = 0; t < std::uint32_t( complex->triangle.size() ); ++t )
	{
		panels.isOfOne( t ) ? void() : add( complex->triangle[t] );
	}
	for ( std::uint32_t panel = 0; panel < std::uint32_t( complex->panels.count() ); ++panel )
	{
		panels.isOne( panel ) ? add( complex->panels.corner[panel] ) : void();
	}
	normalShift.resize( complex->vertexPoint.size(), Vec3::Zero() );
	for ( std::size_t v = 0; v < complex->vertexNormal.size(); ++v )
	{
		const std::uint32_t point = complex->vertexPoint[v];
		normalShift[v] = panels.isPlaced( point ) ? Vec3( Vec3::Zero() ) : shiftOf( complex->vertexNormal[v], area[point] );
	}
}

Vec3 CrackPatches::shiftOf( const Vec3& normal, const Vec3& area )
{
	const float largest = area.cwiseAbs().maxCoeff(); // avoids underflow of its square
	const Vec3 shift = largest > 0.0f ? Vec3( normal - ( area / largest ).normalized() ) : Vec3( Vec3::Zero() );
	return shift.cwiseAbs().maxCoeff() > kSeenShift ? shift : Vec3( Vec3::Zero() );
}

std::uint32_t CrackPatches::slotOf( std::uint32_t point, std::uint32_t cell ) const
{
	return std::uint32_t( std::lower_bound( complex->cellsOfPoint.begin( point ), complex->cellsOfPoint.end( point ), cell ) -
		complex->cellsOfPoint.entry.data() );
}

void CrackPatches::findDivided()
{
	std::vector<std::uint8_t> isDrawn( complex->pointCount(), 0 );
	for ( const std::uint32_t point : complex->vertexPoint )
	{
		isDrawn[point] = 1;
	}
	UnionFind joined( pointOfSlot.size() );
	for ( std::uint32_t point = 0; point < std::uint32_t( isDrawn.size() ); ++point )
	{
		const std::uint32_t first = complex->cellsOfPoint.start[point], last = complex->cellsOfPoint.start[point + 1];
		for ( std::uint32_t t = slotTieStart[point]; t < slotTieStart[point + 1]; ++t )
		{
			joined.join( first + slotTie[t].a, first + slotTie[t].b );
		}
		bool isDivided = false;
		for ( std::uint32_t slot = first; slot < last; ++slot )
		{
			isDivided = isDivided || joined.find( slot ) != first;
		}
		isDivided&& isDrawn[point] ? dividedPoints.push_back( point ) : void();
	}
}

void CrackPatches::addPatches( const float* texture )
{
	std::unordered_map<std::uint64_t, std::uint32_t> known; // by slot and kind: vertices of the current patch
	const auto begin = [&] {
		patch.push_back( { std::uint32_t( vertex.size() ), std::uint32_t( triangle.size() ) } );
		const bool wasLarge = known.size() > kLargePatch;
		known.clear();
		wasLarge ? known.rehash( 0 ) : void();
	};
	const auto numberOf = [&]( std::uint32_t point, std::uint32_t cell, std::uint32_t kind ) {
		const std::uint32_t slot = slotOf( point, cell );
		const auto [found, isNew] = known.emplace( std::uint64_t( slot ) << 32 | kind, std::uint32_t( known.size() ) );
		if ( isNew )
		{
			vertex.push_back( { slot, 0, std::uint8_t( kind >= kInside ), 0 } );
			appearance.push_back( { point, kind, 0.0f, 0.0f } );
			addTexture( *complex, texture, appearance.back() );
		}
		return found->second;
	};
	for ( std::uint32_t cell = 0; cell < complex->cellCount(); ++cell )
	{
		begin();
		for ( std::uint32_t t = complex->cellTriangleStart[cell]; t < complex->cellTriangleStart[cell + 1]; ++t )
		{
			std::array<std::uint32_t, 3>& corner = triangle.emplace_back( complex->triangle[t] );
			std::for_each( corner.begin(), corner.end(), [&]( std::uint32_t& v ) { v = numberOf( complex->vertexPoint[v], cell, v ); } );
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
				const std::uint32_t kind = kInside + ( complex->faceAxis[t] ^ ( isA ? 0u : 1u ) );
				std::array<std::uint32_t, 3>& corner = triangle.emplace_back( complex->faceTriangle[t] );
				isA ? void() : std::swap( corner[1], corner[2] );
				std::for_each( corner.begin(), corner.end(), [&]( std::uint32_t& v ) { v = numberOf( v, cell, kind ); } );
			}
		}
	}
	begin();
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
		if ( appearance[v].kind < kInside )
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
