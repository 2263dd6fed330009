#include "matching/clusters/cluster_matcher.h"

#include "matching/constants.h"
#include "matching/raised_inverse.h"
#include "matching/regions/region_moments.h"
#include "matching/rotation.h"
#include "threads/parallel.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

int chunkCount( int nodes )
{
	return ( nodes + kMembersPerTask - 1 ) / kMembersPerTask;
}

} // namespace

ClusterMatcher::ClusterMatcher( ClusterSet clusters, const Material& material, const NodeState& nodes ) :
	m_clusters( std::move( clusters ) ), m_mode( material.clusterMode ),
	m_beta( material.clusterMode == ClusterMode::Rigid ? 0.0 : material.beta ), m_rotationFromF( material.rotationFrom == RotationFrom::F ),
	m_isConserving( material.weights == Weights::Conserving ), m_weight( nodes.count ), m_cluster( m_clusters.count() ),
	m_residual( nodes.count, Vec3d::Zero() ), m_change( nodes.count, Vec3d::Zero() ), m_impulseSum( chunkCount( nodes.count ) ),
	m_bodySum( chunkCount( nodes.count ) )
{
	if ( m_mode == ClusterMode::Quadratic && m_beta > 0.0 )
	{
		m_quadratic.resize( m_clusters.count() );
	}
	for ( int i = 0; i < nodes.count; ++i )
	{
		// Departs from Müller et al.: a node's mass is divided among its clusters; otherwise the clusters' forces would not cancel.
		m_weight[i] = nodes.mass[i] / ( m_isConserving ? double( m_clusters.coverCount( i ) ) : 1.0 );
	}
	m_pieceStart.assign( 1, 0 );
	for ( int r = 0; r < m_clusters.count(); ++r )
	{
		measureRest( r, nodes );
		for ( std::uint32_t k = m_clusters.start[r]; k < m_clusters.start[r + 1]; k += kMembersPerTask )
		{
			m_pieces.push_back( Piece{ r, k, std::min( k + kMembersPerTask, m_clusters.start[r + 1] ) } );
		}
		m_pieceStart.push_back( std::uint32_t( m_pieces.size() ) );
	}
	m_pieceSum.resize( m_pieces.size() );
}

void ClusterMatcher::measureRest( int cluster, const NodeState& nodes )
{
	Cluster& c = m_cluster[cluster];
	const std::uint32_t first = m_clusters.start[cluster], last = m_clusters.start[cluster + 1];
	double mass = 0.0;
	Vec3d sum = Vec3d::Zero();
	for ( std::uint32_t k = first; k < last; ++k )
	{
		const std::uint32_t i = m_clusters.member[k];
		mass += m_weight[i];
		sum += m_weight[i] * nodes.x0.get( i ).cast<double>();
	}
	c.inverseMass = 1.0 / mass;
	c.restCentre = sum / mass;

	Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
	for ( std::uint32_t k = first; k < last; ++k )
	{
		const std::uint32_t i = m_clusters.member[k];
		const Vec3d q = nodes.x0.get( i ).cast<double>() - c.restCentre;
		moment += m_weight[i] * c.inverseMass * q * q.transpose();
	}
	// A cluster of one node has no extent, and no lengths to scale.
	c.size = moment.trace() > 0.0 ? std::sqrt( moment.trace() ) : 1.0;
	c.moment = moment / ( c.size * c.size );
	c.inverseMoment = flooredInverse( c.moment, kMomentFloor );
	if ( isQuadratic() )
	{
		measureQuadraticRest( cluster, nodes );
	}
}

void ClusterMatcher::measureQuadraticRest( int cluster, const NodeState& nodes )
{
	// Departs from Müller et al.: the quadratic terms are taken about their mean. The goals' mean is then the cluster's centre for any fit,
	// and linear momentum is conserved.
	Quadratic& quadratic = m_quadratic[cluster];
	const double inverseMass = m_cluster[cluster].inverseMass;
	const std::uint32_t first = m_clusters.start[cluster], last = m_clusters.start[cluster + 1];
	Terms mean = Terms::Zero();
	for ( std::uint32_t k = first; k < last; ++k )
	{
		const std::uint32_t i = m_clusters.member[k];
		mean += m_weight[i] * inverseMass * terms( cluster, nodes.x0.get( i ).cast<double>() );
	}
	mean.head<3>().setZero();
	quadratic.mean = mean;

	TermMoment moment = TermMoment::Zero();
	for ( std::uint32_t k = first; k < last; ++k )
	{
		const std::uint32_t i = m_clusters.member[k];
		const Terms q = terms( cluster, nodes.x0.get( i ).cast<double>() );
		moment += m_weight[i] * inverseMass * q * q.transpose();
	}
	quadratic.moment = moment.topRows<3>();
	quadratic.inverseMoment = raisedInverse( moment, kMomentFloor );
}

ClusterMatcher::Terms ClusterMatcher::terms( int cluster, const Vec3d& rest ) const
{
	const Vec3d q = ( rest - m_cluster[cluster].restCentre ) / m_cluster[cluster].size;
	Terms t;
	t << q.x(), q.y(), q.z(), q.x() * q.x(), q.y() * q.y(), q.z() * q.z(), q.x() * q.y(), q.y() * q.z(), q.z() * q.x();
	return t - m_quadratic[cluster].mean;
}

void ClusterMatcher::reset( const NodeState&, const Eigen::Quaterniond& rotation )
{
	m_frame = rotation;
	for ( Cluster& cluster : m_cluster )
	{
		cluster.rotation = rotation;
	}
	std::fill( m_residual.begin(), m_residual.end(), Vec3d::Zero() );
}

void ClusterMatcher::turn( const Eigen::Quaterniond& by )
{
	m_frame = ( by * m_frame ).normalized();
	for ( Cluster& cluster : m_cluster )
	{
		cluster.rotation = ( by * cluster.rotation ).normalized();
	}
}

void ClusterMatcher::measureBody( const NodeState& nodes, TaskRunner* runner )
{
	auto task = [&]( int chunk ) {
		BodySum sum;
		for ( int i = chunk * kMembersPerTask; i < std::min( nodes.count, ( chunk + 1 ) * kMembersPerTask ); ++i )
		{
			const double m = nodes.mass[i];
			const Vec3d x = nodes.x.get( i ).cast<double>(), x0 = nodes.x0.get( i ).cast<double>();
			sum.mass += m;
			sum.first += m * x;
			sum.rest += m * x0;
			sum.moment += m * x * x0.transpose();
		}
		m_bodySum[chunk] = sum;
	};
	runTasks( runner, int( m_bodySum.size() ), task );

	BodySum whole;
	for ( const BodySum& sum : m_bodySum )
	{
		whole.mass += sum.mass;
		whole.first += sum.first;
		whole.rest += sum.rest;
		whole.moment += sum.moment;
	}
	m_mass = whole.mass;
	m_centre = whole.first / whole.mass;
	m_restCentre = whole.rest / whole.mass;
	m_frame = fitRotation( whole.moment - m_centre * whole.rest.transpose(), m_frame );
}

void ClusterMatcher::sumPiece( const NodeState& nodes, int piece )
{
	const Piece& range = m_pieces[piece];
	const Cluster& cluster = m_cluster[range.cluster];
	PieceSum sum;
	for ( std::uint32_t k = range.first; k < range.last; ++k )
	{
		const std::uint32_t i = m_clusters.member[k];
		const Vec3d x = nodes.x.get( i ).cast<double>() - m_centre, x0 = nodes.x0.get( i ).cast<double>();
		sum.position += m_weight[i] * x;
		if ( isQuadratic() )
		{
			sum.moment += ( m_weight[i] * x ) * terms( range.cluster, x0 ).transpose();
		}
		else
		{
			sum.moment.leftCols<3>() += ( m_weight[i] / cluster.size * x ) * ( x0 - cluster.restCentre ).transpose();
		}
	}
	m_pieceSum[piece] = sum;
}

void ClusterMatcher::gather( const NodeState& nodes, TaskRunner* runner )
{
	auto sumUp = [&]( int piece ) { sumPiece( nodes, piece ); };
	runTasks( runner, int( m_pieces.size() ), sumUp );
	auto fitOne = [&]( int cluster ) { fit( cluster ); };
	runTasks( runner, m_clusters.count(), fitOne );
}

void ClusterMatcher::fit( int cluster )
{
	// A_pq = sum a ( x - c )( x0 - c0 )^T. The terms' mean is zero, so that c need not be subtracted from x   (Müller et al. 2005, eq. 7)
	Cluster& c = m_cluster[cluster];
	PieceSum sum;
	for ( std::uint32_t k = m_pieceStart[cluster]; k < m_pieceStart[cluster + 1]; ++k )
	{
		sum.position += m_pieceSum[k].position;
		sum.moment += m_pieceSum[k].moment;
	}
	c.centre = m_centre + sum.position * c.inverseMass;
	const TermMap apq = sum.moment * ( c.inverseMass / c.size );
	fitLinear( c, apq.leftCols<3>() );
	if ( isQuadratic() )
	{
		fitQuadratic( c, m_quadratic[cluster], apq );
	}
}

void ClusterMatcher::fitLinear( Cluster& cluster, const Eigen::Matrix3d& apq ) const
{
	cluster.rotation = fitRotation( m_rotationFromF ? Eigen::Matrix3d( apq * cluster.inverseMoment ) : apq, cluster.rotation );
	const Eigen::Matrix3d rotation = cluster.rotation.toRotationMatrix();
	cluster.linear = rotation;
	if ( m_mode != ClusterMode::Linear || m_beta == 0.0 )
	{
		return;
	}
	// A = A_pq A_qq, written as the difference from R: where the pseudo-inverse has no information (flat, thin), A is R and not zero.
	Eigen::Matrix3d a = rotation + ( apq - rotation * cluster.moment ) * cluster.inverseMoment;

	// A / cbrt( det A ) keeps the volume   (Müller et al. 2005, section 4.2). A flat or inverted A is not scaled up: it would not recover.
	const double volume = a.determinant();
	if ( volume > 0.0 )
	{
		a *= std::min( kLargestVolumeScale, 1.0 / std::cbrt( volume ) );
	}
	cluster.linear += m_beta * ( a - rotation ); // beta A + ( 1 - beta ) R
}

void ClusterMatcher::fitQuadratic( Cluster& cluster, Quadratic& quadratic, const TermMap& apq ) const
{
	// A~ = A~_pq A~_qq;  goal = beta A~ q~ + ( 1 - beta ) R q   (Müller et al. 2005, section 4.3), again as the difference from R.
	const Eigen::Matrix3d rotation = cluster.rotation.toRotationMatrix();
	const TermMap difference = ( apq - rotation * quadratic.moment ) * quadratic.inverseMoment;
	cluster.linear = rotation + m_beta * difference.leftCols<3>();
	quadratic.map = m_beta * difference.rightCols<kTerms - 3>();
}

Vec3d ClusterMatcher::goal( int node, const Vec3d& rest ) const
{
	// The mean over the clusters that contain the node   (Müller et al. 2005, section 4.4)
	Vec3d sum = Vec3d::Zero();
	for ( std::uint32_t k = m_clusters.coverStart[node]; k < m_clusters.coverStart[node + 1]; ++k )
	{
		const int r = int( m_clusters.cover[k] );
		const Cluster& c = m_cluster[r];
		sum += c.centre + c.linear * ( rest - c.restCentre );
		if ( isQuadratic() )
		{
			sum += c.size * ( m_quadratic[r].map * terms( r, rest ).tail<kTerms - 3>() );
		}
	}
	return sum / m_clusters.coverCount( node );
}

ClusterMatcher::ImpulseSum ClusterMatcher::findChanges( const NodeState& nodes, const MatchStep& step, int first, int last )
{
	const double k = 1.0 - std::exp( -double( step.damping ) * step.h );
	const double fraction = step.bodyFraction;
	const Eigen::Matrix3d frame = m_frame.toRotationMatrix();
	ImpulseSum sum;
	for ( int i = first; i < last; ++i )
	{
		const Vec3d x = nodes.x.get( i ).cast<double>(), rest = nodes.x0.get( i ).cast<double>(), v = nodes.v.get( i ).cast<double>();
		const Vec3d residual = goal( i, rest ) - x; // e
		const Vec3d toBody = m_centre + frame * ( rest - m_restCentre ) - x;
		const Vec3d turned = frame * m_residual[i];

		// v += ( alpha e + k ( e - e_before ) ) / h
		m_change[i] = ( ( 1.0 - fraction ) * step.alpha * residual + fraction * toBody + k * ( residual - turned ) ) / step.h;
		m_residual[i] = frame.transpose() * residual;

		const double m = nodes.mass[i];
		const Vec3d arm = x - m_centre;
		sum.impulse += m * m_change[i];
		sum.turn += m * arm.cross( m_change[i] );
		sum.momentum += m * v;
		sum.spin += m * arm.cross( v );
		sum.second += m * arm * arm.transpose();
	}
	return sum;
}

ClusterMatcher::ImpulseSum ClusterMatcher::foldImpulses() const
{
	ImpulseSum whole;
	for ( const ImpulseSum& sum : m_impulseSum )
	{
		whole.impulse += sum.impulse;
		whole.turn += sum.turn;
		whole.momentum += sum.momentum;
		whole.spin += sum.spin;
		whole.second += sum.second;
	}
	return whole;
}

// The motion subtracted from the velocity change: the rigid part of the internal impulses, which should be zero (damping, volume scaling
// and floored inverses leave some); and the part of the wobble damping -k v that would brake the body as a whole.
ClusterMatcher::Motion ClusterMatcher::unwantedMotion( double wobbleFraction ) const
{
	const ImpulseSum sum = foldImpulses();
	const Eigen::Matrix3d inertia = sum.second.trace() * Eigen::Matrix3d::Identity() - sum.second;
	const Eigen::Matrix3d inverseInertia = flooredInverse( inertia, kInertiaFloor );
	Motion motion;
	if ( m_isConserving && !m_rotationFromF )
	{
		motion = Motion{ sum.impulse / m_mass, inverseInertia * sum.turn };
	}
	motion.shift -= wobbleFraction * sum.momentum / m_mass;
	motion.turn -= wobbleFraction * ( inverseInertia * sum.spin );
	return motion;
}

void ClusterMatcher::accelerate( NodeState& nodes, const MatchStep& step, TaskRunner* runner )
{
	measureBody( nodes, runner );
	gather( nodes, runner );
	const int chunks = chunkCount( nodes.count );
	auto find = [&]( int chunk ) {
		m_impulseSum[chunk] = findChanges( nodes, step, chunk * kMembersPerTask, std::min( nodes.count, ( chunk + 1 ) * kMembersPerTask ) );
	};
	runTasks( runner, chunks, find );

	const double wobbleFraction = step.wobbleFraction( double( step.wobbleDamping ) );
	const Motion unwanted = unwantedMotion( wobbleFraction );
	auto apply = [&]( int chunk ) {
		for ( int i = chunk * kMembersPerTask; i < std::min( nodes.count, ( chunk + 1 ) * kMembersPerTask ); ++i )
		{
			if ( nodes.freedom[i] != 0.0f )
			{
				const Vec3d v = nodes.v.get( i ).cast<double>(), arm = nodes.x.get( i ).cast<double>() - m_centre;
				nodes.v.set( i, ( v + m_change[i] - wobbleFraction * v - unwanted.at( arm ) ).cast<float>() );
			}
		}
	};
	runTasks( runner, chunks, apply );
}

void ClusterMatcher::nodeRotations( const NodeState& nodes, float* quaternions ) const
{
	for ( int i = 0; i < nodes.count; ++i )
	{
		// The mean over the node's clusters, as for its goal; q and -q are the same rotation, so signs follow the first one.
		const std::uint32_t first = m_clusters.coverStart[i];
		const Eigen::Vector4d lead = m_cluster[m_clusters.cover[first]].rotation.coeffs();
		Eigen::Vector4d sum = lead;
		for ( std::uint32_t k = first + 1; k < m_clusters.coverStart[i + 1]; ++k )
		{
			const Eigen::Vector4d q = m_cluster[m_clusters.cover[k]].rotation.coeffs();
			sum += q.dot( lead ) < 0.0 ? Eigen::Vector4d( -q ) : q;
		}
		Eigen::Map<Eigen::Vector4f>( quaternions + 4 * i ) = sum.normalized().cast<float>();
	}
}

std::unique_ptr<Matcher> makeClusterMatcher( const Lattice& lattice, const Material& material, const NodeState& nodes )
{
	ClusterSet clusters = material.method == Method::SingleCluster ? makeWholeCluster( lattice )
																   : makeBoxClusters( lattice, material.clusterEdge );
	return std::make_unique<ClusterMatcher>( std::move( clusters ), material, nodes );
}

} // namespace pliant
