// +-----------------------------------------------------------------------------------------------------------------+
// | A piece of material in a testing machine.                                                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/coupon.h"
#include "demos/must_succeed.h"

#include "demos/shapes.h"
#include "demos/study/subject.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace pliant_study {

namespace {

constexpr double kRadian = 3.14159265358979323846 / 180;
constexpr double kStill = 1e-8; // fraction of the largest energy of its oscillation: below it the piece is in equilibrium
constexpr int kStillPeaks = 3;
constexpr double kPastPeak = 0.97; // fraction of the last peak: only a drop below it counts as a fall, and not fast vibrations on top

pliant_glue::ModelMesh boxMesh( const Eigen::Vector3d& edges )
{
	pliant_glue::ModelMesh mesh = pliant_demos::makeCube( 1.0f, 8 );
	for ( std::size_t v = 0; v < mesh.positions.size(); ++v )
	{
		mesh.positions[v] *= float( edges[Eigen::Index( v % 3 )] );
	}
	return mesh;
}

std::shared_ptr<const pliant::BodyTemplate> templateOf( const CouponOrder& order )
{
	pliant_glue::ModelMesh mesh = order.mesh.positions.empty() ? boxMesh( order.cell * order.cells.cast<double>() ) : order.mesh;
	const auto count = Eigen::Index( mesh.vertexCount() );
	Eigen::Map<Eigen::Matrix<float, 3, Eigen::Dynamic>> points( mesh.positions.data(), 3, count );
	const Eigen::Matrix3f turn = Eigen::AngleAxisf( float( order.degrees * kRadian ), Eigen::Vector3f::UnitZ() ).toRotationMatrix();
	points = ( turn * points ).eval();
	pliant::LatticeSettings settings;
	settings.cellSize = float( order.cell );
	settings.skinning = pliant::Skinning::None;
	const auto made = pliant::BodyTemplate::build(
		{ mesh.positions.data(), mesh.vertexCount(), 3, mesh.indices.data(), mesh.triangleCount(), nullptr, nullptr }, settings );
	return made ? made.value : throw std::runtime_error( made.status.sentence );
}

} // namespace

double modulusWithin( const CouponOrder& order, double reach )
{
	const double h = order.gameStep / order.substeps;
	return reach * double( order.material.density ) * order.cell * order.cell * 2 / ( 3 * h * h );
}

Coupon::Coupon( const CouponOrder& order ) : m_order( order )
{
	if ( order.reach > 0 )
	{
		m_order.material.youngsModulus = float( modulusWithin( order, order.reach ) );
	}
	m_world.world().setGravity( btVector3( 0, 0, 0 ) );
	m_world.world().setSoftSubsteps( order.substeps );
	m_body = m_world.add( templateOf( m_order ), btVector3( 0, 0, 0 ), m_order.material, m_order.adaptivity );
	if ( m_body == nullptr )
	{
		throw std::runtime_error( "a testing piece was refused" );
	}
	// Bodies have the orientation of their mesh: rotated back by the angle of the lattice.
	pliant_demos::mustSucceed( m_body->reset( btTransform( btQuaternion( btVector3( 0, 0, 1 ), btScalar( -order.degrees * kRadian ) ) ) ) );
	m_body->setActivationState( DISABLE_DEACTIVATION ); // setting the position again makes it an ordinary body
	for ( int i = 0; i < m_body->nodeCount(); ++i )
	{
		m_rest.push_back( toEigen( m_body->nodePosition( i ) ) );
	}
	clearForces();
}

Eigen::Vector3d Coupon::now( int node ) const
{
	return toEigen( m_body->nodePosition( node ) );
}

std::vector<int> Coupon::nodesIn( const Where& where ) const
{
	std::vector<int> nodes;
	for ( int i = 0; i < count(); ++i )
	{
		if ( where( rest( i ) ) )
		{
			nodes.push_back( i );
		}
	}
	return nodes;
}

int Coupon::hold( const Where& where )
{
	const std::vector<int> nodes = nodesIn( where );
	for ( const int i : nodes )
	{
		pliant_demos::mustSucceed( m_body->pinNode( i ) );
	}
	return int( nodes.size() );
}

void Coupon::drive( const Field& to )
{
	for ( int i = 0; i < count(); ++i )
	{
		if ( m_body->isPinned( i ) )
		{
			pliant_demos::mustSucceed( m_body->driveNode( i, toBullet( to( rest( i ) ) ) ) );
		}
	}
}

void Coupon::clearForces()
{
	m_force.assign( m_rest.size(), Eigen::Vector3d::Zero() );
	m_couples.clear();
}

void Coupon::push( const Field& perMass )
{
	clearForces();
	for ( int i = 0; i < count(); ++i )
	{
		m_force[std::size_t( i )] = mass( i ) * perMass( rest( i ) );
	}
}

void Coupon::pushAt( const Where& where, const Eigen::Vector3d& total )
{
	const std::vector<int> nodes = nodesIn( where );
	double sum = 0;
	for ( const int i : nodes )
	{
		sum += mass( i );
	}
	for ( const int i : nodes )
	{
		m_force[std::size_t( i )] += mass( i ) / sum * total;
	}
}

void Coupon::bend( const Where& where, double moment )
{
	Couple couple{ nodesIn( where ), 0, 0 };
	double sum = 0, second = 0;
	for ( const int i : couple.nodes )
	{
		sum += mass( i );
		couple.middle += mass( i ) * rest( i ).y();
	}
	couple.middle /= sum;
	for ( const int i : couple.nodes )
	{
		second += mass( i ) * std::pow( rest( i ).y() - couple.middle, 2 );
	}
	// f = -k m y along x has a torque about z of k sum m y^2.
	couple.perMass = -moment / second;
	m_couples.push_back( couple );
}

void Coupon::applyForces()
{
	for ( int i = 0; i < count(); ++i )
	{
		if ( !m_force[std::size_t( i )].isZero( 0 ) )
		{
			pliant_demos::mustSucceed( m_body->applyForce( toBullet( m_force[std::size_t( i )] ), i ) );
		}
	}
	for ( const Couple& couple : m_couples )
	{
		// The direction of the section's normal, from the rotation of the section in its plane.
		double c = 0, s = 0;
		Eigen::Vector3d mean = Eigen::Vector3d::Zero();
		for ( const int i : couple.nodes )
		{
			mean += now( i ) / double( couple.nodes.size() );
		}
		for ( const int i : couple.nodes )
		{
			const double y = mass( i ) * ( rest( i ).y() - couple.middle );
			c += y * ( now( i ) - mean ).y();
			s -= y * ( now( i ) - mean ).x();
		}
		const Eigen::Vector3d along = Eigen::Vector3d( c, s, 0 ).normalized();
		for ( const int i : couple.nodes )
		{
			pliant_demos::mustSucceed(
				m_body->applyForce( toBullet( couple.perMass * mass( i ) * ( rest( i ).y() - couple.middle ) * along ), i ) );
		}
	}
}

void Coupon::put( const Field& to )
{
	std::vector<bool> wasHeld;
	for ( int i = 0; i < count(); ++i )
	{
		wasHeld.push_back( m_body->isPinned( i ) );
		pliant_demos::mustSucceed( m_body->driveNode( i, toBullet( to( rest( i ) ) ) ) );
	}
	m_world.world().stepSimulation( btScalar( m_order.gameStep ), 0 );
	for ( int i = 0; i < count(); ++i )
	{
		if ( !wasHeld[std::size_t( i )] )
		{
			m_body->releaseNode( i );
		}
	}
	pliant_demos::mustSucceed( m_body->setLinearVelocity( btVector3( 0, 0, 0 ) ) );
}

void Coupon::step()
{
	applyForces();
	m_world.world().stepSimulation( btScalar( m_order.gameStep ), 0 );
}

double Coupon::driftEnergy() const
{
	// 1/2 ( sum m v . u )^2 / sum m u^2, u the displacement so far: excludes fast vibrations on top of it.
	double along = 0, own = 0;
	for ( int i = 0; i < count(); ++i )
	{
		along += mass( i ) * toEigen( m_body->nodeVelocity( i ) ).dot( moved( i ) );
		own += mass( i ) * moved( i ).squaredNorm();
	}
	return own > 0 ? 0.5 * along * along / own : 0;
}

bool Coupon::settle( int most )
{
	double peak = 0, largest = 0;
	int still = 0;
	for ( int k = 0; k < most && isHealthy(); ++k )
	{
		step();
		const double energy = driftEnergy();
		largest = std::max( largest, energy );
		peak = std::max( peak, energy );
		if ( energy < kPastPeak * peak )
		{
			still = peak < kStill * largest ? still + 1 : 0;
			if ( still == kStillPeaks )
			{
				return true;
			}
			pliant_demos::mustSucceed( m_body->setLinearVelocity( btVector3( 0, 0, 0 ) ) );
			peak = 0;
		}
	}
	return false;
}

Eigen::Vector3d Coupon::meanMoved( const Where& where ) const
{
	Eigen::Vector3d sum = Eigen::Vector3d::Zero();
	double all = 0;
	for ( const int i : nodesIn( where ) )
	{
		sum += mass( i ) * moved( i );
		all += mass( i );
	}
	return sum / all;
}

Eigen::Vector3d Coupon::meanRest( const Where& where ) const
{
	Eigen::Vector3d sum = Eigen::Vector3d::Zero();
	double all = 0;
	for ( const int i : nodesIn( where ) )
	{
		sum += mass( i ) * rest( i );
		all += mass( i );
	}
	return sum / all;
}

Eigen::Matrix3d Coupon::deformation( const Where& where ) const
{
	const Eigen::Vector3d from = meanRest( where ), to = from + meanMoved( where );
	Eigen::Matrix3d across = Eigen::Matrix3d::Zero(), own = Eigen::Matrix3d::Zero();
	for ( const int i : nodesIn( where ) )
	{
		across += mass( i ) * ( now( i ) - to ) * ( rest( i ) - from ).transpose();
		own += mass( i ) * ( rest( i ) - from ) * ( rest( i ) - from ).transpose();
	}
	return across * own.inverse();
}

double Coupon::along( const Field& shape ) const
{
	double sum = 0, own = 0;
	for ( int i = 0; i < count(); ++i )
	{
		const Eigen::Vector3d at = shape( rest( i ) );
		sum += mass( i ) * at.dot( moved( i ) );
		own += mass( i ) * at.squaredNorm();
	}
	return sum / own;
}

double Coupon::misfit() const
{
	const Where all = []( const Eigen::Vector3d& ) { return true; };
	const Eigen::Vector3d from = meanRest( all ), to = from + meanMoved( all );
	Eigen::Matrix3d across = Eigen::Matrix3d::Zero();
	for ( int i = 0; i < count(); ++i )
	{
		across += mass( i ) * ( now( i ) - to ) * ( rest( i ) - from ).transpose();
	}
	const Eigen::JacobiSVD<Eigen::Matrix3d> svd( across, Eigen::ComputeFullU | Eigen::ComputeFullV );
	const double side = ( svd.matrixU() * svd.matrixV().transpose() ).determinant();
	const Eigen::Matrix3d turn = svd.matrixU() * Eigen::Vector3d( 1, 1, side ).asDiagonal() * svd.matrixV().transpose();
	double most = 0;
	for ( int i = 0; i < count(); ++i )
	{
		most = std::max( most, ( now( i ) - to - turn * ( rest( i ) - from ) ).norm() );
	}
	return most;
}

double Coupon::invertedFraction() const
{
	const double d = m_order.cell;
	int inverted = 0, looked = 0;
	for ( int i = 0; i < count(); ++i )
	{
		std::array<int, 3> near{ -1, -1, -1 };
		for ( int j = 0; j < count(); ++j )
		{
			const Eigen::Vector3d edge = rest( j ) - rest( i );
			Eigen::Index axis = 0;
			if ( edge.norm() < 1.1 * d && edge.maxCoeff( &axis ) > 0.9 * d )
			{
				near[std::size_t( axis )] = j;
			}
		}
		if ( *std::min_element( near.begin(), near.end() ) >= 0 )
		{
			Eigen::Matrix3d edges;
			edges << now( near[0] ) - now( i ), now( near[1] ) - now( i ), now( near[2] ) - now( i );
			inverted += edges.determinant() <= 0 ? 1 : 0;
			++looked;
		}
	}
	return looked > 0 ? double( inverted ) / looked : 0;
}

} // namespace pliant_study
