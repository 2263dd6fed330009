#include "fracture/stretch.h"

#include "fracture/constants.h"
#include "matching/regions/region_moments.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// Symmetric: xx, yy, zz, yz, xz, xy.
struct Symmetric
{
	double xx, yy, zz, yz, xz, xy;

	/// F^T F - 1.
	explicit Symmetric( const Eigen::Matrix3d& f ) :
		xx( f.col( 0 ).squaredNorm() - 1.0 ), yy( f.col( 1 ).squaredNorm() - 1.0 ), zz( f.col( 2 ).squaredNorm() - 1.0 ),
		yz( f.col( 1 ).dot( f.col( 2 ) ) ), xz( f.col( 0 ).dot( f.col( 2 ) ) ), xy( f.col( 0 ).dot( f.col( 1 ) ) )
	{}
	void addToDiagonal( double a )
	{
		xx += a;
		yy += a;
		zz += a;
	}
	double squaredNorm() const { return xx * xx + yy * yy + zz * zz + 2.0 * ( yz * yz + xz * xz + xy * xy ); }
	double determinant() const { return xx * ( yy * zz - yz * yz ) - xy * ( xy * zz - yz * xz ) + xz * ( xy * yz - yy * xz ); }
	Vec3d row( int k ) const { return k == 0 ? Vec3d( xx, xy, xz ) : k == 1 ? Vec3d( xy, yy, yz ) : Vec3d( xz, yz, zz ); }
};

/// Returns a unit vector in the kernel of a singular symmetric matrix: perpendicular to the two rows that determine it best.
Vec3d kernelOf( const Symmetric& matrix )
{
	const Vec3d row[3] = { matrix.row( 0 ), matrix.row( 1 ), matrix.row( 2 ) };
	Vec3d best = Vec3d::Zero(), line = Vec3d::Zero();
	double largestSquare = 0.0, size = 0.0;
	for ( int k = 0; k < 3; ++k )
	{
		const Vec3d normal = row[k].cross( row[( k + 1 ) % 3] );
		if ( normal.squaredNorm() > largestSquare )
		{
			best = normal;
			largestSquare = normal.squaredNorm();
		}
		if ( row[k].squaredNorm() > size )
		{
			line = row[k];
			size = row[k].squaredNorm();
		}
	}
	// If the rows are collinear, all perpendicular directions have the same stretch and the cross products' directions are rounding.
	if ( largestSquare > kEqualStretches * kEqualStretches * size * size )
	{
		return best / std::sqrt( largestSquare );
	}
	return size > 0.0 ? Vec3d( line.unitOrthogonal() ) : Vec3d( Vec3d::UnitX() );
}

} // namespace

// E = F^T F - 1 has the mean m and the deviator S = p B with |B|^2 = 6. The largest eigenvalue of B is 1 + y with
//   y^3 + 3 y^2 = 2 + det B =: s,  0 <= y <= 1.
// y = z sqrt( s / 3 ) yields k z^3 + z^2 = 1 with k = sqrt( s / 27 ) <= 0.39: Newton's method from z = 1 converges monotonically and
// quadratically, to the last bit in four steps.
Stretch largestStretch( const Eigen::Matrix3d& deformation )
{
	Symmetric strain( deformation );
	const double mean = ( strain.xx + strain.yy + strain.zz ) / 3.0;
	strain.addToDiagonal( -mean );
	const double spread = std::sqrt( strain.squaredNorm() / 6.0 );
	Stretch found;
	double largest = mean;
	if ( spread > 0.0 )
	{
		const double s = std::clamp( 2.0 + strain.determinant() / ( spread * spread * spread ), 0.0, 4.0 );
		const double k = std::sqrt( s / 27.0 );
		double z = 1.0;
		for ( int step = 0; step < 4; ++step )
		{
			z -= ( ( k * z + 1.0 ) * z * z - 1.0 ) / ( ( 3.0 * k * z + 2.0 ) * z );
		}
		const double above = spread * ( 1.0 + 3.0 * k * z ); // 3 k = sqrt( s / 3 )
		largest += above;
		strain.addToDiagonal( -above );
		found.axis = kernelOf( strain );
	}
	found.strain = largest / ( std::sqrt( std::max( 0.0, 1.0 + largest ) ) + 1.0 );
	return found;
}

// All eigenvalues of E = F^T F - 1 are below l where the leading minors of l 1 - E are positive (Sylvester). The margin covers rounding.
bool isStretchedLess( const Eigen::Matrix3d& deformation, double strain )
{
	Symmetric e( deformation );
	e.addToDiagonal( kStretchRounding - ( ( 1.0 + strain ) * ( 1.0 + strain ) - 1.0 ) * ( 1.0 - kStretchRounding ) );
	return e.xx < 0.0 && e.xx * e.yy > e.xy * e.xy && e.determinant() < 0.0;
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

void LinkMoments::update( const Lattice& lattice, const CellPositions& positions )
{
	m_lattice = &lattice;
	const std::size_t cells = std::size_t( lattice.cellCount() );
	m_position.resize( cells );
	m_isNode.resize( cells );
	m_slot.clear();
	m_moments.clear();
	for ( std::uint32_t i = 0; i < std::uint32_t( cells ); ++i )
	{
		const Vec3 at = positions.at( i );
		m_position[i] = Eigen::Array4f( at.x(), at.y(), at.z(), 0.0f );
		m_isNode[i] = positions.isNode( i ) ? 1 : 0;
	}
}

void LinkMoments::prepare()
{
	const std::size_t cells = m_position.size();
	m_slot.assign( cells, kNone );
	m_rest.resize( cells );
	for ( std::size_t i = 0; i < cells; ++i )
	{
		const Vec3& rest = m_lattice->restCentre[i];
		m_rest[i] = Eigen::Array4f( rest.x(), rest.y(), rest.z(), 0.0f );
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
	const Eigen::Array4f position = m_position[cell], rest = m_rest[cell];
	for ( std::uint32_t k = m_lattice->linkStart[cell]; k < m_lattice->linkStart[cell + 1] && isNode( cell ); ++k )
	{
		const std::uint32_t j = m_lattice->linkTo[k];
		if ( isNode( j ) )
		{
			const Eigen::Array4f p = m_position[j] - position, q = m_rest[j] - rest;
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
	if ( m_slot.empty() )
	{
		prepare();
	}
	if ( m_slot[cell] == kNone )
	{
		m_slot[cell] = std::uint32_t( m_moments.size() );
		m_moments.push_back( measure( cell ) );
	}
	return m_moments[m_slot[cell]];
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
