#include "fracture/stretch.h"

#include "fracture/constants.h"
#include "matching/region_moments.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// A unit vector that a singular symmetric matrix takes to nothing: at right angles to its rows, by the two that tell it best.
Vec3d kernelOf( const Eigen::Matrix3d& matrix )
{
	Vec3d best = Vec3d::Zero(), line = Vec3d::Zero();
	for ( int k = 0; k < 3; ++k )
	{
		const Vec3d row = matrix.row( k ), normal = row.cross( Vec3d( matrix.row( ( k + 1 ) % 3 ) ) );
		best = normal.squaredNorm() > best.squaredNorm() ? normal : best;
		line = row.squaredNorm() > line.squaredNorm() ? row : line;
	}
	// Rows along one line: whatever lies across it is stretched alike, and which way the crosses point is rounding.
	const double size = line.squaredNorm();
	if ( best.squaredNorm() > kAlikeStretches * kAlikeStretches * size * size )
	{
		return best.normalized();
	}
	return size > 0.0 ? Vec3d( line.unitOrthogonal() ) : Vec3d( Vec3d::UnitX() );
}

} // namespace

// E = F^T F - 1 has the mean m and, about it, S = p B with |B|^2 = 6. The largest eigenvalue of B is 1 + y with
//   y^3 + 3 y^2 = 2 + det B =: s,  0 <= y <= 1.
// y = z sqrt( s / 3 ) leaves k z^3 + z^2 = 1 with k = sqrt( s / 27 ) <= 0.39: Newton's steps from z = 1 come down to it quadratically, four of them
// to the last bit.
Stretch largestStretch( const Eigen::Matrix3d& deformation )
{
	Eigen::Matrix3d strain = deformation.transpose() * deformation - Eigen::Matrix3d::Identity();
	const double mean = strain.trace() / 3.0;
	strain.diagonal().array() -= mean;
	const double spread = std::sqrt( strain.squaredNorm() / 6.0 );
	Stretch found;
	double largest = mean;
	if ( spread > 0.0 )
	{
		Eigen::Matrix3d shape = strain / spread;
		const double s = std::clamp( 2.0 + shape.determinant(), 0.0, 4.0 );
		const double k = std::sqrt( s / 27.0 );
		double z = 1.0;
		for ( int step = 0; step < 4; ++step )
		{
			z -= ( ( k * z + 1.0 ) * z * z - 1.0 ) / ( ( 3.0 * k * z + 2.0 ) * z );
		}
		const double root = 1.0 + z * std::sqrt( s / 3.0 );
		largest += spread * root;
		shape.diagonal().array() -= root;
		found.axis = kernelOf( shape );
	}
	found.strain = largest / ( std::sqrt( std::max( 0.0, 1.0 + largest ) ) + 1.0 );
	return found;
}

Eigen::Matrix3d inverseOfRest( const Eigen::Matrix3d& moment )
{
	// det / ( tr / 3 )^3 <= 27 c / a with c the smallest and a the largest eigenvalue, as in markFlatRegions.
	const double third = moment.trace() / 3.0, determinant = moment.determinant();
	if ( determinant > 27.0 * kFlatNeighbourhood * third * third * third )
	{
		return moment.inverse();
	}
	Eigen::Matrix3d outside;
	return inverseInPlane( moment, kFlatNeighbourhood, outside );
}

Eigen::Matrix3d LinkMoments::Moment::deformation() const
{
	Eigen::Matrix3d p, q;
	for ( int row = 0; row < 3; ++row )
	{
		p.row( row ) = now[row].head<3>().cast<double>().matrix().transpose();
		q.row( row ) = rest[row].head<3>().cast<double>().matrix().transpose();
	}
	return p * inverseOfRest( q );
}

void LinkMoments::look( const Lattice& lattice, const CellPlaces& places )
{
	m_lattice = &lattice;
	const std::size_t cells = std::size_t( lattice.cellCount() );
	m_place.resize( cells );
	m_rest.resize( cells );
	m_has.resize( cells );
	m_slot.assign( cells, kNone );
	m_made.clear();
	for ( std::uint32_t i = 0; i < std::uint32_t( cells ); ++i )
	{
		const Vec3 at = places.at( i );
		const Vec3& rest = lattice.restCentre[i];
		m_place[i] = Eigen::Array4f( at.x(), at.y(), at.z(), 0.0f );
		m_rest[i] = Eigen::Array4f( rest.x(), rest.y(), rest.z(), 0.0f );
		m_has[i] = places.has( i ) ? 1 : 0;
	}
}

LinkMoments::Moment LinkMoments::measure( std::uint32_t cell ) const
{
	Moment sum;
	for ( int row = 0; row < 3; ++row )
	{
		sum.now[row].setZero();
		sum.rest[row].setZero();
	}
	const Eigen::Array4f place = m_place[cell], rest = m_rest[cell];
	for ( std::uint32_t k = m_lattice->linkStart[cell]; k < m_lattice->linkStart[cell + 1] && has( cell ); ++k )
	{
		const std::uint32_t j = m_lattice->linkTo[k];
		if ( has( j ) )
		{
			const Eigen::Array4f p = m_place[j] - place, q = m_rest[j] - rest;
			for ( int row = 0; row < 3; ++row )
			{
				sum.now[row] += p[row] * q;
				sum.rest[row] += q[row] * q;
			}
		}
	}
	return sum;
}

const LinkMoments::Moment& LinkMoments::of( std::uint32_t cell )
{
	if ( m_slot[cell] == kNone )
	{
		m_slot[cell] = std::uint32_t( m_made.size() );
		m_made.push_back( measure( cell ) );
	}
	return m_made[m_slot[cell]];
}

LinkMoments::Moment LinkMoments::around( std::uint32_t cell )
{
	Moment sum = of( cell );
	for ( std::uint32_t k = m_lattice->linkStart[cell]; k < m_lattice->linkStart[cell + 1]; ++k )
	{
		const Moment& more = of( m_lattice->linkTo[k] );
		for ( int row = 0; row < 3; ++row )
		{
			sum.now[row] += more.now[row];
			sum.rest[row] += more.rest[row];
		}
	}
	return sum;
}

} // namespace pliant
