#include "surface/piece_skin.h"

#include <algorithm>

namespace pliant {

namespace {

/// The heaviest of a vertex's entries, the first of equals.
std::uint32_t heaviestEntry( const SkinBinding& binding, std::uint32_t vertex )
{
	const auto first = binding.weight.begin() + binding.start[vertex], last = binding.weight.begin() + binding.start[vertex + 1];
	return std::uint32_t( std::max_element( first, last ) - binding.weight.begin() );
}

} // namespace

PieceSkin makePieceSkin( const SkinBinding& whole, const SkinTriangles& triangles, const std::vector<std::uint32_t>& cells, const Vec3& shift )
{
	constexpr std::uint32_t kElsewhere = ~0u;
	const std::uint32_t cellsOfWhole = whole.node.empty() ? 0 : *std::max_element( whole.node.begin(), whole.node.end() ) + 1;
	std::vector<std::uint32_t> numberOf( cellsOfWhole, kElsewhere );
	for ( std::size_t i = 0; i < cells.size(); ++i )
	{
		if ( cells[i] < cellsOfWhole )
		{
			numberOf[cells[i]] = std::uint32_t( i );
		}
	}
	PieceSkin piece;
	piece.binding.kind = whole.kind;
	piece.binding.restNormal = whole.restNormal;
	piece.binding.normalGroup = whole.normalGroup;
	piece.binding.normalGroups = whole.normalGroups;
	piece.binding.start.push_back( 0 );
	std::vector<char> isOurs( whole.restPosition.size(), 0 );
	for ( std::uint32_t v = 0; v < std::uint32_t( whole.restPosition.size() ); ++v )
	{
		piece.binding.restPosition.push_back( whole.restPosition[v] - shift );
		isOurs[v] = numberOf[whole.node[heaviestEntry( whole, v )]] != kElsewhere ? 1 : 0;
		float sum = 0.0f;
		const std::size_t first = piece.binding.weight.size();
		for ( std::uint32_t k = whole.start[v]; isOurs[v] && k < whole.start[v + 1]; ++k )
		{
			if ( const std::uint32_t cell = numberOf[whole.node[k]]; cell != kElsewhere )
			{
				piece.binding.node.push_back( cell );
				piece.binding.weight.push_back( whole.weight[k] );
				sum += whole.weight[k];
			}
		}
		for ( std::size_t k = first; k < piece.binding.weight.size(); ++k )
		{
			piece.binding.weight[k] /= sum;
		}
		if ( !isOurs[v] )
		{
			piece.binding.node.push_back( 0 );
			piece.binding.weight.push_back( 1.0f );
		}
		piece.binding.start.push_back( std::uint32_t( piece.binding.node.size() ) );
	}
	for ( int t = 0; t < triangles.count; ++t )
	{
		const std::uint32_t* corner = triangles.indices + 3 * std::size_t( t );
		if ( isOurs[corner[0]] && isOurs[corner[1]] && isOurs[corner[2]] )
		{
			piece.indices.insert( piece.indices.end(), corner, corner + 3 );
		}
	}
	return piece;
}

} // namespace pliant
