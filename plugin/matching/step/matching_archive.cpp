// The state of lattice shape matching between substeps as bytes.

#include "archive/archive.h"
#include "matching/step/lattice_matcher.h"

namespace pliant {

void PlasticFlow::archive( Archive& archive )
{
	for ( AlignedArray<float>& array : m_stretch )
	{
		archive.sameLength( array );
	}
	for ( AlignedArray<float>& array : m_inverse )
	{
		archive.sameLength( array );
	}
	for ( AlignedArray<float>& array : m_blend )
	{
		archive.sameLength( array );
	}
}

// Weights and pulls follow from the nodes' freedom and from the fractions, and are made again where these differ.
void CoarseToFine::archive( Archive& archive )
{
	for ( Level& level : m_levels )
	{
		for ( AlignedArray<float>& array : level.quaternion )
		{
			archive.sameLength( array );
		}
	}
}

// On levels, the strains of the last substep decide on the next changes.
void LatticeMatcher::archive( Archive& archive )
{
	const int count = m_tables->moments.count;
	archive( m_frame, m_isHistoryForeign );
	for ( AlignedArray<float>* const array : history() )
	{
		archive.entries( *array, count );
	}
	if ( m_tables->matrix )
	{
		archive.entriesOrNone( m_strain, count, m_tables->moments.padded );
		archive.entriesOrNone( m_stretch, count, m_tables->moments.padded );
	}
	archive.owned( m_plastic, [this] { return std::make_unique<PlasticFlow>( *m_tables ); } );
	archive.require( !m_plastic || !m_tables->moments.inverseMoment[0].empty(), "Plastic flow needs other tables." );
	bool hasFar = m_far != nullptr;
	archive( hasFar );
	if ( archive.require( hasFar == ( m_far != nullptr ), "The far levels are those of another body." ) && m_far )
	{
		m_far->archive( archive );
	}
}

} // namespace pliant
