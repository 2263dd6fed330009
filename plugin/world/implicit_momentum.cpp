// Momentum that the end of the iteration must not lose.

#include "world/implicit_block.h"
#include "world/soft_body_impl.h"

#include "lattice/union_find.h"

namespace pliant {

namespace {

/// A rigid motion's mass about `centre` of something with `mass` at `at`.
Matrix6 massAbout( const Vec3d& centre, double mass, const Eigen::Matrix3d& inertia, const Vec3d& at )
{
	const Vec3d arm = at - centre;
	Matrix6 whole = Matrix6::Zero();
	whole.topLeftCorner<3, 3>() = mass * Eigen::Matrix3d::Identity();
	whole.bottomRightCorner<3, 3>() = inertia + mass * ( arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose() );
	return whole;
}

/// What must not be lost: a force's sum and turn, moved from `at` to `centre`.
Vector6 movedTo( const Vec3d& centre, const Vector6& sums, const Vec3d& at )
{
	Vector6 moved = sums;
	moved.tail<3>() += ( at - centre ).cross( sums.head<3>() );
	return moved;
}

/// The rigid motion `about` centre, seen from `at`.
Vector6 seenFrom( const Vec3d& at, const Vector6& motion, const Vec3d& centre )
{
	Vector6 seen = motion;
	seen.head<3>() += motion.tail<3>().cross( at - centre );
	return seen;
}

Vec3d worldCentre( const SoftPart& part )
{
	return part.motion->nodes().origin + part.motion->centre();
}

} // namespace

// The iteration ends early and in float. What is then missing of the momentum of bodies that touch nothing fixed is given to all of them
// together, as one rigid motion: given to the light ones alone it would throw them.
void ImplicitBlock::keepMomentum()
{
	const std::size_t count = 1 + soft.size() + rigid.size(); // 0 is what is fixed
	UnionFind groups( count );
	const auto placeOf = [&]( const ContactSide& side ) {
		return std::uint32_t( side.soft >= 0 ? 1 + std::size_t( side.soft ) : side.rigid >= 0 ? 1 + soft.size() + std::size_t( side.rigid ) : 0 );
	};
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.normalImpulse != 0.0 )
		{
			groups.join( placeOf( contact.side[0] ), placeOf( contact.side[1] ) );
		}
	}
	for ( std::size_t p = 0; p < soft.size(); ++p )
	{
		if ( soft[p].motion->hasHeldNodes() )
		{
			groups.join( std::uint32_t( 1 + p ), 0 );
		}
	}
	for ( std::size_t p = 0; p < rigid.size(); ++p )
	{
		const RigidPart& part = rigid[p];
		if ( !( part.moves[0] && part.moves[1] && part.moves[2] && part.turns[0] && part.turns[1] && part.turns[2] ) )
		{
			groups.join( std::uint32_t( 1 + soft.size() + p ), 0 );
		}
	}
	for ( std::uint32_t first = 1; first < count; ++first )
	{
		if ( groups.find( first ) == first )
		{
			std::vector<int> softOnes, rigidOnes;
			for ( std::uint32_t other = first; other < count; ++other )
			{
				if ( groups.find( other ) == first )
				{
					const int p = int( other ) - 1;
					p < int( soft.size() ) ? softOnes.push_back( p ) : rigidOnes.push_back( p - int( soft.size() ) );
				}
			}
			keepMomentumOf( softOnes, rigidOnes );
		}
	}
}

void ImplicitBlock::keepMomentumOf( const std::vector<int>& softOnes, const std::vector<int>& rigidOnes )
{
	double mass = 0.0;
	Vec3d centre = Vec3d::Zero();
	for ( const int p : softOnes )
	{
		const double own = soft[std::size_t( p )].motion->rigidMass()( 0, 0 );
		mass += own;
		centre += own * worldCentre( soft[std::size_t( p )] );
	}
	for ( const int p : rigidOnes )
	{
		mass += rigid[std::size_t( p )].mass;
		centre += rigid[std::size_t( p )].mass * rigid[std::size_t( p )].centre;
	}
	centre /= mass;

	Matrix6 whole = Matrix6::Zero();
	Vector6 missing = Vector6::Zero();
	for ( const int p : softOnes )
	{
		const SoftPart& part = soft[std::size_t( p )];
		const Matrix6 own = part.motion->rigidMass();
		whole += massAbout( centre, own( 0, 0 ), own.bottomRightCorner<3, 3>(), worldCentre( part ) );
		missing += movedTo( centre, part.motion->missingMomentum(), worldCentre( part ) );
	}
	for ( const int p : rigidOnes )
	{
		const RigidPart& part = rigid[std::size_t( p )];
		whole += massAbout( centre, part.mass, part.inertia, part.centre );
		const Vector6 lacks = part.free - part.speed;
		Vector6 sums;
		sums << part.mass * lacks.head<3>(), part.inertia * lacks.tail<3>();
		missing += movedTo( centre, sums, part.centre );
	}
	const Vector6 motion = whole.inverse() * missing;
	for ( const int p : softOnes )
	{
		soft[std::size_t( p )].motion->addMotion( seenFrom( worldCentre( soft[std::size_t( p )] ), motion, centre ) );
	}
	for ( const int p : rigidOnes )
	{
		rigid[std::size_t( p )].speed += seenFrom( rigid[std::size_t( p )].centre, motion, centre );
	}
}

} // namespace pliant
