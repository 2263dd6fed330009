#include "matching/regions/region_moments.h"

#include "matching/constants.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <vector>

namespace pliant {

namespace {

int paddedCount( int count )
{
	return ( count + kLanes - 1 ) / kLanes * kLanes;
}

void weighNodes( const Lattice& lattice, const RegionSet& regions, Weights weights, RegionMoments& out )
{
	for ( int i = 0; i < out.count; ++i )
	{
		if ( weights == Weights::Conserving )
		{
			out.nodeWeight[i] = lattice.fill[i] / float( regions.size[i] );
			out.inverseCover[i] = 1.0f / float( regions.size[i] );
			continue;
		}
		double cover = 0.0;
		for ( std::uint32_t k = regions.start[i]; k < regions.start[i + 1]; ++k )
		{
			cover += lattice.fill[regions.member[k]];
		}
		out.nodeWeight[i] = lattice.fill[i];
		out.inverseCover[i] = float( 1.0 / cover );
	}
	if ( weights == Weights::Literal )
	{
		out.regionWeight.assign( out.padded, 0.0f );
		std::copy( lattice.fill.begin(), lattice.fill.end(), out.regionWeight.begin() );
	}
}

} // namespace

Eigen::Matrix3d flooredInverse( const Eigen::Matrix3d& moment, double floorFraction )
{
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( moment );
	const double largest = solver.eigenvalues()[2];
	if ( !( largest > 0.0 ) )
	{
		return Eigen::Matrix3d::Zero();
	}
	const Eigen::Vector3d raised = solver.eigenvalues().cwiseMax( floorFraction * largest );
	return solver.eigenvectors() * raised.cwiseInverse().asDiagonal() * solver.eigenvectors().transpose();
}

Eigen::Matrix3d inverseOfPart( const Eigen::Matrix3d& inertia, double mass )
{
	return inertia.trace() > kPointExtent * mass ? flooredInverse( inertia, kInertiaFloor ) : Eigen::Matrix3d( Eigen::Matrix3d::Zero() );
}

Eigen::Matrix3d inverseInPlane( const Eigen::Matrix3d& moment, double floorFraction, Eigen::Matrix3d& outside )
{
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( moment );
	const double floor = floorFraction * solver.eigenvalues()[2];
	Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
	outside.setZero();
	for ( int i = 0; i < 3; ++i )
	{
		const Eigen::Vector3d axis = solver.eigenvectors().col( i );
		if ( solver.eigenvalues()[i] > floor )
		{
			inverse += axis * axis.transpose() / solver.eigenvalues()[i];
		}
		else
		{
			outside += axis * axis.transpose();
		}
	}
	return inverse;
}

void markFlatRegions( RegionMoments& moments, AlignedArray<float> ( &outOfPlane )[6] )
{
	for ( int r = 0; r < moments.count; ++r )
	{
		const auto& j = moments.moment;
		Eigen::Matrix3d moment, outside;
		moment << j[0][r], j[5][r], j[4][r], j[5][r], j[1][r], j[3][r], j[4][r], j[3][r], j[2][r];
		// Eigenvalues a >= b >= c: det = a b c <= a^2 c and ( tr / 3 )^3 >= ( a / 3 )^3, so det / ( tr / 3 )^3 <= 27 c / a.
		const double third = moment.trace() / 3.0;
		if ( moment.determinant() > 27.0 * double( kMomentFloor ) * third * third * third )
		{
			continue;
		}
		const Eigen::Matrix3d inverse = inverseInPlane( moment, kMomentFloor, outside );
		if ( outside.isZero( 0.0 ) )
		{
			continue;
		}
		for ( int k = 0; k < 6 && outOfPlane[k].empty(); ++k )
		{
			outOfPlane[k].assign( moments.padded, 0.0f );
		}
		storeSymmetric( moments.inverseMoment, r, inverse );
		storeSymmetric( outOfPlane, r, outside );
	}
}

namespace {

/// Rest positions in cells, and 1: four doubles per cell, so that all sums below vectorise in pairs.
using Positions = std::vector<Eigen::Array4d>;

Positions positionsInCells( const Lattice& lattice )
{
	const double perCell = 1.0 / lattice.cellSize;
	Positions positions( lattice.restCentre.size() );
	for ( std::size_t i = 0; i < positions.size(); ++i )
	{
		positions[i] << lattice.restCentre[i].cast<double>().array() * perCell, 1.0;
	}
	return positions;
}

// Summed about the owner's position q_r, at most w cells from the centre, so that cancellation in double stays below float resolution:
//   c0 = q_r + sum a d / M,  J = sum a d d^T - M (c0 - q_r)(c0 - q_r)^T  with d = q - q_r.
void measureRegion( const Positions& positions, const RegionSet& regions, int r, bool withInverse, RegionMoments& out )
{
	Eigen::Array4d owner = positions[std::size_t( r )];
	owner[3] = 0.0; // the last component of d is 1, and sums to the mass
	Eigen::Array4d first = Eigen::Array4d::Zero(), row[3] = { first, first, first };
	for ( std::uint32_t k = regions.start[r]; k < regions.start[r + 1]; ++k )
	{
		const std::uint32_t i = regions.member[k];
		const Eigen::Array4d d = positions[i] - owner, weighed = double( out.nodeWeight[i] ) * d;
		first += weighed;
		row[0] += d[0] * weighed;
		row[1] += d[1] * weighed;
		row[2] += d[2] * weighed;
	}
	const double mass = first[3];
	const Vec3d offset = first.head<3>().matrix() / mass;
	Eigen::Matrix3d moment;
	for ( int k = 0; k < 3; ++k )
	{
		moment.row( k ) = row[k].head<3>().matrix().transpose() - mass * offset[k] * offset.transpose();
	}
	out.inverseMass[r] = float( 1.0 / mass );
	for ( int axis = 0; axis < 3; ++axis )
	{
		out.centre[axis][r] = float( owner[axis] + offset[axis] );
	}
	storeSymmetric( out.moment, r, moment );
	if ( withInverse )
	{
		storeSymmetric( out.inverseMoment, r, flooredInverse( moment, kMomentFloor ) );
	}
}

/// Broken links only remove cells from regions: a region of unchanged size has the same cells, and weighs them the same where each of them
/// is in as many regions as before. So regions that hold a cell whose own region changed in size are recomputed; membership is symmetric.
std::vector<std::uint8_t> changedRegions( const RegionSet& regions, const MomentsBefore& before )
{
	std::vector<std::uint8_t> isChanged( regions.size.size(), 0 );
	for ( std::size_t i = 0; i < isChanged.size(); ++i )
	{
		if ( regions.size[i] != before.regions.size[before.cellBefore[i]] )
		{
			for ( std::uint32_t k = regions.start[i]; k < regions.start[i + 1]; ++k )
			{
				isChanged[regions.member[k]] = 1;
			}
		}
	}
	return isChanged;
}

} // namespace

RegionMoments computeRegionMoments(
	const Lattice& lattice, const RegionSet& regions, Weights weights, bool withInverse, const MomentsBefore* before )
{
	RegionMoments out;
	out.count = lattice.cellCount();
	out.padded = paddedCount( out.count );
	out.nodeWeight.assign( out.padded, 0.0f );
	out.inverseCover.assign( out.padded, 0.0f );
	out.inverseMass.assign( out.padded, 0.0f );
	for ( auto& array : out.centre )
	{
		array.assign( out.padded, 0.0f );
	}
	for ( int k = 0; k < 6; ++k )
	{
		out.moment[k].assign( out.padded, k < 3 ? 1.0f : 0.0f );
		if ( withInverse )
		{
			out.inverseMoment[k].assign( out.padded, 0.0f );
		}
	}
	weighNodes( lattice, regions, weights, out );

	const std::vector<std::uint8_t> isChanged = before ? changedRegions( regions, *before ) : std::vector<std::uint8_t>();
	const Positions positions = positionsInCells( lattice );
	for ( int r = 0; r < out.count; ++r )
	{
		if ( !before || isChanged[std::size_t( r )] != 0 )
		{
			measureRegion( positions, regions, r, withInverse, out );
			continue;
		}
		const int old = int( before->cellBefore[std::size_t( r )] );
		out.inverseMass[r] = before->moments.inverseMass[old];
		for ( int axis = 0; axis < 3; ++axis )
		{
			out.centre[axis][r] = float( double( before->moments.centre[axis][old] ) - before->shift[axis] );
		}
		for ( int k = 0; k < 6; ++k )
		{
			out.moment[k][r] = before->moments.moment[k][old];
			if ( withInverse )
			{
				out.inverseMoment[k][r] = before->moments.inverseMoment[k][old];
			}
		}
	}
	return out;
}

} // namespace pliant
