// The implicit substep of a body: its contribution to a linear system.

#include "body/body.h"

#include "body/implicit/implicit_motion.h"
#include "body/implicit/touched_nodes.h"
#include "body/levels/levels.h"
#include "matching/rotation.h"
#include "matching/step/lattice_matcher.h"
#include "matching/stiffness.h"

#include <algorithm>
#include <functional>

namespace pliant {

bool Body::canStepImplicitly() const
{
	return m_material.method == Method::Lattice && m_material.weights == Weights::Conserving &&
		m_material.rotationFrom == RotationFrom::Apq && m_material.farLevels == 0 && m_nodes.count > 1;
}

Status Body::implicitStatus() const
{
	if ( canStepImplicitly() )
	{
		return {};
	}
	if ( m_material.farLevels > 0 )
	{
		return { ResultCode::BadMaterial,
			"A body with Material::farLevels steps explicitly: the implicit step reaches any stiffness without them." };
	}
	if ( m_nodes.count == 1 )
	{
		return { ResultCode::BadArgument, "A body of one cell has nothing that could strain." };
	}
	return { ResultCode::BadMaterial,
		"The implicit step needs Method::Lattice, Weights::Conserving and RotationFrom::Apq: this body steps explicitly." };
}

float Body::largestRegionFraction() const
{
	return canStepImplicitly() ? static_cast<const LatticeMatcher&>( *m_matcher ).tables().largestRateFraction : 1.0f;
}

ImplicitMotion& Body::madeImplicit()
{
	if ( !m_implicit )
	{
		m_implicit = std::make_unique<ImplicitMotion>();
	}
	return *m_implicit;
}

// Matching first, from the velocities of the last substep, then forces: the order of the explicit step.
void Body::pushImplicitly( float h, float alpha, const Vec3& gravity, TaskRunner* runner )
{
	madeImplicit();
	const std::size_t padded = std::size_t( m_nodes.padded );
	m_pushed.resize( 3 * padded );
	keepVelocities( runner );
	m_wasImplicit = true;
	m_energyDebt = LevelDebt{};
	const bool measuresStrain = m_levels && m_reviewIn == 0 && m_levels->followsStrain();
	MatchStep step{ h, alpha, 0.0f, wobbleRate( h, alpha ), 0.0f, measuresStrain,
		PlasticLaw{ m_material.yieldStrain, m_material.plasticCreep, m_material.plasticLimit }, {}, m_isOnePart, float( m_restLength ) };
	step.storesVolumeGradients = true;
	m_matcher->accelerate( m_nodes, step, runner );
	std::swap( m_velocityBefore, m_nodes.v ); // now the velocities after matching
	const AlignedArray<float>* const pushed[3] = { &m_velocityBefore.x, &m_velocityBefore.y, &m_velocityBefore.z };
	const AlignedArray<float>* const velocity[3] = { &m_nodes.v.x, &m_nodes.v.y, &m_nodes.v.z };
	// The velocity changes by matching, to which the velocities of free flight are added.
	for ( std::size_t k = 0; k < 3; ++k )
	{
		std::transform(
			pushed[k]->begin(), pushed[k]->end(), velocity[k]->begin(), m_pushed.begin() + std::ptrdiff_t( k * padded ), std::minus<>() );
	}
	keepVelocities( runner );
	applyForces( h, gravity, runner );
	for ( std::size_t k = 0; k < 3; ++k )
	{
		float* const to = m_pushed.data() + k * padded;
		std::transform( to, to + padded, velocity[k]->begin(), to, std::plus<>() );
	}
	const double cellArea = double( m_lattice->cellSize ) * double( m_lattice->cellSize );
	m_implicit->begin( static_cast<LatticeMatcher&>( *m_matcher ), m_nodes, m_pushed.data(),
		ImplicitStep{ h, alpha, m_material.damping, numericalDamping(), m_material.volumeKeeping,
			regionSecondMoment( m_material ) * cellArea, kSolidCellMoment * cellArea },
		m_pull, runner );
	if ( m_pull.isOn() )
	{
		includePulled();
	}
}

PartTurn Body::turnOf( int part, float h ) const
{
	const Vec3d turn = double( h ) * m_implicit->rigidMotion( m_implicit->momentum( part ), part ).tail<3>();
	const std::optional<Eigen::Matrix3d> arc = m_isBent ? m_implicit->arcOf( part ) : std::nullopt;
	return PartTurn{ turn.norm(), arc.has_value(), arc.value_or( Eigen::Matrix3d::Identity() + crossMatrix( turn ) ),
		arc ? Eigen::Quaterniond( *arc ) : rotationBy( turn ) };
}

void Body::noteFrameTurn( float h )
{
	m_frameTurn.reset();
	if ( m_levels && m_wasImplicit && m_implicit && m_implicit->parts().count() == 1 )
	{
		m_frameTurn = turnOf( 0, h ).rotation;
	}
}

void Body::turnFrame()
{
	if ( m_frameTurn )
	{
		m_matcher->turn( *m_frameTurn );
		m_frameTurn.reset();
	}
}

ImplicitMotion& Body::joinFreely()
{
	ImplicitMotion& motion = madeImplicit();
	motion.measureFree( m_nodes, matchedParts() );
	return motion;
}

ImplicitMotion& Body::measureRigidMotions()
{
	ImplicitMotion& motion = madeImplicit();
	motion.measureRigid( m_nodes, matchedParts() );
	return motion;
}

TouchedNodes& Body::joinByContacts()
{
	if ( !m_touched )
	{
		m_touched = std::make_unique<TouchedNodes>();
	}
	m_touched->begin( m_nodes, m_velocityBefore, matchedParts() );
	return *m_touched;
}

/// Null for one part: clusters hold all their nodes together, linked or not.
const ConnectedParts* Body::matchedParts() const
{
	return m_material.method == Method::Lattice ? &static_cast<const LatticeMatcher&>( *m_matcher ).parts() : nullptr;
}

} // namespace pliant
