#include "archive/settings_archive.h"
#include "fracture/shards/shard_cracks.h"

#include <algorithm>
#include <cmath>

namespace pliant {

void ShardSpace::archive( Archive& archive )
{
	archive( m_metric, m_wave, m_phase, m_bend );
}

void ShardCentreSet::archive( Archive& archive )
{
	archive( m_space, m_size, m_centre, m_low, m_bins, m_first, m_next );
	const auto isNumber = [this]( std::uint32_t k ) { return k == kNone || k < m_centre.size(); };
	const auto isFinite = []( const Vec3d& at ) { return at.allFinite(); };
	const bool hasGrid = m_bins.minCoeff() > 0 && m_bins.cast<double>().prod() == double( m_first.size() );
	bool isChained = true; // to lower numbers alone: every chain ends
	for ( std::size_t k = 0; archive.isReading() && k < m_next.size(); ++k )
	{
		isChained = isChained && ( m_next[k] == kNone || m_next[k] < std::uint32_t( k ) );
	}
	archive.require( std::isfinite( m_size ) && m_size > 0.0 && m_low.allFinite() &&
			( hasGrid || ( m_centre.empty() && m_first.empty() ) ) && m_next.size() == m_centre.size() && isChained &&
			std::all_of( m_centre.begin(), m_centre.end(), isFinite ) && std::all_of( m_first.begin(), m_first.end(), isNumber ) &&
			std::all_of( m_next.begin(), m_next.end(), isNumber ),
		"The centres of the shards are not valid." );
}

namespace {

void archiveSet( Archive& archive, std::shared_ptr<const ShardCentreSet>& set )
{
	bool isAny = set != nullptr;
	archive( isAny );
	if ( archive.isReading() )
	{
		set = isAny ? std::make_shared<ShardCentreSet>() : nullptr;
	}
	if ( isAny )
	{
		archive.write( *set ); // the only owner while it is read
	}
}

} // namespace

void ShardCracks::archive( Archive& archive, std::size_t cells )
{
	archive( m_settings, m_law.breakStrain, m_law.youngsModulus, m_law.toughness, m_law.size, m_shard, m_crumb, m_crumbMass, m_isOne,
		m_awaitsImpact );
	archiveSet( archive, m_centres );
	archiveSet( archive, m_crumbCentres );
	archive.require( check( m_settings ).ok() && m_shard.size() == cells && ( m_crumb.empty() || m_crumb.size() == cells ) &&
			std::isfinite( m_crumbMass ) && m_centres && m_centres->count() > 0,
		"The shards are not those of this body." );
}

} // namespace pliant
