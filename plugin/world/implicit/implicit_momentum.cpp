// Momentum that the end of the iteration must not lose.

#include "world/bodies/soft_body_impl.h"
#include "world/implicit/implicit_block.h"

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

} // namespace

// The iteration ends early and in float. What is then missing of the momentum of what touches nothing fixed is given to all that touches
// each other together, as one rigid motion: given to the light ones alone it would throw them. Parts of one soft body that nothing links
// are as many bodies here.
void ImplicitBlock::keepMomentum()
{
	const std::size_t parts = m_connected.size(), count = 1 + parts + rigid.size(); // 0 is what is fixed
	UnionFind groups( count );
	const auto placeOf = [&]( const ContactSide& side ) {
		return std::uint32_t( side.soft >= 0 ? 1 + std::size_t( &connectedOf( side ) - m_connected.data() )
				: side.rigid >= 0            ? 1 + parts + std::size_t( side.rigid )
											 : 0 );
	};
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.normalImpulse != 0.0 )
		{
			groups.join( placeOf( contact.side[0] ), placeOf( contact.side[1] ) );
		}
	}
	for ( std::size_t p = 0; p < parts; ++p )
	{
		if ( soft[std::size_t( m_connected[p].soft )].motion->isHeld( m_connected[p].part ) )
		{
			groups.join( std::uint32_t( 1 + p ), 0 );
		}
	}
	for ( std::size_t p = 0; p < rigid.size(); ++p )
	{
		const RigidPart& part = rigid[p];
		if ( !( part.moves[0] && part.moves[1] && part.moves[2] && part.turns[0] && part.turns[1] && part.turns[2] ) )
		{
			groups.join( std::uint32_t( 1 + parts + p ), 0 );
		}
	}
	// Groups in the order of their lowest, each with its members ascending.
	m_groupStart.assign( count + 1, 0 );
	for ( std::uint32_t k = 0; k < count; ++k )
	{
		++m_groupStart[groups.find( k ) + 1];
	}
	for ( std::size_t k = 0; k < count; ++k )
	{
		m_groupStart[k + 1] += m_groupStart[k];
	}
	m_groupMembers.resize( count );
	for ( std::uint32_t k = 0; k < count; ++k )
	{
		m_groupMembers[m_groupStart[groups.find( k )]++] = k; // which moves each start to the next one's
	}
	for ( std::size_t group = 1; group < count; ++group )
	{
		if ( m_groupStart[group - 1] < m_groupStart[group] )
		{
			keepMomentumOf( m_groupMembers.data() + m_groupStart[group - 1], m_groupMembers.data() + m_groupStart[group] );
		}
	}
}

/// Something that moves as a whole: `k` as in keepMomentum.
ImplicitBlock::Mover ImplicitBlock::moverAt( std::uint32_t k )
{
	Mover mover;
	if ( k <= m_connected.size() )
	{
		const Connected& own = m_connected[k - 1];
		mover.motion = soft[std::size_t( own.soft )].motion;
		mover.part = own.part;
		mover.centre = mover.motion->nodes().origin + mover.motion->centre( own.part );
		mover.mass = mover.motion->rigidMass( own.part );
		mover.missing = mover.motion->missingMomentum( own.part );
		return mover;
	}
	mover.rigid = &rigid[k - 1 - m_connected.size()];
	const Vector6 lacks = mover.rigid->free - mover.rigid->speed;
	mover.centre = mover.rigid->centre;
	mover.mass( 0, 0 ) = mover.rigid->mass;
	mover.mass.bottomRightCorner<3, 3>() = mover.rigid->inertia;
	mover.missing << mover.rigid->mass * lacks.head<3>(), mover.rigid->inertia * lacks.tail<3>();
	return mover;
}

void ImplicitBlock::keepMomentumOf( const std::uint32_t* begin, const std::uint32_t* end )
{
	double mass = 0.0;
	Vec3d centre = Vec3d::Zero();
	m_movers.clear();
	for ( const std::uint32_t* k = begin; k < end; ++k )
	{
		const Mover& mover = m_movers.emplace_back( moverAt( *k ) );
		mass += mover.mass( 0, 0 );
		centre += mover.mass( 0, 0 ) * mover.centre;
	}
	centre /= mass;

	Matrix6 whole = Matrix6::Zero();
	Vector6 missing = Vector6::Zero();
	for ( const Mover& mover : m_movers )
	{
		whole += massAbout( centre, mover.mass( 0, 0 ), mover.mass.bottomRightCorner<3, 3>(), mover.centre );
		missing += movedTo( centre, mover.missing, mover.centre );
	}
	const Vector6 motion = whole.inverse() * missing;
	for ( const Mover& mover : m_movers )
	{
		const Vector6 seen = seenFrom( mover.centre, motion, centre );
		if ( mover.motion )
		{
			mover.motion->addMotion( seen, mover.part );
		}
		else
		{
			mover.rigid->speed += seen;
		}
	}
}

} // namespace pliant
