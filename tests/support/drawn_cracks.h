#pragma once

#include "surface/crack_mesh/crack_view.h"

#include <cstdint>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace pliant::test {

/// A complex whose panels are drawn with all their cuts: vertices that are interpolated, and not left out, can be looked at.
inline std::shared_ptr<const CellComplex> withAllCuts( const std::shared_ptr<const CellComplex>& complex )
{
	const auto made = std::make_shared<CellComplex>( *complex );
	made->panels.isSpared.assign( made->panels.isSpared.size(), 0 );
	made->panels.isPlain.assign( made->panels.isPlain.size(), 0 );
	return made;
}

/// What the library draws of a body, or of a piece of it, while faces break.
class DrawnCracks
{
public:
	static constexpr std::uint32_t kNone = CellComplex::kNone;

	explicit DrawnCracks( std::shared_ptr<const CrackPatches> patches ) : m_sides( std::make_shared<CrackSides>( std::move( patches ) ) )
	{
		m_cells.resize( complex().cellCount() );
		std::iota( m_cells.begin(), m_cells.end(), 0u );
		draw();
	}
	/// `texture`: u, v of the input's vertices, or null.
	explicit DrawnCracks( std::shared_ptr<const CellComplex> complex, const float* texture = nullptr ) :
		DrawnCracks( CrackPatches::make( std::move( complex ), texture ) )
	{}

	/// A piece that broken faces separate from the rest. `cells`: ascending; `shift`: its mass centre relative to the template's, m.
	DrawnCracks piece( std::vector<std::uint32_t> cells, const Vec3& shift = Vec3::Zero() ) const
	{
		DrawnCracks made( *this );
		made.m_cells = std::move( cells );
		made.m_shift = shift;
		made.draw();
		return made;
	}

	void breakFaces( const std::vector<std::uint32_t>& faces )
	{
		m_sides->breakFaces( faces );
		draw();
	}

	bool isBroken( std::uint32_t face ) const { return m_sides->isBroken( face ); }
	const CrackSides& sides() const { return *m_sides; }
	const CellComplex& complex() const { return m_sides->complex(); }
	const std::vector<std::uint32_t>& cells() const { return m_cells; }
	const CrackView& view() const { return m_view; }
	const SkinBinding& binding() const { return m_view.binding; }
	const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return m_view.triangles; }
	const std::vector<std::uint32_t>& sources() const { return m_view.sources; }
	std::uint32_t vertexCount() const { return std::uint32_t( m_view.binding.restPosition.size() ); }
	std::uint32_t kindOf( std::uint32_t vertex ) const { return m_view.kinds[vertex]; }
	/// A point of the complex and one of its sides. Vertices of equal result coincide.
	std::pair<std::uint32_t, std::uint32_t> sideOf( std::uint32_t vertex ) const
	{
		return { m_view.binding.point[vertex], m_view.binding.carrier[vertex] };
	}
	/// By vertex of the complex: a vertex that draws it, or kNone.
	std::vector<std::uint32_t> vertexOfKind() const
	{
		std::vector<std::uint32_t> vertex( complex().vertexPoint.size(), kNone );
		for ( std::uint32_t v = 0; v < vertexCount(); ++v )
		{
			kindOf( v ) < vertex.size() ? void( vertex[kindOf( v )] = v ) : void();
		}
		return vertex;
	}

private:
	void draw() { CrackGatherer().gather( *m_sides, m_cells, m_shift, m_view ); }

	std::shared_ptr<CrackSides> m_sides;
	std::vector<std::uint32_t> m_cells;
	Vec3 m_shift = Vec3::Zero();
	CrackView m_view;
};

} // namespace pliant::test
