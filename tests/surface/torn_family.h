#pragma once

// A family that is torn.

#include "surface/crack_pieces.h"
#include "surface/drawn_by_definition.h"

#include "surface/crack_mesh/shared_crack_state.h"
#include "surface/crack_shapes/cell_owners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

namespace pliant::test {

struct Torn
{
	explicit Torn( const CrackCase& it ) : complex( it.complex ), lattice( it.lattice() )
	{
		for ( std::size_t v = 0; v < it.mesh.vertexCount(); ++v )
		{
			const float* p = &it.mesh.positions[3 * v];
			texture.insert( texture.end(), { 2.0f * p[0] + p[1], p[2] - 3.0f * p[1] } );
		}
		family = std::make_unique<SharedCrackState>( CrackPatches::make( it.complex, texture.data() ) );
	}

	/// A fraction of the remaining links, and those between pieces.
	void tear( double fraction, int pieces, unsigned seed )
	{
		std::mt19937 random( seed );
		std::vector<std::size_t> pieceOf( lattice.fill.size(), 0 );
		const auto parts = shatter( lattice, pieces, seed );
		for ( std::size_t k = 0; k < parts.size(); ++k )
		{
			for ( const std::uint32_t cell : parts[k] )
			{
				pieceOf[cell] = k;
			}
		}
		std::vector<CellLink> links;
		for ( std::uint32_t a = 0; a < std::uint32_t( lattice.cellCount() ); ++a )
		{
			for ( std::uint32_t k = lattice.linkStart[a]; k < lattice.linkStart[a + 1]; ++k )
			{
				const std::uint32_t b = lattice.linkTo[k];
				if ( a < b && ( pieceOf[a] != pieceOf[b] || random() < fraction * 4294967296.0 ) )
				{
					links.push_back( { a, b } );
				}
			}
		}
		lattice = withoutLinks( lattice, links );
		family->breakLinks( links );
		EXPECT_TRUE( family->hasNews() || links.empty() );
	}

	/// By its definition, from the links that are left.
	Drawing drawingByDefinition( const std::vector<std::uint32_t>& cells ) const
	{
		std::vector<std::uint8_t> isBroken;
		for ( const CrackFace& face : complex->face )
		{
			isBroken.push_back( face.isLinked && !areLinked( lattice, face.cellA, face.cellB ) );
		}
		return DrawnByDefinition( *complex, cells, withUnheld( *complex, isBroken ), texture.data() ).drawing();
	}

	void expectValid() const
	{
		const Status status = validate( family->sides() );
		EXPECT_TRUE( status.ok() ) << status.sentence;
	}

	std::shared_ptr<const CellComplex> complex;
	Lattice lattice;
	std::vector<float> texture;
	std::unique_ptr<SharedCrackState> family;
};

} // namespace pliant::test
