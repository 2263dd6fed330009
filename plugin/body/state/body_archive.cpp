// The data from which a body is made, and its state, as bytes. Tables follow from the lattice; only where links have broken their numbers
// depend on the history, and are stored.

#include "archive/settings_archive.h"
#include "body/body.h"
#include "body/breaking.h"
#include "body/implicit/implicit_motion.h"
#include "body/levels/levels.h"
#include "body/rigid_state.h"
#include "lattice/features.h"
#include "matching/clusters/cluster_matcher.h"
#include "matching/step/lattice_matcher.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

bool areBelow( const std::vector<std::uint32_t>& values, std::uint32_t limit )
{
	return std::all_of( values.begin(), values.end(), [limit]( std::uint32_t value ) { return value < limit; } );
}

bool areRising( const std::vector<std::uint32_t>& values )
{
	return std::adjacent_find( values.begin(), values.end(), []( std::uint32_t a, std::uint32_t b ) { return a >= b; } ) == values.end();
}

/// The settings with which the tables were built: with an inverse where a body has flowed whose plasticity was switched off since.
Material measuredFor( const Material& material, bool hasInverse )
{
	Material measured = material;
	measured.yieldStrain = hasInverse && !needsInverse( material ) ? 1.0f : material.yieldStrain;
	return measured;
}

} // namespace

void archive( Archive& archive, LevelDebt& debt )
{
	auto& [springs, power, deviation, deviationPower, motion] = debt.added;
	archive( springs, power, deviation, deviationPower, motion, debt.energy, debt.timeLeft );
}

void archive( Archive& archive, VelocityBounds& bounds )
{
	auto& [low, high, worst] = bounds;
	archive( low, high, worst );
}

void archive( Archive& archive, MotionSums& sums )
{
	auto& [mass, moment, squareSpeed, worst] = sums;
	archive( mass, moment, squareSpeed, worst );
}

void Body::archiveMake( Archive& archive, const Shared& shared )
{
	archive( m_material, m_fracture, m_firstCell, m_stiffness, m_isOnePart );
	bool isWhole = m_lattice == shared.lattice;
	archive( isWhole );
	if ( archive.isReading() )
	{
		archive.require( archive.isSound() && check( m_material ).ok(), "The material is not valid, or this build has not all of it." );
		m_lattice = isWhole ? shared.lattice : std::make_shared<Lattice>();
		m_cache = isWhole ? shared.cache : nullptr;
	}
	if ( !isWhole )
	{
		archive.write( *m_lattice ); // the only owner while it is read
	}
	if ( !archive.isSound() )
	{
		return;
	}
	const auto cells = std::size_t( m_lattice->cellCount() );
	archive.require( ( m_firstCell.empty() ? isWhole : m_firstCell.size() == cells ) &&
			( m_stiffness.empty() || m_stiffness.size() == cells ) &&
			areBelow( m_firstCell, std::uint32_t( shared.lattice->cellCount() ) ) && areRising( m_firstCell ) &&
			( isWhole || m_lattice->cellSize == shared.lattice->cellSize ),
		"A body's cells are not those of its template." );
	archive.require( std::all_of( m_stiffness.begin(), m_stiffness.end(), []( float f ) { return f > 0.0f && f <= 1.0f; } ),
		"A body's field of stiffness is not valid." );
	archiveLevels( archive, shared, isWhole );
	if ( archive.isSound() )
	{
		archiveMatcher( archive, isWhole );
	}
	bool canBreak = m_breaking != nullptr;
	archive( canBreak );
	if ( archive.isReading() && canBreak && archive.isSound() )
	{
		archive.require( hasFeature( Feature::Fracture ) && m_material.method == Method::Lattice, "This body cannot break." );
		m_breaking = std::make_unique<Breaking>();
	}
	if ( canBreak && archive.isSound() )
	{
		m_breaking->archiveMake( archive, *m_lattice, m_material, isWhole );
	}
}

/// Nodes at rest, on levels or not.
void Body::archiveLevels( Archive& archive, const Shared& shared, bool isWhole )
{
	bool hasLevels = m_levels != nullptr;
	archive( hasLevels );
	Adaptivity settings = m_levels ? m_levels->settings() : Adaptivity{};
	std::vector<std::uint32_t> cut = m_levels ? m_levels->cut().node : std::vector<std::uint32_t>();
	if ( hasLevels )
	{
		archive( settings, cut );
	}
	if ( archive.isReading() )
	{
		archive.require( !hasLevels || ( check( settings ).ok() && settings.coarseLevels > 0 && m_material.method == Method::Lattice ),
			"The settings of the levels of detail are not valid." );
	}
	if ( !archive.isSound() )
	{
		return;
	}
	std::shared_ptr<const LevelBase> base;
	if ( archive.isReading() && hasLevels )
	{
		base = isWhole && shared.cache ? shared.cache->levels.find( *m_lattice, m_material, settings )
									   : buildLevelBase( *m_lattice, m_material, settings );
	}
	if ( hasLevels && !isWhole )
	{
		LevelBase& numbers = const_cast<LevelBase&>( base ? *base : m_levels->base() ); // just built, or only read
		numbers.archiveNumbers( archive );
	}
	if ( archive.isReading() && hasLevels && archive.isSound() )
	{
		Cut now = Levels::readCut( archive, base->octree, std::move( cut ) );
		if ( !archive.isSound() )
		{
			return;
		}
		m_levels = std::make_unique<Levels>( std::move( base ), *m_lattice, m_material, settings, m_stiffness, std::move( now ) );
	}
	if ( hasLevels && !isWhole && archive.isSound() )
	{
		m_levels->archiveTables( archive );
	}
	if ( archive.isReading() && archive.isSound() )
	{
		m_levels ? m_levels->fillNodes( m_nodes, m_material.density ) : makeNodes( Adaptivity{} );
		makeMeasures( m_isOnePart );
	}
	if ( ( hasLevels || !isWhole ) && archive.isSound() )
	{
		for ( AlignedArray<float>* const array : { &m_nodes.x0.x, &m_nodes.x0.y, &m_nodes.x0.z } )
		{
			archive.entries( *array, m_nodes.count );
			archive.requireFinite( *array, std::size_t( m_nodes.count ) );
		}
	}
}

void Body::archiveMatcher( Archive& archive, bool isWhole )
{
	const bool isPlain = !m_levels && m_material.method == Method::Lattice;
	bool hasInverse = isPlain && m_matcher && !static_cast<LatticeMatcher&>( *m_matcher ).tables().moments.inverseMoment[0].empty();
	archive( hasInverse );
	if ( isPlain && !isWhole )
	{
		std::shared_ptr<const RegionTables> built;
		if ( archive.isReading() )
		{
			built = buildRegionTables( *m_lattice, measuredFor( m_material, hasInverse ), Summation::Automatic, m_stiffness );
		}
		const RegionTables& tables = built ? *built : static_cast<LatticeMatcher&>( *m_matcher ).tables();
		const_cast<RegionTables&>( tables ).archiveNumbers( archive ); // just built, or only read
		if ( archive.isReading() )
		{
			auto matcher = std::make_unique<LatticeMatcher>( *m_lattice, m_material, std::move( built ) );
			matcher->setFarLevels( m_material.farLevels, m_stiffness );
			m_matcher = std::move( matcher );
		}
		return;
	}
	if ( archive.isReading() && archive.isSound() )
	{
		m_matcher = makeMatcher( m_levels || !isPlain ? m_material : measuredFor( m_material, hasInverse ) );
	}
}

void archive( Archive& archive, RigidState& state )
{
	RigidMotion& motion = state.motion;
	archive( motion.centre, motion.rotation, motion.velocity, motion.angularVelocity, state.mass, state.moments, state.arm.x, state.arm.y,
		state.arm.z, state.isBent, state.isHeld );
	archive.require( motion.centre.allFinite() && motion.rotation.coeffs().allFinite() && motion.velocity.allFinite() &&
			motion.angularVelocity.allFinite() && std::isfinite( state.mass ) && state.mass > 0.0 && state.moments.allFinite() &&
			state.moments.minCoeff() >= 0.0,
		"A rigid state is not finite." );
	archive.requireFinite( state.arm.x, state.arm.x.size() );
	archive.requireFinite( state.arm.y, state.arm.y.size() );
	archive.requireFinite( state.arm.z, state.arm.z.size() );
}

void Body::archiveState( Archive& archive )
{
	m_nodes.archive( archive );
	for ( AlignedArray<float>* const array : { &m_velocityBefore.x, &m_velocityBefore.y, &m_velocityBefore.z } )
	{
		archive.entriesOrNone( *array, m_nodes.count, m_nodes.padded );
	}
	archive( *m_matcher );
	archiveLinks( archive, m_cutLinks, *m_lattice );
	archiveLinks( archive, m_healedLinks, *m_lattice, true );
	archive( m_reviewIn, m_sinceReview, m_energyDebt, m_wasImplicit, m_velocities, m_motion );
	archive.owned( m_rigid, [] { return std::make_unique<RigidState>(); } );
	if ( m_rigid )
	{
		archive.require( m_rigid->arm.x.size() == std::size_t( m_nodes.padded ) && m_rigid->arm.y.size() == m_rigid->arm.x.size() &&
				m_rigid->arm.z.size() == m_rigid->arm.x.size(),
			"The rigid state is that of another body." );
	}
	if ( m_levels )
	{
		m_levels->archive( archive );
	}
	if ( m_breaking )
	{
		m_breaking->archiveState( archive, *m_lattice );
	}
	if ( archive.isReading() )
	{
		m_implicit.reset(); // it is made again from the nodes in each substep
		reserveMotionScratch();
		keepFiniteState();
	}
}

} // namespace pliant
