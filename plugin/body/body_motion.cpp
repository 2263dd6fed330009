// Motion of a body's nodes: placing them, external forces, and the position update of a substep.

#include "body/body.h"
#include "body/breaking.h"
#include "body/constants.h"
#include "body/implicit/implicit_motion.h"
#include "body/levels/levels.h"
#include "body/rigid_state.h"

#include "matching/kernels/kernels.h"
#include "matching/matcher.h"
#include "matching/regions/region_tables.h"
#include "matching/step/lattice_matcher.h"
#include "threads/parallel.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pliant {

namespace {

MotionView viewOf( NodeState& nodes, float* kept )
{
	MotionView view;
	AlignedArray<float>* const x[3] = { &nodes.x.x, &nodes.x.y, &nodes.x.z };
	AlignedArray<float>* const v[3] = { &nodes.v.x, &nodes.v.y, &nodes.v.z };
	for ( int k = 0; k < 3; ++k )
	{
		view.x[k] = x[k]->data();
		view.v[k] = v[k]->data();
		view.kept[k] = kept + std::size_t( k ) * std::size_t( nodes.padded );
	}
	view.mass = nodes.mass.data();
	view.freedom = nodes.freedom.data();
	return view;
}

} // namespace

Vec3d snapped( const Vec3d& position )
{
	return ( position / kOriginGrid ).array().round() * kOriginGrid;
}

void Body::place( const Placement& placement )
{
	if ( m_rigid )
	{
		// The rest shape is a rigid shape, too, but another one; the world gives the body its deformable shape at the next step.
		teleport( Placement{ placement.rotation * bestFit().rotation.conjugate(), Vec3d::Zero() } );
		teleport( Placement{ Eigen::Quaterniond::Identity(), placement.position - m_rigid->motion.centre } );
		setRigidVelocities( Vec3d::Zero(), Vec3d::Zero() );
		moveAsRigid( m_rigid->motion );
		return;
	}
	m_nodes.origin = snapped( placement.position );
	const Vec3d centre = placement.position - m_nodes.origin;
	const Eigen::Matrix3d rotation = placement.rotation.normalized().toRotationMatrix();
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		m_nodes.x.set( i, ( rotation * m_nodes.x0.get( i ).cast<double>() + centre ).cast<float>() );
		m_nodes.v.set( i, Vec3::Zero() );
	}
	m_matcher->reset( m_nodes, placement.rotation.normalized() );
	m_matcher->forgetFlow();
	m_energyDebt = LevelDebt{};
	m_cutLinks.clear();
	m_healedLinks.clear();
	if ( m_breaking )
	{
		m_breaking->broken.clear(); // found at previous positions
	}
	keepFiniteState();
}

void Body::teleport( const Placement& by )
{
	if ( m_rigid )
	{
		const RigidMotion& now = m_rigid->motion;
		moveAsRigid( RigidMotion{ by.rotation * now.centre + by.position, ( by.rotation * now.rotation ).normalized(),
			by.rotation * now.velocity, by.rotation * now.angularVelocity } );
		return;
	}
	const Eigen::Matrix3d rotation = by.rotation.normalized().toRotationMatrix();
	const Vec3d moved = rotation * m_nodes.origin + by.position;
	m_nodes.origin = snapped( moved );
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		m_nodes.x.set( i, ( rotation * m_nodes.x.get( i ).cast<double>() + ( moved - m_nodes.origin ) ).cast<float>() );
		m_nodes.v.set( i, ( rotation * m_nodes.v.get( i ).cast<double>() ).cast<float>() );
	}
	m_matcher->turn( by.rotation.normalized() );
	keepFiniteState();
}

void Body::rescale( std::shared_ptr<const Lattice> lattice )
{
	Material measured = m_material;
	measured.yieldStrain = hasFlowed() && !needsInverse( measured ) ? 1.0f : measured.yieldStrain; // plasticity was switched off since
	std::vector<std::uint32_t> same( static_cast<std::size_t>( m_nodes.count ) );
	std::iota( same.begin(), same.end(), 0u );
	std::swap( m_lattice, lattice );
	std::unique_ptr<Matcher> matcher;
	try
	{
		matcher = makeMatcher( measured ); // tables are in cells, and so of any size
		static_cast<LatticeMatcher&>( *matcher ).inherit( static_cast<const LatticeMatcher&>( *m_matcher ), same );
		if ( m_breaking )
		{
			m_breaking->prepare( *m_lattice, m_material, m_breaking->limits.toughness );
			m_breaking->broken.clear();
		}
	}
	catch ( const std::bad_alloc& )
	{
		std::swap( m_lattice, lattice );
		throw;
	}
	const double ratio = double( m_lattice->cellSize ) / double( lattice->cellSize );
	const Vec3d centre = sums().centre;
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		m_nodes.x.set( i, ( centre + ratio * ( m_nodes.x.get( i ).cast<double>() - centre ) ).cast<float>() );
		m_nodes.x0.set( i, m_lattice->restCentre[std::size_t( i )] );
		m_nodes.mass[i] *= float( ratio * ratio * ratio );
	}
	m_implicit.reset(); // it refers to the previous matcher
	m_matcher = std::move( matcher );
	makeMeasures( m_isOnePart );
	m_motion = measureMotion();
	keepFiniteState();
}

void Body::shift( const Vec3d& by )
{
	if ( m_rigid )
	{
		m_rigid->motion.centre += by;
	}
	const Vec3d moved = m_nodes.origin + by;
	m_nodes.origin = snapped( moved );
	const Vec3 rest = ( moved - m_nodes.origin ).cast<float>();
	for ( int i = 0; i < m_nodes.count && !rest.isZero( 0.0f ); ++i )
	{
		m_nodes.x.set( i, m_nodes.x.get( i ) + rest );
	}
	m_motion = measureMotion();
	keepFiniteState();
}

void Body::reserveMotionScratch()
{
	const std::size_t now = std::size_t( m_nodes.padded ) * 3;
	for ( AlignedArray<float>* const array : { &m_lastFinite, &m_positionScratch } )
	{
		array->resize( now, 0.0f );
		if ( m_levels )
		{
			reserveScratch( *array, std::size_t( m_levels->scratchNodes() + kLanes ) * 3, std::size_t( kScratchFraction * double( now ) ) );
		}
	}
}

void Body::keepVelocities( TaskRunner* runner )
{
	const AlignedArray<float>* const from[3] = { &m_nodes.v.x, &m_nodes.v.y, &m_nodes.v.z };
	AlignedArray<float>* const to[3] = { &m_velocityBefore.x, &m_velocityBefore.y, &m_velocityBefore.z };
	for ( AlignedArray<float>* const component : to )
	{
		component->resize( std::size_t( m_nodes.padded ) );
	}
	runChunks( runner, ChunkedRange{ m_nodes.padded }, [&]( int, int begin, int end ) {
		for ( int k = 0; k < 3; ++k )
		{
			std::copy( from[k]->begin() + begin, from[k]->begin() + end, to[k]->begin() + begin );
		}
	} );
}

void Body::applyForces( float h, const Vec3& gravity, TaskRunner* runner )
{
	const Kernels& kernels = bestKernels();
	const MotionView view = viewOf( m_nodes, m_positionScratch.data() );
	const bool hasForce = !m_nodes.force.x.empty(), hasFields = !m_fieldForce.x.empty();
	PerChunk<VelocityBounds> partial;
	runChunks( runner, ChunkedRange{ m_nodes.padded }, [&]( int chunk, int begin, int end ) {
		for ( int i = begin; hasForce && i < std::min( end, m_nodes.count ); ++i )
		{
			m_nodes.v.set( i, m_nodes.v.get( i ) + ( h * m_nodes.freedom[i] / m_nodes.mass[i] ) * m_nodes.force.get( i ) );
		}
		for ( int i = begin; hasFields && i < std::min( end, m_nodes.count ); ++i )
		{
			m_nodes.v.set( i, m_nodes.v.get( i ) + ( h * m_nodes.freedom[i] / m_nodes.mass[i] ) * m_fieldForce.get( i ) );
		}
		kernels.push( view, gravity.data(), h, begin, end, partial[std::size_t( chunk )] );
	} );
	m_velocities = VelocityBounds{};
	for ( const VelocityBounds& part : partial )
	{
		for ( int k = 0; k < 3; ++k )
		{
			m_velocities.low[k] = std::min( m_velocities.low[k], part.low[k] );
			m_velocities.high[k] = std::max( m_velocities.high[k], part.high[k] );
		}
		m_velocities.worst += part.worst;
	}
}

void Body::applyPull()
{
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		const float gain = m_pull.gain[std::size_t( i )] * m_nodes.freedom[i];
		m_nodes.v.set( i, ( m_nodes.v.get( i ) + gain * m_pull.velocity.get( i ) ) / ( 1.0f + gain ) );
	}
	includePulled();
}

/// Extends the velocity bounds by the pull to a pose.
void Body::includePulled()
{
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		for ( int k = 0; k < 3 && m_pull.gain[std::size_t( i )] > 0.0f; ++k )
		{
			const float u = m_pull.velocity.get( i )[k];
			m_velocities.low[k] = std::min( m_velocities.low[k], u );
			m_velocities.high[k] = std::max( m_velocities.high[k], u );
		}
	}
}

void Body::pullImpulse( Vec3d& linear, Vec3d& angular ) const
{
	linear = angular = Vec3d::Zero();
	for ( int i = 0; m_pull.isOn() && i < m_nodes.count; ++i )
	{
		const double gain = double( m_nodes.mass[i] * m_nodes.freedom[i] * m_pull.gain[std::size_t( i )] );
		const Vec3d impulse = gain * ( m_pull.velocity.get( i ) - m_nodes.v.get( i ) ).cast<double>();
		linear += impulse;
		angular += m_nodes.worldPosition( i ).cross( impulse );
	}
}

void Body::bendToArcs( float h, bool isTouched )
{
	if ( isTouched && !m_breaking )
	{
		return;
	}
	m_implicit->bendToArcs( double( h ), isTouched ? kLeastTouchedArc : kLeastArc );
	m_isBent = true;
}

// The new positions are written twice: here, and over the scratch copy. If all are finite, that copy becomes the last finite state,
// otherwise the previous one is intact: 24 bytes per node and a second store ensure that a non-finite number never spreads.
BodyHealth Body::integrate( float h, TaskRunner* runner )
{
	const Kernels& kernels = bestKernels();
	const MotionView view = viewOf( m_nodes, m_positionScratch.data() );
	PerChunk<MotionSums> sums;
	runChunks( runner, ChunkedRange{ m_nodes.padded },
		[&]( int chunk, int begin, int end ) { kernels.advance( view, h, begin, end, sums[std::size_t( chunk )] ); } );
	m_motion = MotionSums{};
	for ( const MotionSums& sum : sums )
	{
		m_motion.mass += sum.mass;
		m_motion.squareSpeed += sum.squareSpeed;
		m_motion.worst += sum.worst;
		for ( int k = 0; k < 3; ++k )
		{
			m_motion.moment[k] += sum.moment[k];
		}
	}
	const bool wasBent = std::exchange( m_isBent, false );
	if ( m_motion.worst != 0.0f )
	{
		restoreFiniteState();
		m_motion = measureMotion();
		return BodyHealth::Quarantined;
	}
	m_positionScratch.swap( m_lastFinite );
	m_lastFiniteOrigin = m_nodes.origin;
	if ( wasBent )
	{
		m_implicit->turnVelocities();
	}
	rebase();
	return BodyHealth::Good;
}

MotionSums Body::measureMotion() const
{
	const BodySums whole = sums();
	const Vec3d moment = whole.mass * whole.centre;
	return MotionSums{ whole.mass, { moment.x(), moment.y(), moment.z() }, 2.0 * whole.kineticEnergy, 0.0f };
}

void Body::keepFiniteState()
{
	m_positionScratch.resize( std::size_t( m_nodes.padded ) * 3 ); // within its capacity (reserveMotionScratch)
	m_lastFinite.resize( std::size_t( m_nodes.padded ) * 3 );
	auto to = m_lastFinite.begin();
	for ( const AlignedArray<float>* const component : { &m_nodes.x.x, &m_nodes.x.y, &m_nodes.x.z } )
	{
		to = std::copy( component->begin(), component->end(), to );
	}
	m_lastFiniteOrigin = m_nodes.origin;
}

void Body::restoreFiniteState()
{
	auto from = m_lastFinite.begin();
	for ( AlignedArray<float>* const component : { &m_nodes.x.x, &m_nodes.x.y, &m_nodes.x.z } )
	{
		std::copy( from, from + m_nodes.padded, component->begin() );
		from += m_nodes.padded;
	}
	m_nodes.v.resize( m_nodes.padded );
	m_nodes.origin = m_lastFiniteOrigin;
	m_matcher->reset( m_nodes, bestFit().rotation );
}

void Body::rebase()
{
	// Node 0 represents the body: the origin need only stay near, and the test is then free.
	const Vec3d offset = m_nodes.x.get( 0 ).cast<double>();
	if ( offset.cwiseAbs().maxCoeff() <= m_originLimit )
	{
		return;
	}
	// Moves by whole multiples of a power of two: origin and positions change by the same exactly representable amount.
	const Vec3d move = snapped( offset );
	m_nodes.origin += move;
	const Vec3 back = move.cast<float>();
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		m_nodes.x.set( i, m_nodes.x.get( i ) - back );
	}
	keepFiniteState();
	m_motion = measureMotion();
}

} // namespace pliant
