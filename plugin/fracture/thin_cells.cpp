#include "fracture/thin_cells.h"

#include "archive/archive.h"
#include "fracture/constants.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

namespace pliant {

void ThinCell::archive( Archive& archive )
{
	archive( cell, normals, normal[0], normal[1], height[0], height[1], half[0], half[1], pairs );
	archive.require( normals >= 1 && normals <= 2 && pairs >= 0 && pairs <= int( std::size( pair ) ), "A thin cell is not valid." );
	for ( int k = 0; archive.isSound() && k < normals; ++k )
	{
		archive.require(
			std::fabs( normal[k].norm() - 1.0f ) < kUnitNormal && std::isfinite( height[k] ) && half[k] > 0.0f && std::isfinite( half[k] ),
			"A thin cell is not valid." );
	}
	for ( int k = 0; archive.isSound() && k < pairs; ++k )
	{
		archive( pair[k].a, pair[k].b, pair[k].square, pair[k].scale );
		archive.require( std::isfinite( pair[k].square ) && std::isfinite( pair[k].scale ), "A thin cell is not valid." );
	}
}

void archiveThinCells( Archive& archive, std::vector<ThinCell>& thin, std::size_t cells )
{
	archive( thin );
	for ( std::size_t k = 0; archive.isReading() && archive.isSound() && k < thin.size(); ++k )
	{
		const ThinCell& own = thin[k];
		const auto isIn = [cells]( const ThinCell::Pair& pair ) { return pair.a < cells && pair.b < cells; };
		archive.require(
			own.cell < cells && ( k == 0 || thin[k - 1].cell < own.cell ) && std::all_of( own.pair, own.pair + own.pairs, isIn ),
			"A thin cell is that of another body." );
	}
}

namespace {

/// Sums over a cell and its linked cells.
struct Spread
{
	double count = 1.0;
	Vec3d sum = Vec3d::Zero();
	Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();

	/// Second moment about the mean.
	Eigen::Matrix3d moment() const { return squares - sum * sum.transpose() / count; }
};

Spread spreadOf( const Lattice& lattice, std::uint32_t cell )
{
	Spread spread;
	for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
	{
		const Vec3d q = ( lattice.restCentre[lattice.linkTo[k]] - lattice.restCentre[cell] ).cast<double>();
		spread.count += 1.0;
		spread.sum += q;
		spread.squares += q * q.transpose();
	}
	return spread;
}

/// Directions across a part about a cell, that in which the material extends least first. Axes of the lattice, unless the part is slanted.
/// `isRod`: the part may be thin in the second of them too.
Eigen::Matrix3d directionsAt( const Lattice& lattice, const std::vector<Eigen::Matrix3d>& moments, std::uint32_t cell, bool& isRod )
{
	Eigen::Matrix3d sum = moments[cell];
	for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
	{
		sum += moments[lattice.linkTo[k]];
	}
	const Eigen::Matrix3d diagonal = sum.diagonal().asDiagonal();
	if ( ( sum - diagonal ).norm() > kSlantedPart * sum.trace() )
	{
		isRod = false; // its second direction is not reliable
		return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>( sum ).eigenvectors();
	}
	int order[3] = { 0, 1, 2 };
	std::stable_sort( order, order + 3, [&]( int a, int b ) { return sum( a, a ) < sum( b, b ); } );
	isRod = true; // where the cells along the second axis are few
	Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
	for ( int k = 0; k < 3; ++k )
	{
		axes( order[k], k ) = 1.0;
	}
	return axes;
}

/// The cell next to one along an axis, in the direction of `step`; the cell itself where there is none.
std::uint32_t nextAlong( const Lattice& lattice, std::uint32_t cell, int axis, int step )
{
	for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
	{
		const Eigen::Vector3i offset = ( lattice.coordinate[lattice.linkTo[k]] - lattice.coordinate[cell] ).cast<int>();
		if ( offset[axis] == step && offset.cwiseAbs().sum() == 1 )
		{
			return lattice.linkTo[k];
		}
	}
	return cell;
}

/// Half the thickness of the part about a cell along a normal, and the cell's height above its middle, from the cells along the axis of the
/// lattice that is nearest to the normal. False where there are more than kThinCells, or the cell is not at a face.
bool measureAcross( const Lattice& lattice, std::uint32_t cell, const Vec3& normal, float& height, float& half )
{
	int axis = 0;
	const float along = normal.cwiseAbs().maxCoeff( &axis );
	double thickness = 0.0, moment = 0.0;
	int count = 0;
	const auto add = [&]( std::uint32_t at ) {
		thickness += double( lattice.fill[at] );
		moment += double( lattice.fill[at] ) * double( ( lattice.restCentre[at] - lattice.restCentre[cell] ).dot( normal ) );
		++count;
	};
	add( cell );
	for ( const int step : { -1, 1 } )
	{
		std::uint32_t at = cell;
		for ( std::uint32_t next = nextAlong( lattice, at, axis, step ); next != at && count <= kThinCells;
			  next = nextAlong( lattice, at, axis, step ) )
		{
			at = next;
			add( at );
		}
	}
	height = float( -moment / thickness );
	half = 0.5f * float( thickness ) * along * lattice.cellSize;
	return count <= kThinCells && half - std::fabs( height ) < kAtFace * lattice.cellSize;
}

/// The two linked cells that are most nearly on opposite sides of a cell; equal where none are.
std::pair<std::uint32_t, std::uint32_t> mostOpposite( const Lattice& lattice, std::uint32_t cell )
{
	std::pair<std::uint32_t, std::uint32_t> best{ cell, cell };
	float least = -kPairCosine;
	const auto directionTo = [&]( std::uint32_t other ) { return ( lattice.restCentre[other] - lattice.restCentre[cell] ).normalized(); };
	for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
	{
		for ( std::uint32_t l = k + 1; l < lattice.linkStart[cell + 1]; ++l )
		{
			const float cosine = directionTo( lattice.linkTo[k] ).dot( directionTo( lattice.linkTo[l] ) );
			best = cosine < least ? std::pair{ lattice.linkTo[k], lattice.linkTo[l] } : best;
			least = std::min( least, cosine );
		}
	}
	return best;
}

/// Finds the cell's pairs, those that lie best along the part where there are more than fit.
void findPairs( const Lattice& lattice, ThinCell& thin )
{
	std::array<std::uint32_t, 27> at;
	at.fill( thin.cell );
	for ( std::uint32_t k = lattice.linkStart[thin.cell]; k < lattice.linkStart[thin.cell + 1]; ++k )
	{
		const Eigen::Vector3i offset = ( lattice.coordinate[lattice.linkTo[k]] - lattice.coordinate[thin.cell] ).cast<int>();
		at[std::size_t( 13 + offset.x() + 3 * offset.y() + 9 * offset.z() )] = lattice.linkTo[k];
	}
	float outside = 0.0f;
	for ( int k = 0; k < thin.normals; ++k )
	{
		outside += thin.outside( k );
	}
	std::vector<std::pair<float, ThinCell::Pair>> found;
	const auto add = [&]( std::uint32_t first, std::uint32_t second ) {
		const Vec3 &a = lattice.restCentre[first], &b = lattice.restCentre[second], &middle = lattice.restCentre[thin.cell];
		const Vec3 direction = ( b - a ).normalized();
		const float across = std::fabs( direction.dot( thin.normal[0] ) ) + std::fabs( direction.dot( thin.normal[1] ) );
		found.push_back( { across, { first, second, ( a + b - 2.0f * middle ).squaredNorm(), 4.0f * outside / ( b - a ).squaredNorm() } } );
	};
	for ( std::size_t k = 0; k < 13; ++k )
	{
		if ( at[k] != thin.cell && at[26 - k] != thin.cell )
		{
			add( at[k], at[26 - k] );
		}
	}
	if ( found.empty() ) // as at steps of slanted rods
	{
		const auto [first, second] = mostOpposite( lattice, thin.cell );
		first != second ? add( first, second ) : void();
	}
	std::stable_sort( found.begin(), found.end(), []( const auto& a, const auto& b ) { return a.first < b.first; } );
	for ( ; thin.pairs < std::min( int( found.size() ), int( std::size( thin.pair ) ) ); ++thin.pairs )
	{
		thin.pair[thin.pairs] = found[std::size_t( thin.pairs )].second;
	}
}

} // namespace

std::vector<ThinCell> findThinCells( const Lattice& lattice )
{
	std::vector<ThinCell> thin;
	const std::uint32_t cells = std::uint32_t( lattice.cellCount() );
	if ( lattice.extent.maxCoeff() < kLeastThinLength )
	{
		return thin;
	}
	std::vector<Eigen::Matrix3d> moments( cells );
	for ( std::uint32_t cell = 0; cell < cells; ++cell )
	{
		moments[cell] = spreadOf( lattice, cell ).moment();
	}
	for ( std::uint32_t cell = 0; cell < cells; ++cell )
	{
		if ( lattice.isSurface[cell] == 0 || lattice.linkStart[cell] == lattice.linkStart[cell + 1] )
		{
			continue;
		}
		ThinCell found;
		found.cell = cell;
		bool isRod = false;
		const Eigen::Matrix3d directions = directionsAt( lattice, moments, cell, isRod );
		for ( int k = 0; k < ( isRod ? 2 : 1 ); ++k )
		{
			const Vec3 normal = directions.col( k ).cast<float>();
			float height = 0.0f, half = 0.0f;
			if ( measureAcross( lattice, cell, normal, height, half ) &&
				2.0f * half * kLeastSlenderness <= float( lattice.extent.maxCoeff() ) * lattice.cellSize )
			{
				found.normal[found.normals] = normal;
				found.height[found.normals] = height;
				found.half[found.normals] = half;
				++found.normals;
			}
		}
		if ( found.normals > 0 )
		{
			findPairs( lattice, found );
			thin.push_back( found );
		}
	}
	return thin;
}

std::vector<ThinCell> inheritThinCells( const std::vector<ThinCell>& before, const Lattice& part, const std::vector<std::uint32_t>& cells )
{
	std::vector<ThinCell> thin;
	if ( before.empty() )
	{
		return thin;
	}
	constexpr std::uint32_t kGone = 0xffffffffu;
	thin.reserve( std::min( before.size(), cells.size() ) );
	std::vector<std::uint32_t> now( std::size_t( cells.back() ) + 1, kGone );
	for ( std::uint32_t i = 0; i < std::uint32_t( cells.size() ); ++i )
	{
		now[cells[i]] = i;
	}
	const auto numberOf = [&now]( std::uint32_t cell ) { return cell < now.size() ? now[cell] : kGone; };
	for ( const ThinCell& old : before )
	{
		if ( numberOf( old.cell ) == kGone )
		{
			continue;
		}
		thin.push_back( old );
		thin.back().cell = numberOf( old.cell );
		thin.back().pairs = 0;
		const auto row = part.linkTo.begin() + part.linkStart[thin.back().cell],
				   end = part.linkTo.begin() + part.linkStart[thin.back().cell + 1];
		for ( int k = 0; k < old.pairs; ++k )
		{
			ThinCell::Pair pair = old.pair[k];
			pair.a = numberOf( pair.a );
			pair.b = numberOf( pair.b );
			if ( std::binary_search( row, end, pair.a ) && std::binary_search( row, end, pair.b ) )
			{
				thin.back().pair[thin.back().pairs++] = pair;
			}
		}
	}
	return thin;
}

} // namespace pliant
