#include "body/body.h"

#include "body/breaking.h"
#include "body/implicit/implicit_motion.h"
#include "body/implicit/touched_nodes.h"
#include "body/levels/levels.h"
#include "body/rigid_state.h"
#include "lattice/attempt.h"
#include "matching/clusters/cluster_matcher.h"
#include "matching/regions/link_moments.h"
#include "matching/rotation.h"
#include "matching/step/coarse_to_fine.h"
#include "matching/step/lattice_matcher.h"
#include "matching/stiffness.h"
#include "threads/parallel.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

double longestExtent( const Lattice& lattice )
{
	Vec3 low = lattice.restCentre[0], high = low;
	for ( const Vec3& p : lattice.restCentre )
	{
		low = low.cwiseMin( p );
		high = high.cwiseMax( p );
	}
	return double( ( high - low ).maxCoeff() ) + lattice.cellSize;
}

/// Mean over the axes of the second moment of the material about its centre, per mass, m^2.
double meanSecondMoment( const Lattice& lattice )
{
	double moment = 0.0, fill = 0.0;
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		moment += double( lattice.fill[i] ) * lattice.restCentre[i].squaredNorm();
		fill += lattice.fill[i];
	}
	return moment / ( 3.0 * fill );
}

bool needsNewMatcher( const Material& a, const Material& b, bool hasLevels )
{
	return a.method != b.method || a.clusterMode != b.clusterMode || a.clusterEdge != b.clusterEdge || a.weights != b.weights ||
		a.rotationFrom != b.rotationFrom || a.regionHalfWidth != b.regionHalfWidth || a.beta != b.beta ||
		a.volumeKeeping != b.volumeKeeping || a.farLevels != b.farLevels || ( !hasLevels && usesLinkMoments( a ) != usesLinkMoments( b ) );
}

/// Returns the material with the values that follow from the rest shape.
Material completed( const Material& wanted, const Lattice& lattice )
{
	Material material = wanted;
	material.farLevels = usefulFarLevels( lattice, wanted.farLevels );
	if ( material.youngsModulus == 0.0f )
	{
		material.youngsModulus = defaultYoungsModulus( material.density, float( longestExtent( lattice ) ) );
	}
	return material;
}

} // namespace

Body::Body() = default;
Body::Body( Body&& ) noexcept = default;
Body::~Body() = default;

Result<std::unique_ptr<Body>> Body::create( std::shared_ptr<const Lattice> lattice, const Material& material, const Placement& placement,
	std::shared_ptr<TemplateCache> cache, const Adaptivity& adaptivity, const StiffnessField& stiffness )
{
	using Made = Result<std::unique_ptr<Body>>;
	return withinMemory( "Not enough memory for a body of this many cells.", [&]() -> Made {
		rejectIf( !lattice || lattice->cellCount() == 0, ResultCode::BadArgument, "A body needs a lattice with at least one cell." );
		insist( check( material ) );
		insist( check( adaptivity ) );
		const bool hasLevels = adaptivity.coarseLevels > 0;
		rejectIf( hasLevels && material.method != Method::Lattice, ResultCode::BadSettings, "Adaptivity: levels need Method::Lattice." );
		rejectIf( hasLevels && material.farLevels > 0, ResultCode::BadSettings,
			"Adaptivity: a body with levels of detail takes no Material::farLevels." );
		std::unique_ptr<Body> body( new Body );
		body->m_lattice = std::move( lattice );
		body->m_cache = std::move( cache );
		body->m_material = completed( material, *body->m_lattice );
		insist( body->sampleStiffness( stiffness ) );
		body->makeNodes( adaptivity );
		body->makeMeasures( countComponents( *body->m_lattice ) == 1 );
		body->m_matcher = body->makeMatcher( body->m_material );
		body->reserveMotionScratch();
		body->place( placement );
		return Made::success( std::move( body ) );
	} );
}

void Body::makeMeasures( bool isOnePart )
{
	m_restLength = longestExtent( *m_lattice );
	m_secondMoment = meanSecondMoment( *m_lattice );
	m_isOnePart = isOnePart;
}

Status Body::setMaterial( const Material& wanted )
{
	return withinMemory( "Not enough memory to change the body's method.", [&]() {
		insist( check( wanted ) );
		rejectIf( m_breaking && wanted.method != Method::Lattice, ResultCode::BadMaterial, "A body that can break needs Method::Lattice." );
		Material material = completed( wanted, *m_lattice );
		std::unique_ptr<Matcher> matcher;
		// A body with plastic flow has the tables for more of it, even where plasticity was switched off since.
		const bool lacksInverse = !m_levels && material.yieldStrain > 0.0f && !needsInverse( m_material ) && !hasFlowed();
		if ( lacksInverse || needsNewMatcher( m_material, material, m_levels != nullptr ) )
		{
			rejectIf( m_levels != nullptr, ResultCode::BadMaterial,
				"Method, weights, beta, half-width and far levels of a body with levels are fixed when it is made." );
			matcher = makeMatcher( material );
			matcher->reset( m_nodes, bestFit().rotation );
		}
		const float ratio = material.density / m_material.density;
		for ( int i = 0; i < m_nodes.count; ++i )
		{
			m_nodes.mass[i] *= ratio;
		}
		if ( matcher )
		{
			m_matcher = std::move( matcher );
			m_implicit.reset(); // it refers to the previous matcher
		}
		m_material = material;
		if ( m_breaking && ( m_breaking->settings.strength > 0.0f || m_breaking->shards ) ) // they depend on the modulus
		{
			m_breaking->prepare( *m_lattice, m_material, std::move( m_breaking->limits.toughness ) );
		}
	} );
}

void Body::setPinned( int node, bool pinned )
{
	m_nodes.freedom[node] = pinned ? 0.0f : 1.0f;
	if ( m_levels && pinned )
	{
		m_levels->pin( node );
	}
}

void Body::accelerateTowardGoals( float h, float alpha, TaskRunner* runner )
{
	m_wasImplicit = false;
	keepVelocities( runner );
	if ( m_nodes.count == 1 )
	{
		return; // the goal of a single node is its own position
	}
	reduceEnergyDebt( h, alpha );
	const bool measuresStrain = m_levels && m_reviewIn == 0 && m_levels->followsStrain();
	MatchStep step{ h, alpha, m_material.damping, wobbleRate( h, alpha ), bodyFraction( h, alpha ), measuresStrain,
		PlasticLaw{ m_material.yieldStrain, m_material.plasticCreep, m_material.plasticLimit },
		farFractions( m_material, m_lattice->cellSize, h ), m_isOnePart, float( m_restLength ) };
	step.mostWobble = largestWobbleFraction( m_material.damping, h, alpha, m_material.volumeKeeping );
	step.mostVolumeResponse = largestVolumeResponse( alpha, m_material.volumeKeeping );
	m_matcher->accelerate( m_nodes, step, runner );
}

double Body::stiffnessMoment( float h, float alpha ) const
{
	return alpha * modulusMoment( m_material ) + farMoment( farFractions( m_material, m_lattice->cellSize, h ) );
}

// The lowest free vibration of a bar of length L has omega = pi c / L with c = sqrt( E / rho ); a motion damped at rate r has damping ratio
// r / ( 2 omega ). E is the modulus that corresponds to this alpha and h (see planStiffness), so that the settings do not change the ratio.
float Body::wobbleRate( float h, float alpha ) const
{
	if ( m_material.wobbleDamping == 0.0f || ( !m_isOnePart && m_material.method != Method::Lattice ) )
	{
		return 0.0f;
	}
	const double speed = m_lattice->cellSize / double( h ) * std::sqrt( stiffnessMoment( h, alpha ) );
	const double omega = kPi * speed / m_restLength;
	return float( 2.0 * m_material.wobbleDamping * omega * ( 1.0 - m_rolling ) );
}

// Where alpha is clamped to its limit, the regions alone only reach E_f = rho d^2 w ( w + 1 ) / ( 3 h^2 ). Matching the whole body reaches
// E_b = rho m / h^2, m the mean second moment per axis, which is larger for bodies of many cells. A weight s of it in the goal makes up the
// difference as far as possible: ( 1 - s ) E_f + s E_b = E. Both are contractions, and so is their blend.
float Body::bodyFraction( float h, float alpha ) const
{
	if ( m_material.stiffness != Stiffness::YoungsModulus || m_material.method == Method::SingleCluster ||
		alpha < float( largestAlpha( m_material ) ) || !m_isOnePart ||
		m_material.yieldStrain > 0.0f ) // the whole body's fit does not include plastic flow
	{
		return 0.0f;
	}
	const double d = m_lattice->cellSize;
	const double perStep = m_material.density / ( double( h ) * h );
	const double regionModulus = perStep * d * d * stiffnessMoment( h, alpha ), bodyModulus = perStep * m_secondMoment;
	if ( bodyModulus <= regionModulus )
	{
		return 0.0f;
	}
	return float( std::clamp( ( m_material.youngsModulus - regionModulus ) / ( bodyModulus - regionModulus ), 0.0, 1.0 ) );
}

Status validate( const Body& body )
{
	Status status = validate( body.lattice() );
	return status.ok() && body.levels() ? body.levels()->validate() : status;
}

} // namespace pliant
