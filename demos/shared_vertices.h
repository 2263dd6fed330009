#pragma once

// Numbers vertices by the feature that they belong to (edge or cell), so that neighbouring triangles share them.

#include "demos/marching.h"

#include <map>
#include <utility>

namespace pliant_demos {

/// Returns one vertex number for each key: neighbours that meet at an edge share its vertex.
template <class Key>
class SharedVertices
{
public:
	explicit SharedVertices( pliant_glue::ModelMesh& mesh ) : m_mesh( mesh ) {}

	template <class MakePoint>
	std::uint32_t at( const Key& key, MakePoint makePoint )
	{
		const auto [entry, isNew] = m_numbers.try_emplace( key, std::uint32_t( m_mesh.vertexCount() ) );
		if ( isNew )
		{
			const Point p = makePoint();
			m_mesh.positions.insert( m_mesh.positions.end(), p.begin(), p.end() );
		}
		return entry->second;
	}

private:
	pliant_glue::ModelMesh& m_mesh;
	std::map<Key, std::uint32_t> m_numbers;
};

} // namespace pliant_demos
