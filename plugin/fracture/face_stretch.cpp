#include "fracture/face_stretch.h"

#include "fracture/constants.h"
#include "lattice/constants.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant {

namespace {

/// A part's directions at rest, and where they are now.
struct ThinFrame
{
	Vec3d along[2], normal[2]; ///< at rest; a plate has two of the first, a rod two of the second
	int normals;
	Eigen::Matrix3d stretch = Eigen::Matrix3d::Zero();    ///< F along the part; 0 across it
	Vec3d deformed[2] = { Vec3d::Zero(), Vec3d::Zero() }; ///< normals; 0 where the part has collapsed

	explicit ThinFrame( const ThinCell& cell ) : normals( cell.normals )
	{
		normal[0] = cell.normal[0].cast<double>();
		normal[1] = cell.normals == 2 ? Vec3d( cell.normal[1].cast<double>() ) : Vec3d( Vec3d::Zero() );
		layAlong();
	}

	/// From the sums of p q^T and q q^T and of the vectors p of a cell's links. Returns false where these do not say what becomes of the
	/// part.
	bool deform( const Eigen::Matrix3d& now, const Eigen::Matrix3d& rest, const Vec3d& sum )
	{
		return normals == 1 ? deformPlate( now, rest ) : deformRod( now, rest, sum );
	}

private:
	void layAlong()
	{
		along[0] = normals == 2 ? normal[0].cross( normal[1] ) : normal[0].unitOrthogonal();
		along[1] = normals == 2 ? Vec3d( Vec3d::Zero() ) : normal[0].cross( along[0] );
	}

	// Links that hardly extend across the part say nothing of the stretch across it, and must not enter what is along it: the normal is
	// then that of the links themselves.
	bool deformPlate( const Eigen::Matrix3d& now, const Eigen::Matrix3d& rest )
	{
		Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
		solver.computeDirect( rest );
		const Vec3d& extent = solver.eigenvalues();
		if ( extent[1] < kLeastAcross * extent[2] )
		{
			return false;
		}
		if ( extent[0] < kLeastAcross * extent[2] )
		{
			const Vec3d own = solver.eigenvectors().col( 0 );
			const double cosine = own.dot( normal[0] );
			if ( std::fabs( cosine ) < double( kSameFaceCosine ) )
			{
				return false;
			}
			normal[0] = cosine < 0.0 ? Vec3d( -own ) : own;
			layAlong();
		}
		Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
		for ( int k = 0; k < 3; ++k )
		{
			const Vec3d axis = solver.eigenvectors().col( k );
			inverse += extent[k] < kLeastAcross * extent[2] ? Eigen::Matrix3d( Eigen::Matrix3d::Zero() )
															: Eigen::Matrix3d( axis * axis.transpose() / extent[k] );
		}
		stretch = now * inverse * ( Eigen::Matrix3d::Identity() - normal[0] * normal[0].transpose() );
		const Vec3d cross = Vec3d( stretch * along[0] ).cross( Vec3d( stretch * along[1] ) );
		const double size = cross.norm();
		deformed[0] = size > kLeastFaceArea ? Vec3d( cross / size ) : Vec3d( Vec3d::Zero() ); // along[0] x along[1] is the normal
		return size > kLeastFaceArea;
	}

	// Links across the rod, of which a row of single cells has none, say how it is turned about its axis. Such a row bends in the direction
	// of the first normal.
	bool deformRod( const Eigen::Matrix3d& now, const Eigen::Matrix3d& rest, const Vec3d& sum )
	{
		const Eigen::Matrix3d deformation = now * inverseOfRest( rest );
		stretch = deformation * along[0] * along[0].transpose();
		const Vec3d first = stretch * along[0];
		if ( first.norm() < kLeastFaceArea )
		{
			return false;
		}
		const Vec3d axis = first.normalized();
		const auto across = [&axis]( const Vec3d& v ) { return Vec3d( v - axis.dot( v ) * axis ); };
		const double least = kLeastAcross * along[0].dot( rest * along[0] );
		Vec3d found[2];
		for ( int k = 0; k < 2; ++k )
		{
			found[k] = normal[k].dot( rest * normal[k] ) > least ? across( deformation * normal[k] ) : Vec3d( Vec3d::Zero() );
			found[k] = found[k].norm() > kLeastFaceArea ? Vec3d( found[k].normalized() ) : Vec3d( Vec3d::Zero() );
		}
		if ( found[0].isZero() && found[1].isZero() )
		{
			found[0] = across( sum ).norm() > 0.0 ? Vec3d( across( sum ).normalized() ) : Vec3d( axis.unitOrthogonal() );
		}
		// The axis and the normals are right-handed, as at rest.
		deformed[0] = found[0].isZero() ? Vec3d( found[1].cross( axis ) ) : found[0];
		deformed[1] = axis.cross( deformed[0] );
		return true;
	}
};

constexpr std::uint32_t kNone = 0xffffffffu;

/// Symmetric matrix of the entries of K along a part.
Eigen::Matrix3d curvatureOf( const ThinFrame& frame, const Vec3d& entries )
{
	const Vec3d &t = frame.along[0], &u = frame.along[1]; // the second of a rod is 0
	return entries[0] * t * t.transpose() + entries[1] * ( t * u.transpose() + u * t.transpose() ) + entries[2] * u * u.transpose();
}

/// Links of a cell at rest and now, in cells.
struct Links
{
	Vec3d rest[kNeighbours], now[kNeighbours];
	int count = 0;
};

// K has the least squares over the cell's links of
//
//   n p = l ( N q ) + r q - q^T K q / 2
//
// l the stretch across the part, r what the normal is turned by. Where links do not say so, l is 1 and the rest 0: hence the terms added to
// the diagonal, which are small beside those of a cell with links to all sides.
Eigen::Matrix3d curvatureAlong( const Links& links, const ThinFrame& frame, int normal )
{
	Eigen::Matrix<double, 6, 6> squares = Eigen::Matrix<double, 6, 6>::Zero();
	Eigen::Matrix<double, 6, 1> sums = Eigen::Matrix<double, 6, 1>::Zero(), row;
	squares.diagonal() << kAcrossPrior, kTurnPrior, kTurnPrior, kCurvaturePrior, kCurvaturePrior, kCurvaturePrior;
	for ( int l = 0; l < links.count; ++l )
	{
		const Vec3d& q = links.rest[l];
		const double t = frame.along[0].dot( q ), u = frame.along[1].dot( q ), across = frame.normal[normal].dot( q );
		row << across, t, frame.normals == 2 ? frame.normal[1 - normal].dot( q ) : u, -0.5 * t * t, -t * u, -0.5 * u * u;
		squares.noalias() += row * row.transpose();
		sums += ( frame.deformed[normal].dot( links.now[l] ) - across ) * row;
	}
	return curvatureOf( frame, squares.ldlt().solve( sums ).tail<3>() );
}

} // namespace

const ThinCell* FaceStretch::thinCellOf( std::uint32_t cell )
{
	if ( m_thin->empty() )
	{
		return nullptr;
	}
	if ( m_thinOf.empty() )
	{
		m_thinOf.assign( std::size_t( m_lattice->cellCount() ), kNone );
		for ( std::size_t k = 0; k < m_thin->size(); ++k )
		{
			m_thinOf[( *m_thin )[k].cell] = std::uint32_t( k );
		}
	}
	return m_thinOf[cell] != kNone ? &( *m_thin )[m_thinOf[cell]] : nullptr;
}

void FaceStretch::update( const Lattice& lattice, const LinkLimits& limits, const CellPositions& positions, double strain )
{
	m_strain = strain;
	m_lattice = &lattice;
	m_thin = &limits.thin;
	m_moments.update( lattice, positions );
	m_thinOf.clear();
	m_slot.clear();
	m_bends.clear();
}

float FaceStretch::roughBending( const ThinCell& cell ) const
{
	const Vec3 middle = 2.0f * m_moments.position( cell.cell );
	float most = 0.0f;
	for ( int k = 0; k < cell.pairs; ++k )
	{
		const ThinCell::Pair& pair = cell.pair[k];
		const bool areNodes = m_moments.isNode( pair.a ) && m_moments.isNode( pair.b );
		most = areNodes ? std::max( most, pair.bendingSquare( m_moments.position( pair.a ) + m_moments.position( pair.b ) - middle ) )
						: most;
	}
	return std::sqrt( most );
}

bool FaceStretch::isBent( const ThinCell& cell ) const
{
	return double( roughBending( cell ) ) > kLeastBending * m_strain;
}

bool FaceStretch::mayBreak( const ThinCell& cell, bool isStretched )
{
	if ( !m_moments.isNode( cell.cell ) )
	{
		return false;
	}
	const double middle = kInMiddle * double( m_lattice->cellSize );
	const bool isInMiddle = std::max( std::fabs( cell.height[0] ), std::fabs( cell.height[1] ) ) < float( middle );
	const double bending = ( isInMiddle ? kRoughInMiddle : kRoughBending ) * double( roughBending( cell ) );
	return bending > m_strain ||
		( ( isStretched || bending > kBendingCandidate * m_strain ) &&
			!isStretchedLess( m_moments.of( cell.cell ).deformation(), m_strain - bending ) );
}

FaceStretch::Bend FaceStretch::measure( const ThinCell& cell )
{
	const double d = double( m_lattice->cellSize );
	Links links;
	for ( std::uint32_t l = m_lattice->linkStart[cell.cell]; l < m_lattice->linkStart[cell.cell + 1]; ++l )
	{
		const std::uint32_t j = m_lattice->linkTo[l];
		if ( m_moments.isNode( j ) )
		{
			links.rest[links.count] = ( m_lattice->restCentre[j] - m_lattice->restCentre[cell.cell] ).cast<double>() / d;
			links.now[links.count++] = ( m_moments.position( j ) - m_moments.position( cell.cell ) ).cast<double>() / d;
		}
	}
	ThinFrame frame( cell );
	Bend bend;
	bend.now.setZero();
	bend.rest.setZero();
	Vec3d sum = Vec3d::Zero();
	for ( int l = 0; l < links.count; ++l )
	{
		bend.now += links.now[l] * links.rest[l].transpose();
		bend.rest += links.rest[l] * links.rest[l].transpose();
		sum += links.now[l];
	}
	const bool isKnown = frame.deform( bend.now, bend.rest, sum );
	bend.curvature[0].setZero();
	bend.curvature[1].setZero();
	for ( int k = 0; k < cell.normals && isKnown; ++k )
	{
		const Vec3d& normal = frame.normal[k];
		const Eigen::Matrix3d curvature = curvatureAlong( links, frame, k ), along = frame.stretch * curvature;
		for ( int l = 0; l < links.count; ++l )
		{
			const Vec3d& q = links.rest[l];
			bend.now += ( 0.5 * q.dot( curvature * q ) * frame.deformed[k] - q.dot( normal ) * ( along * q ) ) * q.transpose();
		}
		// Where links do not say how the part is stretched across, it is not.
		bend.now += kAcrossPrior * frame.deformed[k] * normal.transpose();
		bend.rest += kAcrossPrior * normal * normal.transpose();
		bend.curvature[k] = curvature / d;
	}
	return bend;
}

const FaceStretch::Bend& FaceStretch::bendOf( const ThinCell& cell )
{
	if ( m_slot.empty() )
	{
		m_slot.assign( m_thin->size(), kNone );
		m_bends.reserve( m_thin->size() );
	}
	std::uint32_t& slot = m_slot[std::size_t( &cell - m_thin->data() )];
	if ( slot == kNone )
	{
		slot = std::uint32_t( m_bends.size() );
		m_bends.push_back( measure( cell ) );
	}
	return m_bends[slot];
}

Eigen::Matrix3d FaceStretch::atFace( const ThinCell& cell, bool isWide, const double sides[2] )
{
	Eigen::Matrix3d now = Eigen::Matrix3d::Zero(), rest = now, bending = now;
	double count = 0.0;
	const auto add = [&]( const ThinCell& other ) {
		const Bend& bend = bendOf( other );
		now += bend.now;
		rest += bend.rest;
		count += 1.0;
		for ( int k = 0; k < std::min( cell.normals, other.normals ); ++k )
		{
			// The other's normal may point the other way.
			const double side = cell.normal[k].dot( other.normal[k] ) < 0.0f ? -sides[k] : sides[k];
			bending += side * ( double( other.half[k] ) - side * double( other.height[k] ) ) * bend.curvature[k];
		}
	};
	add( cell );
	for ( std::uint32_t l = m_lattice->linkStart[cell.cell]; isWide && l < m_lattice->linkStart[cell.cell + 1]; ++l )
	{
		const std::uint32_t j = m_lattice->linkTo[l];
		const ThinCell* const other = m_moments.isNode( j ) ? thinCellOf( j ) : nullptr;
		const Vec3 q = m_lattice->restCentre[j] - m_lattice->restCentre[cell.cell];
		const auto isAlong = [&]( int k ) {
			return std::fabs( cell.normal[k].dot( other->normal[k] ) ) > kSameFaceCosine &&
				std::fabs( cell.normal[k].dot( q ) ) < kAtFace * m_lattice->cellSize;
		};
		if ( other && other->normals == cell.normals && isAlong( 0 ) && ( cell.normals == 1 || isAlong( 1 ) ) )
		{
			add( *other );
		}
	}
	return now * inverseOfRest( rest ) * ( Eigen::Matrix3d::Identity() + bending / count );
}

Eigen::Matrix3d FaceStretch::atWeakerFace( const ThinCell& cell, bool isWide )
{
	Eigen::Matrix3d most = Eigen::Matrix3d::Zero();
	double strain = -1.0;
	for ( int k = 0; k < ( cell.normals == 2 ? 4 : 2 ); ++k )
	{
		const double sides[2] = { k % 2 == 0 ? 1.0 : -1.0, k / 2 == 0 ? 1.0 : -1.0 };
		bool isOutside = true; // where the cell is above the middle the face below is that of other cells
		for ( int n = 0; n < cell.normals; ++n )
		{
			isOutside = isOutside && sides[n] * double( cell.height[n] ) > -kInMiddle * double( m_lattice->cellSize );
		}
		if ( isOutside )
		{
			const Eigen::Matrix3d face = atFace( cell, isWide, sides );
			const double found = largestStretch( face ).strain;
			most = found > strain ? face : most;
			strain = std::max( strain, found );
		}
	}
	return most;
}

Eigen::Matrix3d FaceStretch::deformationOf( std::uint32_t cell, bool isWide )
{
	const ThinCell* const thin = thinCellOf( cell );
	if ( thin && isBent( *thin ) )
	{
		return atWeakerFace( *thin, isWide );
	}
	return isWide ? m_moments.around( cell ).deformation() : m_moments.of( cell ).deformation();
}

Eigen::Matrix3d FaceStretch::bendingOf( const ThinCell& cell, int normal )
{
	return double( cell.half[normal] ) * bendOf( cell ).curvature[normal];
}

// A part has the mean square K^2 t^2 / 12, t its thickness, and links that of the cells' centres: K^2 d^2 / 12 less. It is shared by the
// cells at the faces: of a row of n cells across a plate by two, of n m across a rod by all but the ( n - 2 ) ( m - 2 ) within.
double FaceStretch::hiddenSquare( const ThinCell& cell ) const
{
	if ( !m_moments.isNode( cell.cell ) )
	{
		return 0.0;
	}
	const double d = double( m_lattice->cellSize );
	double outside = 0.0, thick = d, all = 1.0, inner = 1.0;
	for ( int k = 0; k < cell.normals; ++k )
	{
		const double cells = std::max( 1.0, std::round( 2.0 * double( cell.half[k] ) / d ) );
		outside += double( cell.outside( k ) );
		thick = std::min( thick, 2.0 * double( cell.half[k] ) );
		all *= cells;
		inner *= std::max( 0.0, cells - 2.0 );
	}
	const double curvature = outside > 0.0 ? double( roughBending( cell ) ) / outside : 0.0;
	return curvature * curvature * thick * thick / 12.0 * all / ( all - inner );
}

double FaceStretch::hiddenEnergy( const std::vector<CellLink>& links )
{
	const double d = double( m_lattice->cellSize );
	double sum = 0.0;
	for ( const CellLink& link : links )
	{
		for ( const std::uint32_t end : { link.a, link.b } )
		{
			if ( const ThinCell* const thin = thinCellOf( end ) )
			{
				const double share = 1.0 / double( m_lattice->linkStart[end + 1] - m_lattice->linkStart[end] );
				sum += 0.5 * share * d * d * d * double( m_lattice->fill[end] ) * hiddenSquare( *thin );
			}
		}
	}
	return sum;
}

void FaceStretch::findOverbent( const LinkLimits& limits, const CellPositions& positions, std::vector<CellLink>& found )
{
	const std::size_t before = found.size();
	for ( const ThinCell& thin : limits.thin )
	{
		const std::uint32_t i = thin.cell;
		if ( !positions.mayBreak( i ) || !isBent( thin ) || !mayBreak( thin, false ) )
		{
			continue;
		}
		const Eigen::Matrix3d face = deformationOf( i, false );
		for ( std::uint32_t l = m_lattice->linkStart[i]; l < m_lattice->linkStart[i + 1]; ++l )
		{
			const std::uint32_t j = m_lattice->linkTo[l];
			const Vec3d q = ( m_lattice->restCentre[j] - m_lattice->restCentre[i] ).cast<double>();
			const float longest = breakingSquared( limits.lengthSquared[limits.linkOf( i, j )], positions, i, j );
			if ( positions.mayBreak( j ) && ( face * q ).squaredNorm() > double( longest ) )
			{
				found.push_back( CellLink{ std::min( i, j ), std::max( i, j ) } );
			}
		}
	}
	if ( found.size() > before )
	{
		std::sort( found.begin(), found.end() );
		found.erase( std::unique( found.begin(), found.end() ), found.end() );
	}
}

} // namespace pliant
