#include "matching/implicit/strain_rates.h"

#include "matching/constants.h"
#include "matching/step/lattice_matcher.h"
#include "threads/parallel.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

static_assert( kNodesPerTask % kTile == 0 );

int chunks( int padded )
{
	return ( padded + kNodesPerTask - 1 ) / kNodesPerTask;
}

template <class Kernel>
void overNodes( int padded, TaskRunner* runner, Kernel kernel )
{
	auto task = [&]( int chunk ) { kernel( chunk, chunk * kNodesPerTask, std::min( padded, ( chunk + 1 ) * kNodesPerTask ) ); };
	runTasks( runner, chunks( padded ), task );
}

} // namespace

void StrainRates::prepare( LatticeMatcher& matcher, NodeState& nodes, TaskRunner* runner, float stiffness )
{
	const RegionTables& tables = matcher.tables();
	m_kernels = &matcher.kernels();
	m_view = matcher.view( nodes );
	m_padded = nodes.padded;
	m_gridHasHoles = tables.gridHasHoles;
	m_recordFloats = matcher.recordFloats();
	m_partial.resize( std::size_t( chunks( m_padded ) ) );
	measureBody( nodes, &matcher.parts() );
	centreFrames( nodes );
	m_rates = RateView{};
	m_rates.match = &m_view;
	m_rates.tautMoment = stiffness > 0.0f ? 1.0f + kTautStretch / std::sqrt( stiffness ) : 0.0f;
	const Eigen::Matrix3d frame = matcher.frame().toRotationMatrix();
	for ( int k = 0; k < 9; ++k )
	{
		m_view.frameRotation[k] = float( frame( k / 3, k % 3 ) );
	}
	if ( stiffness >= kLeastFramedStiffness && !m_parts->areSeveral() )
	{
		measureDisplacements( frame );
	}
	const bool hasOwnFractions = !tables.rateFraction.empty();
	m_rates.regionFraction = hasOwnFractions ? tables.rateFraction.data() : m_view.regionWeight;
	m_rates.pull = hasOwnFractions ? tables.ratePull.data() : m_view.pull;
	m_plan = tables.plan;
	for ( int k = 0; k < 6; ++k )
	{
		m_rates.regionCentre[k % 3] = m_centres[k % 3].data();
		m_rates.inverseInertia[k] = m_inverseInertias[k].data();
	}
	const bool isMeasured = m_measuredOf == &matcher && m_measuredVersion == matcher.tablesVersion();
	if ( tables.matrix )
	{
		if ( !isMeasured )
		{
			measureFractions( tables );
		}
		m_rates.regionFraction = m_fraction.data();
		m_rates.pull = m_pull.data();
	}
	if ( tables.usesGrid && !m_gridHasHoles && !m_sumsByRecords && !m_view.volumeGradient[0] )
	{
		if ( !isMeasured )
		{
			m_boxes.layOut( m_view.gridX, m_view.gridY, m_view.gridZ, m_view.halfWidth, m_padded );
		}
		m_rates.flat = m_boxes.view();
	}
	if ( !isMeasured )
	{
		measureDiagonal( tables );
		m_measuredOf = &matcher;
		m_measuredVersion = matcher.tablesVersion();
	}
	measureRegions( runner );
}

/// Region centres are relative to the body's centre, or to that of their part.
void StrainRates::centreFrames( const NodeState& nodes )
{
	if ( m_parts->areSeveral() )
	{
		centreParts( nodes );
	}
	for ( int k = 0; k < 3; ++k )
	{
		m_view.frameCentre[k] = m_parts->areSeveral() ? 0.0f : float( whole().centre[k] );
		m_centres[k].resize( std::size_t( m_padded ) );
	}
	for ( AlignedArray<float>& component : m_inverseInertias )
	{
		component.resize( std::size_t( m_padded ) );
	}
}

/// p - R x0 of each node, R the body's frame. In double: in float R x0 is rounded by more than the nodes of a stiff body are displaced.
void StrainRates::measureDisplacements( const Eigen::Matrix3d& frame )
{
	const Eigen::Matrix3d turn = double( m_view.cellsPerMetre ) * frame;
	m_displacements.resize( 3 * std::size_t( m_padded ) );
	for ( int k = 0; k < 3; ++k )
	{
		float* const to = m_displacements.data() + k * m_padded;
		for ( int i = 0; i < m_padded; ++i )
		{
			const float p = ( m_view.x[k][i] - m_view.frameCentre[k] ) * m_view.cellsPerMetre; // positionOf
			to[i] = float( double( p ) -
				( turn( k, 0 ) * double( m_view.x0[0][i] ) + turn( k, 1 ) * double( m_view.x0[1][i] ) +
					turn( k, 2 ) * double( m_view.x0[2][i] ) ) );
		}
		m_rates.displacement[k] = to;
	}
}

void StrainRates::measureRegions( TaskRunner* runner )
{
	m_raised.assign( m_partial.size(), 0 );
	if ( m_gridHasHoles )
	{
		std::fill( m_view.nodeRecord, m_view.nodeRecord + m_recordFloats, 0.0f );
	}
	overNodes( m_padded, runner, [&]( int, int begin, int end ) { m_kernels->inertiaRecords( m_rates, begin, end ); } );
	sumRecords( m_view.nodeRecord, RecordSize::Whole, runner );
	overNodes( m_padded, runner,
		[&]( int chunk, int begin, int end ) { m_raised[std::size_t( chunk )] = m_kernels->regionInertias( m_rates, begin, end ); } );
	m_isRaised = std::find( m_raised.begin(), m_raised.end(), 1 ) != m_raised.end();
}

void StrainRates::measureBody( const NodeState& nodes, const ConnectedParts* parts )
{
	static const ConnectedParts one;
	m_parts = parts ? parts : &one;
	m_wholes.resize( std::size_t( m_parts->count() ) );
	for ( int p = 0; p < m_parts->count(); ++p )
	{
		WholePart& part = m_wholes[std::size_t( p )];
		part.mass = 0.0;
		part.centre.setZero();
		m_parts->forNodes( p, nodes.count, [&]( int i ) {
			part.mass += double( nodes.mass[i] );
			part.centre += double( nodes.mass[i] ) * nodes.x.get( i ).cast<double>();
		} );
		part.centre /= part.mass;
		Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
		m_parts->forNodes( p, nodes.count, [&]( int i ) {
			const Eigen::Vector3d arm = nodes.x.get( i ).cast<double>() - part.centre;
			second += double( nodes.mass[i] ) * arm * arm.transpose();
		} );
		part.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
		part.inverseInertia = inverseOfPart( part.inertia, part.mass );
	}
}

namespace {

/// The largest eigenvalue of C, whose eigenvalues are real and not negative, within the directions in which the region has extent: for a
/// matrix M = m + p B with tr B = 0 and tr B^2 = 6 it is m + 2 p cos( acos( det B / 2 ) / 3 ).
double largestStretch( const RegionTables& tables, std::size_t r )
{
	Eigen::Matrix3d c;
	for ( int k = 0; k < 9; ++k )
	{
		const int symmetric = k % 4 == 0 ? k / 4 : 6 - k / 3 - k % 3; // xx yy zz yz xz xy
		const double outside = tables.outOfPlane[0].empty() ? 0.0 : double( tables.outOfPlane[symmetric][r] );
		c( k / 3, k % 3 ) = double( tables.blend[k][r] ) - outside;
	}
	const double mean = c.trace() / 3.0;
	c.diagonal().array() -= mean;
	const double scatter = std::sqrt( std::max( 0.0, ( c * c ).trace() / 6.0 ) );
	if ( !( scatter > 1e-9 ) )
	{
		return mean;
	}
	return mean + 2.0 * scatter * std::cos( std::acos( std::clamp( 0.5 * ( c / scatter ).determinant(), -1.0, 1.0 ) ) / 3.0 );
}

/// g of a region of nodes on several levels, without the factor b.
double levelFraction( const RegionTables& tables, std::size_t r )
{
	const double affine = !tables.blend[0].empty() ? largestStretch( tables, r )
		: tables.beta.empty()                      ? 1.0
												   : 1.0 - double( tables.beta[r] );
	return std::max( affine, tables.eta.empty() ? 0.0 : 1.0 - double( tables.eta[r] ) );
}

} // namespace

void StrainRates::measureFractions( const RegionTables& tables )
{
	const RegionMatrix& matrix = *tables.matrix;
	m_fraction.assign( std::size_t( m_padded ), 1.0f );
	m_pull.assign( std::size_t( m_padded ), 0.0f );
	for ( std::size_t r = 0; r < std::size_t( matrix.count() ); ++r )
	{
		const double weight = tables.moments.regionWeight.empty() ? 1.0 : double( tables.moments.regionWeight[r] );
		m_fraction[r] = float( weight * levelFraction( tables, r ) );
	}
	for ( std::size_t i = 0; i < std::size_t( matrix.count() ); ++i )
	{
		double sum = 0.0;
		for ( std::uint32_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k )
		{
			sum += double( m_fraction[matrix.member[k]] ) * ( tables.plan ? 1.0 : double( matrix.fraction[k] ) );
		}
		m_pull[i] = float( sum * double( tables.moments.inverseCover[i] ) );
	}
}

void StrainRates::sumRecords( float* records, RecordSize size, TaskRunner* runner )
{
	if ( m_plan )
	{
		size == RecordSize::Half ? depthSumHalf( *m_plan, records ) : depthSum( *m_plan, records );
	}
	const auto boxPlane = size == RecordSize::Half ? m_kernels->boxPlaneHalf
		: size == RecordSize::Full                 ? m_kernels->boxPlaneFull
												   : m_kernels->boxPlane;
	auto task = [&]( int z ) { boxPlane( m_view, records, z ); };
	runTasks( runner, m_view.gridZ, task );
}

void StrainRates::sumRates( bool isOfRegions, TaskRunner* runner )
{
	if ( !m_rates.flat.node[0] )
	{
		sumRecords(
			isOfRegions ? m_view.regionRecord : m_view.nodeRecord, m_view.volumeGradient[0] ? RecordSize::Full : RecordSize::Half, runner );
		return;
	}
	for ( int axis = 0; axis < 2; ++axis )
	{
		overNodes( m_padded, runner, [&]( int, int begin, int end ) { m_kernels->boxRows( m_rates, isOfRegions, axis, begin, end ); } );
	}
}

/// Measures the rigid motion Q v, which the kernels subtract.
void StrainRates::measureRigidMotion( const float* const* velocity, TaskRunner* runner )
{
	overNodes( m_padded, runner, [&]( int chunk, int begin, int end ) {
		m_partial[std::size_t( chunk )].fill( 0.0f );
		m_kernels->rateSums( m_rates, velocity, begin, end, m_partial[std::size_t( chunk )].data() );
	} );
	double sum[kRateSums] = {};
	for ( const auto& partial : m_partial )
	{
		for ( int k = 0; k < kRateSums; ++k )
		{
			sum[k] += double( partial[std::size_t( k )] );
		}
	}
	const double cell = 1.0 / double( m_view.cellsPerMetre );
	const Eigen::Vector3d turn = whole().inverseInertia * Eigen::Vector3d( sum[3], sum[4], sum[5] ) * ( cell * cell );
	for ( int k = 0; k < 3; ++k )
	{
		m_rates.shift[k] = float( sum[k] / whole().mass );
		m_rates.turn[k] = float( turn[k] );
	}
}

void StrainRates::resist( const float* v, float stiffness, float* to, TaskRunner* runner, float volume )
{
	for ( int k = 0; k < 3; ++k )
	{
		m_rates.rate[k] = v + std::size_t( k ) * std::size_t( m_padded );
		m_rates.result[k] = to + std::size_t( k ) * std::size_t( m_padded );
	}
	m_rates.stiffness = stiffness;
	m_rates.volume = volume;
	if ( m_parts->areSeveral() )
	{
		resistByPart( v, to, runner );
		return;
	}
	// In exact arithmetic A v is the same without it. In float a common rotation would be summed, subtracted and multiplied by G.
	measureRigidMotion( m_rates.rate, runner );
	applyRegions( runner );
	if ( !m_isRaised )
	{
		overNodes( m_padded, runner, [&]( int, int begin, int end ) { m_kernels->resist( m_rates, begin, end ); } );
		return;
	}
	overNodes( m_padded, runner, [&]( int, int begin, int end ) { m_kernels->resistPart( m_rates, begin, end ); } );
	measureRigidMotion( m_rates.result, runner );
	overNodes( m_padded, runner, [&]( int, int begin, int end ) { m_kernels->finishResist( m_rates, begin, end ); } );
}

/// Computes the regions' rigid rates, up to the sums that each node gathers.
void StrainRates::applyRegions( TaskRunner* runner )
{
	if ( m_gridHasHoles )
	{
		const std::size_t floats = m_view.volumeGradient[0] ? m_recordFloats : m_recordFloats / kRecordFloats * kRateFloats;
		std::fill( m_view.nodeRecord, m_view.nodeRecord + floats, 0.0f );
		std::fill( m_view.regionRecord, m_view.regionRecord + floats, 0.0f );
	}
	overNodes( m_padded, runner, [&]( int, int begin, int end ) { m_kernels->rateRecords( m_rates, begin, end ); } );
	sumRates( false, runner );
	overNodes( m_padded, runner, [&]( int, int begin, int end ) { m_kernels->rigidRates( m_rates, begin, end ); } );
	sumRates( true, runner );
}

} // namespace pliant
