// The response of a frame's patch to impulses (frames.h).

#include "matching/implicit/conjugate_gradients.h"
#include "world/bodies/frame_patch.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <limits>
#include <vector>

namespace pliant {

namespace {

/// The frame's velocity, B^T v, of a field v( node ).
template <class Velocity>
Vector6 velocityOf( const Frame& frame, const Eigen::Matrix3d& inverseInertia, const Velocity& velocity )
{
	const NodeState& nodes = frame.body->impl().body->nodes();
	Vec3d momentum = Vec3d::Zero(), spin = Vec3d::Zero();
	for ( const Frame::Node& part : frame.patch )
	{
		const Vec3d own = double( nodes.mass[part.node] ) * velocity( part.node );
		momentum += own;
		spin += ( nodes.worldPosition( part.node ) - frame.at - frame.mean ).cross( own );
	}
	Vector6 fit;
	fit.tail<3>() = inverseInertia * spin;
	fit.head<3>() = momentum / frame.mass - fit.tail<3>().cross( frame.mean );
	return fit;
}

void set( float* values, std::size_t padded, int node, const Vec3d& to )
{
	float* const x = values + node;
	x[0] = float( to.x() );
	x[padded] = float( to.y() );
	x[2 * padded] = float( to.z() );
}

double energyOf( const NodeState& nodes, const float* velocity )
{
	double sum = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		sum += double( nodes.mass[i] ) * nodeVector( velocity, nodes.padded, i ).squaredNorm();
	}
	return sum;
}

/// Removes the rigid motions of the free parts from velocities, and sets them to zero where only rounding is left.
void removeRigid( const ImplicitMotion& motion, const NodeState& nodes, const float* noImpulse, AlignedArray<float>& velocity )
{
	const double before = energyOf( nodes, velocity.data() );
	motion.giveMomentum( noImpulse, velocity.data() );
	motion.giveMomentum( noImpulse, velocity.data() );
	if ( energyOf( nodes, velocity.data() ) <= kLeastElastic * before )
	{
		std::fill( velocity.begin(), velocity.end(), 0.0f );
	}
}

/// Impulses on the nodes by a unit impulse, or angular impulse, on a frame.
AlignedArray<float> unitImpulse( const Frame& frame, int component )
{
	const NodeState& nodes = frame.body->impl().body->nodes();
	const Eigen::Matrix3d inverseInertia = frame.inertia.inverse();
	AlignedArray<float> impulse( std::size_t( 3 * nodes.padded ) );
	for ( const Frame::Node& part : frame.patch )
	{
		const Vec3d arm = nodes.worldPosition( part.node ) - frame.at;
		set( impulse.data(), std::size_t( nodes.padded ), part.node,
			double( nodes.mass[part.node] * nodes.freedom[part.node] ) *
				velocityChange( frame, inverseInertia, Vector6::Unit( component ), arm ) );
	}
	return impulse;
}

/// G^+ H for a symmetric positive semidefinite matrix whose rows may depend on one another.
Eigen::MatrixXd solveScaled( const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right )
{
	const Eigen::VectorXd diagonal = matrix.diagonal();
	const Eigen::VectorXd scale = ( diagonal.array() > 0.0 )
									  .select( diagonal.array().max( std::numeric_limits<double>::min() ).rsqrt(), 0.0 );
	const Eigen::MatrixXd scaled = scale.asDiagonal() * ( 0.5 * ( matrix + matrix.transpose() ) ) * scale.asDiagonal();
	const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver( scaled );
	const Eigen::VectorXd values = solver.eigenvalues();
	const Eigen::VectorXd inverse = ( values.array() > kLeastResponse ).select( values.array().max( kLeastResponse ).inverse(), 0.0 );
	return scale.asDiagonal() *
		( solver.eigenvectors() * ( inverse.asDiagonal() * ( solver.eigenvectors().transpose() * ( scale.asDiagonal() * right ) ) ) );
}

/// Adds the response of an implicit body.
void addResponse( Frame& frame, const Vector6& impulse )
{
	NodeState& nodes = nodesOf( *frame.body );
	const std::size_t padded = std::size_t( nodes.padded );
	for ( int i = 0; i < nodes.count; ++i )
	{
		Vec3d change = Vec3d::Zero();
		for ( std::size_t k = 0; k < 6; ++k )
		{
			change += impulse[int( k )] * nodeVector( frame.response.data() + 3 * padded * k, nodes.padded, i );
		}
		nodes.v.set( i, nodes.v.get( i ) + change.cast<float>() );
	}
}

} // namespace

Vec3d velocityChange( const Frame& frame, const Eigen::Matrix3d& inverseInertia, const Vector6& impulse, const Vec3d& arm )
{
	const Vec3d turn = inverseInertia * ( impulse.tail<3>() - frame.mean.cross( impulse.head<3>() ) );
	return impulse.head<3>() / frame.mass + turn.cross( arm - frame.mean );
}

Matrix6 freeMobility( const Frame& frame )
{
	const Eigen::Matrix3d inverseInertia = frame.inertia.inverse();
	Matrix6 mobility;
	const Eigen::Matrix3d arm = crossMatrix( frame.mean );
	mobility.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / frame.mass - arm * inverseInertia * arm;
	mobility.topRightCorner<3, 3>() = arm * inverseInertia;
	mobility.bottomLeftCorner<3, 3>() = mobility.topRightCorner<3, 3>().transpose();
	mobility.bottomRightCorner<3, 3>() = inverseInertia;
	return mobility;
}

// The solver's iteration is truncated, and velocities A^-1 b with a residual r do work on those that the body has: v . r. Where sound
// crosses the body many times in a step they shake it to pieces. So the responses are
//
//   x = R b + E ( E^T A E )^+ E^T b
//
// with R b the rigid motion of b's momentum, and E the truncated solutions and the body's own velocities, all without their rigid motions:
// the residual is orthogonal to everything in E.
void measureResponses( const std::vector<Frame*>& frames, const Frames::Response& response, TaskRunner* runner )
{
	Body& body = *frames.front()->body->impl().body;
	ImplicitMotion& motion = *body.implicit();
	const NodeState& nodes = body.nodes();
	const std::size_t padded = std::size_t( nodes.padded ), size = 3 * padded;
	std::vector<AlignedArray<float>> impulses, rigid, elastic( 1, AlignedArray<float>( size ) );
	const AlignedArray<float> none( size );
	for ( int i = 0; i < nodes.count; ++i )
	{
		set( elastic[0].data(), padded, i, ( nodes.freedom[i] * nodes.v.get( i ) ).cast<double>() );
	}
	for ( const Frame* const frame : frames )
	{
		for ( int k = 0; k < 6; ++k )
		{
			impulses.push_back( unitImpulse( *frame, k ) );
			rigid.emplace_back( size );
			motion.giveMomentum( impulses.back().data(), rigid.back().data() );
			motion.giveMomentum( impulses.back().data(), rigid.back().data() ); // the inertia has a floor
			elastic.push_back( rigid.back() );
			response( impulses.back().data(), elastic.back().data() );
		}
	}
	const Eigen::Index count = Eigen::Index( elastic.size() ), unit = Eigen::Index( impulses.size() );
	Eigen::MatrixXd stiffness( count, count ), work( count, unit );
	AlignedArray<float> product( size );
	for ( AlignedArray<float>& each : elastic )
	{
		removeRigid( motion, nodes, none.data(), each );
	}
	for ( Eigen::Index j = 0; j < count; ++j )
	{
		const float* const own = elastic[std::size_t( j )].data();
		motion.apply( own, product.data(), runner );
		for ( Eigen::Index i = 0; i < count; ++i )
		{
			stiffness( i, j ) = dot( elastic[std::size_t( i )].data(), product.data(), int( size ) );
		}
		for ( Eigen::Index k = 0; k < unit; ++k )
		{
			work( j, k ) = dot( own, impulses[std::size_t( k )].data(), int( size ) );
		}
	}
	const Eigen::MatrixXd shares = solveScaled( stiffness, work );
	for ( std::size_t k = 0; k < impulses.size(); ++k )
	{
		std::vector<float>& to = frames[k / 6]->response;
		to.resize( 6 * size );
		for ( std::size_t i = 0; i < size; ++i )
		{
			double sum = double( rigid[k][i] );
			for ( std::size_t j = 0; j < elastic.size(); ++j )
			{
				sum += shares( Eigen::Index( j ), Eigen::Index( k ) ) * double( elastic[j][i] );
			}
			to[k % 6 * size + i] = float( sum );
		}
	}
}

void applyImpulse( Frame& frame, const Vector6& impulse )
{
	const Eigen::Matrix3d inverseInertia = frame.inertia.inverse();
	if ( frame.body->impl().isImplicit )
	{
		addResponse( frame, impulse );
		return;
	}
	NodeState& nodes = nodesOf( *frame.body );
	for ( const Frame::Node& part : frame.patch )
	{
		const Vec3d own = velocityChange( frame, inverseInertia, impulse, nodes.worldPosition( part.node ) - frame.at );
		nodes.v.set( part.node, nodes.v.get( part.node ) + nodes.freedom[part.node] * own.cast<float>() );
	}
}

Vector6 velocityOfPatch( const Frame& frame )
{
	const NodeState& nodes = nodesOf( *frame.body );
	return velocityOf( frame, frame.inertia.inverse(), [&]( int node ) { return Vec3d( nodes.v.get( node ).cast<double>() ); } );
}

Matrix6 mobilityBetween( const Frame& frame, const Frame& other )
{
	if ( !frame.body->impl().isImplicit )
	{
		return &frame == &other ? freeMobility( frame ) : Matrix6::Zero();
	}
	Matrix6 between;
	const int padded = nodesOf( *frame.body ).padded;
	const Eigen::Matrix3d inverseInertia = frame.inertia.inverse();
	for ( int k = 0; k < 6; ++k )
	{
		const float* const column = other.response.data() + std::size_t( 3 * padded * k );
		between.col( k ) = velocityOf( frame, inverseInertia, [&]( int node ) { return nodeVector( column, padded, node ); } );
	}
	return between;
}

} // namespace pliant
