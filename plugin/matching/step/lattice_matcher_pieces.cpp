// Initial state of a piece's LatticeMatcher, from that of the body it came off. Ohta et al. 2009, "Fracturing".

#include "matching/step/lattice_matcher.h"

namespace pliant {

void LatticeMatcher::inherit( const LatticeMatcher& from, const std::vector<std::uint32_t>& source )
{
	m_frame = from.m_frame;
	for ( std::size_t i = 0; i < source.size(); ++i )
	{
		for ( int k = 0; k < 4; ++k )
		{
			m_quaternion[k][i] = from.m_quaternion[k][source[i]];
		}
		for ( int k = 0; k < 3; ++k )
		{
			m_residual[k][i] = from.m_residual[k][source[i]];
		}
	}
	m_isHistoryForeign = true; // residuals are those of other regions: no damping by them
	if ( from.m_plastic )
	{
		m_plastic = std::make_unique<PlasticFlow>( *m_tables );
		m_plastic->inherit( *from.m_plastic, source );
	}
}

void LatticeMatcher::relink( const Lattice& lattice, std::shared_ptr<const RegionTables> tables, const std::vector<std::uint32_t>& before )
{
	m_lattice = &lattice;
	m_tables = std::move( tables );
	++m_tablesVersion;
	m_strain.clear();
	m_stretch.clear();
	m_volumeSize.clear();
	for ( AlignedArray<float>* array : history() )
	{
		m_historyScratch = *array; // keeps the entries beyond the last node
		for ( std::size_t i = 0; i < before.size(); ++i )
		{
			m_historyScratch[i] = ( *array )[before[i]];
		}
		array->swap( m_historyScratch );
	}
	allocateScratch();
	m_isHistoryForeign = true;
	if ( m_plastic )
	{
		const std::unique_ptr<PlasticFlow> flowed = std::move( m_plastic );
		m_plastic = std::make_unique<PlasticFlow>( *m_tables );
		m_plastic->inherit( *flowed, before );
	}
}

} // namespace pliant
