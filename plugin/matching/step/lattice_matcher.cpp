#include "matching/step/lattice_matcher.h"

#include "matching/constants.h"
#include "matching/rotation.h"
#include "matching/step/settle_region.h"
#include "threads/parallel.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

static_assert( kNodesPerTask % kTile == 0 );
static_assert( kRecordFloats == kSumFloats );

int chunks( int padded )
{
	return ( padded + kNodesPerTask - 1 ) / kNodesPerTask;
}

} // namespace

LatticeMatcher::LatticeMatcher( const Lattice& lattice, const Material& material, Summation summation, const Kernels& kernels ) :
	LatticeMatcher( lattice, material, buildRegionTables( lattice, material, summation ), kernels )
{}

LatticeMatcher::LatticeMatcher(
	const Lattice& lattice, const Material& material, std::shared_ptr<const RegionTables> tables, const Kernels& kernels ) :
	m_kernels( kernels ),
	m_lattice( &lattice ), m_tables( std::move( tables ) ), m_cellSize( lattice.cellSize ), m_beta( material.beta ),
	m_volumeFraction( material.volumeKeeping ), m_rotationFromF( material.rotationFrom == RotationFrom::F ),
	m_keepsMomentum( material.weights == Weights::Conserving && material.rotationFrom == RotationFrom::Apq )
{
	allocate();
}

void LatticeMatcher::allocate()
{
	const int padded = m_tables->moments.padded;
	for ( auto& component : m_quaternion )
	{
		component.assign( padded, 0.0f );
	}
	m_quaternion[0].assign( padded, 1.0f );
	for ( auto& component : m_residual )
	{
		component.assign( padded, 0.0f );
	}
	allocateScratch();
}

void LatticeMatcher::allocateScratch()
{
	const int padded = m_tables->moments.padded;
	for ( auto& component : m_change )
	{
		component.assign( padded, 0.0f );
	}
	std::size_t records = m_tables->usesGrid ? m_tables->grid.cast<std::size_t>().prod() : std::size_t( padded );
	if ( m_tables->plan )
	{
		records = std::max( records, std::size_t( m_tables->plan->records() ) );
	}
	if ( m_tables->matrix && !m_tables->plan ) // each is written before it is read
	{
		m_nodeRecord.resize( records * kRecordFloats );
		m_regionRecord.resize( records * kRecordFloats );
	}
	else
	{
		m_nodeRecord.assign( records * kRecordFloats, 0.0f );
		m_regionRecord.assign( records * kRecordFloats, 0.0f );
	}
	m_open.resize( padded );
	m_openCount.resize( chunks( padded ) );
	m_partial.resize( chunks( padded ) );
}

void LatticeMatcher::reset( const NodeState&, const Eigen::Quaterniond& rotation )
{
	m_frame = rotation;
	std::fill( m_quaternion[0].begin(), m_quaternion[0].end(), 1.0f );
	for ( int k = 0; k < 3; ++k )
	{
		std::fill( m_quaternion[k + 1].begin(), m_quaternion[k + 1].end(), 0.0f );
		std::fill( m_residual[k].begin(), m_residual[k].end(), 0.0f );
	}
	if ( m_far )
	{
		m_far->reset();
	}
}

void LatticeMatcher::setFarLevels( int levels, const std::vector<float>& stiffness )
{
	m_far = levels == 0 ? nullptr : std::make_unique<CoarseToFine>( *m_lattice, levels, *m_tables, stiffness );
}

void LatticeMatcher::turn( const Eigen::Quaterniond& by )
{
	m_frame = ( by * m_frame ).normalized(); // all other state is relative to the frame
}

MatchView LatticeMatcher::view( NodeState& nodes )
{
	const RegionMoments& moments = m_tables->moments;
	const RegionSet& regions = m_tables->regions;
	const Eigen::Vector3i grid = m_tables->usesGrid ? m_tables->grid : Eigen::Vector3i( Eigen::Vector3i::Zero() );
	MatchView v;
	v.nodeCount = moments.count;
	float* const velocity[3] = { nodes.v.x.data(), nodes.v.y.data(), nodes.v.z.data() };
	const float* const position[3] = { nodes.x.x.data(), nodes.x.y.data(), nodes.x.z.data() };
	const float* const rest[3] = { nodes.x0.x.data(), nodes.x0.y.data(), nodes.x0.z.data() };
	for ( int k = 0; k < 3; ++k )
	{
		v.x[k] = position[k];
		v.v[k] = velocity[k];
		v.x0[k] = rest[k];
		v.change[k] = m_change[k].data();
		v.residual[k] = m_residual[k].data();
		v.centre[k] = moments.centre[k].data();
	}
	v.mass = nodes.mass.data();
	v.freedom = nodes.freedom.data();
	v.nodeWeight = moments.nodeWeight.data();
	v.inverseCover = moments.inverseCover.data();
	v.start = m_tables->usesLinks ? m_lattice->linkStart.data() : regions.start.data();
	v.member = m_tables->usesLinks ? m_lattice->linkTo.data() : regions.member.data();
	v.addOwner = m_tables->usesLinks;
	v.inverseMass = moments.inverseMass.data();
	for ( int k = 0; k < 6; ++k )
	{
		v.moment[k] = moments.moment[k].data();
		v.inverseMoment[k] = moments.inverseMoment[k].empty() ? nullptr : moments.inverseMoment[k].data();
		v.outOfPlane[k] = m_tables->outOfPlane[k].empty() ? nullptr : m_tables->outOfPlane[k].data();
	}
	v.regionWeight = moments.regionWeight.empty() ? nullptr : moments.regionWeight.data();
	for ( int k = 0; k < 4; ++k )
	{
		v.quaternion[k] = m_quaternion[k].data();
	}
	v.nodeRecord = m_nodeRecord.data();
	v.regionRecord = m_regionRecord.data();
	v.slot = m_tables->slot.empty() ? nullptr : m_tables->slot.data();
	v.gridX = grid.x();
	v.gridY = grid.y();
	v.gridZ = grid.z();
	v.halfWidth = regions.halfWidth;
	v.cellsPerMetre = 1.0f / m_cellSize;
	v.beta = m_beta;
	v.rotationFromF = m_rotationFromF;
	viewVolume( v );
	v.pull = m_tables->pull.empty() ? nullptr : m_tables->pull.data();
	viewBlend( v );
	if ( m_tables->matrix )
	{
		viewLevels( v );
	}
	if ( m_plastic )
	{
		m_plastic->show( v );
	}
	return v;
}

// The frame need not be exact: it only keeps u small. It is measured from the nodes in each substep, so that any change the game makes to
// them in between is included.
void LatticeMatcher::measureFrame( const NodeState& nodes, MatchView& view, TaskRunner* runner )
{
	auto task = [&]( int chunk ) {
		m_partial[chunk].fill( 0.0f );
		m_kernels.frameSums(
			view, chunk * kNodesPerTask, std::min( nodes.padded, ( chunk + 1 ) * kNodesPerTask ), m_partial[chunk].data() );
	};
	runTasks( runner, chunks( nodes.padded ), task );

	double sum[kFrameSums] = {};
	for ( const auto& partial : m_partial )
	{
		for ( int k = 0; k < kFrameSums; ++k )
		{
			sum[k] += partial[k];
		}
	}
	m_mass = sum[12];
	const Vec3d centre = Vec3d::Map( sum ) / m_mass;
	Eigen::Matrix3d moment;
	moment << sum[3], sum[4], sum[5], sum[6], sum[7], sum[8], sum[9], sum[10], sum[11];
	m_frame = fitRotation( moment, m_frame );
	setFrame( view, centre );
}

void LatticeMatcher::setFrame( MatchView& view, const Vec3d& centre ) const
{
	const Eigen::Matrix3d rotation = m_frame.toRotationMatrix();
	for ( int i = 0; i < 3; ++i )
	{
		view.frameCentre[i] = float( centre[i] );
		for ( int j = 0; j < 3; ++j )
		{
			view.frameRotation[3 * i + j] = float( rotation( i, j ) );
		}
	}
}

/// Sums over the grid or up the octree, where the kernels' tables do not do it.
void LatticeMatcher::sumNodeRecords( const MatchView& view, TaskRunner* runner )
{
	if ( m_tables->usesGrid )
	{
		boxSums( view, m_nodeRecord.data(), runner );
	}
	if ( m_tables->plan )
	{
		depthSum( *m_tables->plan, m_nodeRecord.data() );
	}
}

void LatticeMatcher::boxSums( const MatchView& view, float* records, TaskRunner* runner )
{
	auto task = [&]( int z ) { m_kernels.boxPlane( view, records, z ); };
	runTasks( runner, view.gridZ, task );
}

void LatticeMatcher::gatherAndFit( MatchView& view, const MatchStep& step, TaskRunner* runner )
{
	// Box sums add all floats of a record; the rates of bodies that conserve their volume fill those that matching does not use.
	if ( m_tables->gridHasHoles || !m_volumeSize.empty() )
	{
		std::fill( m_nodeRecord.begin(), m_nodeRecord.end(), 0.0f );
		std::fill( m_regionRecord.begin(), m_regionRecord.end(), 0.0f );
	}
	const int padded = m_tables->moments.padded;
	auto records = [&]( int chunk ) {
		m_kernels.nodeRecords( view, chunk * kNodesPerTask, std::min( padded, ( chunk + 1 ) * kNodesPerTask ) );
	};
	runTasks( runner, chunks( padded ), records );
	if ( m_far && step.far[0] > 0.0f ) // before box sums overwrite the records
	{
		m_far->match( view, step.far, m_kernels, runner );
	}
	sumNodeRecords( view, runner );
	auto fit = [&]( int chunk ) {
		const int end = std::min( padded, ( chunk + 1 ) * kNodesPerTask );
		m_openCount[chunk] = m_kernels.fitRegions( view, chunk * kNodesPerTask, end, &m_open[chunk * kNodesPerTask] );
	};
	runTasks( runner, chunks( padded ), fit );
	settleOpenRegions( view );
	if ( m_tables->usesGrid )
	{
		boxSums( view, m_regionRecord.data(), runner );
	}
	if ( m_tables->plan )
	{
		depthSum( *m_tables->plan, m_regionRecord.data() );
	}
}

void LatticeMatcher::settleOpenRegions( const MatchView& view )
{
	for ( int chunk = 0; chunk < int( m_openCount.size() ); ++chunk )
	{
		for ( int k = 0; k < m_openCount[chunk]; ++k )
		{
			settleRegion( m_kernels, view, int( m_open[chunk * kNodesPerTask + k] ) );
		}
	}
}

void LatticeMatcher::accelerate( NodeState& nodes, const MatchStep& step, TaskRunner* runner )
{
	if ( step.storesVolumeGradients && m_volumeFraction > 0.0f )
	{
		m_volumeSize.resize( m_tables->moments.padded );
		for ( AlignedArray<float>& component : m_volumeGradient )
		{
			component.resize( m_tables->moments.padded );
		}
	}
	MatchView v = view( nodes );
	v.alpha = step.alpha;
	v.bodyFraction = step.bodyFraction;
	v.dampingFraction = dampingFraction( double( step.damping ), double( step.h ), double( step.alpha ), double( m_volumeFraction ) );
	v.wobbleFraction = float( step.wobbleFraction( double( step.wobbleDamping ) ) );
	v.velocityPerCell = m_cellSize / step.h;
	v.mostVolumeResponse = step.mostVolumeResponse;
	if ( !step.storesVolumeGradients )
	{
		std::fill( std::begin( v.volumeGradient ), std::end( v.volumeGradient ), nullptr );
	}
	if ( m_isHistoryForeign )
	{
		v.dampingFraction = 0.0f;
		m_isHistoryForeign = false;
	}
	if ( m_far && step.far[0] > 0.0f )
	{
		v.dampingFraction = std::min( v.dampingFraction, kLargestFarDampingFraction );
		v.farDamping = v.dampingFraction > 0.0f ? std::min( 1.0f, kLargestDampingOfFar / v.dampingFraction ) : 0.0f;
	}
	if ( ( step.measuresStrain || step.plastic.yieldStrain > 0.0f ) && v.inverseMoment[0] )
	{
		m_strain.resize( m_tables->moments.padded );
		v.strain = m_strain.data();
	}
	if ( step.measuresStrain && v.strain )
	{
		m_stretch.resize( m_strain.size() );
		v.stretch = m_stretch.data();
	}
	updateParts( v, step.isOnePart );
	measureFrame( nodes, v, runner );
	gatherAndFit( v, step, runner );

	auto scatter = [&]( int chunk ) {
		m_partial[chunk].fill( 0.0f );
		m_kernels.scatter( v, chunk * kNodesPerTask, std::min( nodes.padded, ( chunk + 1 ) * kNodesPerTask ), m_partial[chunk].data() );
	};
	runTasks( runner, chunks( nodes.padded ), scatter );
	if ( m_parts.areSeveral() )
	{
		applyToParts( v, step, runner );
		flow( v, step, runner );
		return;
	}
	correctRigidMotion( v, step.h );
	auto apply = [&]( int chunk ) { m_kernels.apply( v, chunk * kNodesPerTask, std::min( nodes.padded, ( chunk + 1 ) * kNodesPerTask ) ); };
	runTasks( runner, chunks( nodes.padded ), apply );
	flow( v, step, runner );
}

void LatticeMatcher::flow( const MatchView& view, const MatchStep& step, TaskRunner* runner )
{
	if ( step.plastic.yieldStrain == 0.0f || !view.strain || !PlasticFlow::yieldsAnywhere( view, step.plastic.yieldStrain ) )
	{
		return;
	}
	if ( !m_plastic )
	{
		m_plastic = std::make_unique<PlasticFlow>( *m_tables );
	}
	const int padded = m_tables->moments.padded;
	auto task = [&]( int chunk ) {
		m_openCount[chunk] = m_plastic->flow(
								 view, m_kernels, step, chunk * kNodesPerTask, std::min( padded, ( chunk + 1 ) * kNodesPerTask ) )
			? 1
			: 0;
	};
	runTasks( runner, chunks( padded ), task );
	// Plastic flow moves goals without any motion of the nodes: damping that change would accelerate them.
	m_isHistoryForeign = std::any_of( m_openCount.begin(), m_openCount.end(), []( int count ) { return count > 0; } );
}

void LatticeMatcher::nodeRotations( const NodeState& nodes, float* quaternions ) const
{
	const Eigen::Quaternionf frame = m_frame.cast<float>();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Eigen::Quaternionf own( m_quaternion[0][i], m_quaternion[1][i], m_quaternion[2][i], m_quaternion[3][i] );
		const Eigen::Quaternionf q = frame * own;
		quaternions[4 * i + 0] = q.x();
		quaternions[4 * i + 1] = q.y();
		quaternions[4 * i + 2] = q.z();
		quaternions[4 * i + 3] = q.w();
	}
}

void LatticeMatcher::viewVolume( MatchView& v )
{
	v.volumeFraction = m_volumeFraction;
	for ( int k = 0; k < 9 && !m_volumeSize.empty(); ++k )
	{
		v.volumeGradient[k] = m_volumeGradient[k].data();
		v.volumeSize = m_volumeSize.data();
	}
}

float LatticeMatcher::mostVolumeChange() const
{
	float most = 0.0f;
	for ( int r = 0; r < m_tables->moments.count && !m_volumeSize.empty(); ++r )
	{
		most = std::max( most, std::min( 1.0f, std::abs( m_volumeSize[std::size_t( r )] ) ) );
	}
	return most;
}

} // namespace pliant
