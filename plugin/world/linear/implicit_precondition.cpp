// What stands in front of an implicit block's system: nodes with their contacts (implicit_clusters.cpp), and, added to them, the contacts
// as whole bodies feel them, each rigid body with its 6 and each soft one, or each of the parts it is in, with its 12 affine motions
// (coarse_system.h).

#include "world/bodies/soft_body_impl.h"
#include "world/implicit/implicit_block.h"

#include <algorithm>

namespace pliant {

namespace {

Eigen::Matrix3d hat( const Vec3d& a )
{
	Eigen::Matrix3d m;
	m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
	return m;
}

/// How a whole body feels a contact: a node's u = V + L p by its arm, ( 1, p ) times the identity, a rigid body's point u = V + W x arm by
/// `turns`.
struct Feels
{
	int body = -1;
	bool isSoft = false;
	Eigen::Vector4d arm;
	Eigen::Matrix<double, 3, 6> turns;
};

template <int rows, int cols>
using Fixed = Eigen::Map<Eigen::Matrix<double, rows, cols>>;

/// piece += sign Ga^T R Gb, of rows of a and columns of b. Of a soft body's own piece what lies above the diagonal's 6 x 6 parts is left
/// out: nobody asks for it.
void addCoarse( const Feels& a, const Feels& b, const Eigen::Matrix3d& resists, double sign, double* piece )
{
	if ( a.isSoft ) // then b, which comes no later, is soft too
	{
		// By whole columns: column c of R times each of a's arms, then times b's.
		Fixed<12, 12> to( piece );
		for ( int c = 0; c < 3; ++c )
		{
			Eigen::Matrix<double, 12, 1> pressed;
			for ( int i = 0; i < 4; ++i )
			{
				pressed.segment<3>( 3 * i ) = ( sign * a.arm[i] ) * resists.col( c );
			}
			for ( int j = 0; j < 4; ++j )
			{
				if ( a.body == b.body && j >= 2 )
				{
					to.col( 3 * j + c ).tail<6>() += b.arm[j] * pressed.tail<6>();
				}
				else
				{
					to.col( 3 * j + c ) += b.arm[j] * pressed;
				}
			}
		}
		return;
	}
	const Eigen::Matrix<double, 6, 3> pressed = sign * a.turns.transpose() * resists;
	if ( !b.isSoft )
	{
		Fixed<6, 6>( piece ) += pressed * b.turns;
		return;
	}
	Fixed<6, 12> to( piece );
	for ( int j = 0; j < 4; ++j )
	{
		to.block<6, 3>( 0, 3 * j ) += b.arm[j] * pressed;
	}
}

} // namespace

/// k n n^T + kt S, the contact's resistance; S is 1 - n n^T where friction is the same in all directions.
Eigen::Matrix3d ImplicitBlock::resistance( const BlockContact& contact ) const
{
	const Eigen::Matrix3d press = contact.normal * contact.normal.transpose();
	const Eigen::Matrix3d rub = contact.directed < 0 ? Eigen::Matrix3d( Eigen::Matrix3d::Identity() - press )
													 : directions[std::size_t( contact.directed )];
	return contact.stiffness * press + contact.tangentStiffness * rub;
}

void ImplicitBlock::layOutCoarse()
{
	m_coarseSizes.clear();
	for ( Connected& own : m_connected )
	{
		const ImplicitMotion& motion = *soft[std::size_t( own.soft )].motion;
		if ( motion.isElastic() && motion.hasShape( own.part ) )
		{
			own.coarse = int( m_coarseSizes.size() );
			m_coarseSizes.push_back( 12 );
		}
	}
	for ( RigidPart& part : rigid )
	{
		part.coarse = int( m_coarseSizes.size() );
		m_coarseSizes.push_back( 6 );
	}
	// All contacts: which of them press is another matter in each pass.
	const auto bodyOf = [this]( const ContactSide& side ) {
		return side.soft >= 0 ? connectedOf( side ).coarse : side.rigid >= 0 ? rigid[std::size_t( side.rigid )].coarse : -1;
	};
	m_coarsePairs.clear();
	for ( const BlockContact& contact : contacts )
	{
		const int a = bodyOf( contact.side[0] ), b = bodyOf( contact.side[1] );
		if ( a >= 0 && b >= 0 && a != b )
		{
			m_coarsePairs.emplace_back( std::max( a, b ), std::min( a, b ) );
		}
	}
	m_coarse.layOut( m_coarseSizes, m_coarsePairs );
}

void ImplicitBlock::addToPreconditioner( const BlockContact& contact )
{
	const Eigen::Matrix3d resists = resistance( contact );
	addToClusters( contact, resists );
	Feels feels[2];
	for ( int k = 0; k < 2; ++k )
	{
		const ContactSide& side = contact.side[k];
		Feels& own = feels[k];
		if ( side.soft >= 0 )
		{
			const SoftPart& part = soft[std::size_t( side.soft )];
			own.body = connectedOf( side ).coarse;
			own.isSoft = true;
			if ( own.body >= 0 )
			{
				Vec3d arm = Vec3d::Zero();
				for ( int j = 0; j < side.shared.count; ++j )
				{
					arm += side.shared.rub[j] * part.motion->arm( side.shared.node[j] );
				}
				own.arm << 1.0, arm;
			}
		}
		else if ( side.rigid >= 0 )
		{
			own.body = rigid[std::size_t( side.rigid )].coarse;
			own.turns << Eigen::Matrix3d::Identity(), -hat( side.arm );
		}
	}
	for ( int a = 0; a < 2; ++a )
	{
		for ( int b = 0; b < 2; ++b )
		{
			if ( feels[b].body >= 0 && feels[a].body >= feels[b].body )
			{
				addCoarse( feels[a], feels[b], resists, a == b ? 1.0 : -1.0, m_coarse.block( feels[a].body, feels[b].body ).data() );
			}
		}
	}
}

/// A rigid body's locked axes take no part.
void ImplicitBlock::lockAxes( const RigidPart& part, int body )
{
	for ( int k = 0; k < 6; ++k )
	{
		if ( k < 3 ? part.moves[k] : part.turns[k - 3] )
		{
			continue;
		}
		for ( int other = 0; other < int( m_coarseSizes.size() ); ++other )
		{
			if ( m_coarse.has( std::max( body, other ), std::min( body, other ) ) )
			{
				CoarseSystem::Piece piece = m_coarse.block( std::max( body, other ), std::min( body, other ) );
				if ( body >= other )
				{
					piece.row( k ).setZero();
				}
				if ( body <= other )
				{
					piece.col( k ).setZero();
				}
			}
		}
		m_coarse.block( body, body )( k, k ) = 1.0;
	}
}

void ImplicitBlock::fillPreconditioner()
{
	beginClusters();
	m_coarse.clear();
	for ( const Connected& own : m_connected )
	{
		if ( own.coarse >= 0 )
		{
			m_coarse.block( own.coarse, own.coarse ) = soft[std::size_t( own.soft )].motion->affineMatrix( own.part );
		}
	}
	for ( const RigidPart& part : rigid )
	{
		CoarseSystem::Piece piece = m_coarse.block( part.coarse, part.coarse );
		piece.block<3, 3>( 0, 0 ) = part.mass * Eigen::Matrix3d::Identity();
		piece.block<3, 3>( 3, 3 ) = part.inertia;
	}
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.presses )
		{
			addToPreconditioner( contact );
		}
	}
	for ( const RigidPart& part : rigid )
	{
		lockAxes( part, part.coarse );
	}
	m_coarse.factor();
	m_coarseSums.resize( m_coarse.size() );
	invertClusters();
}

void ImplicitBlock::precondition( const float* r, float* z )
{
	std::fill( z, z + m_size, 0.0f );
	for ( const SoftPart& part : soft )
	{
		const int padded = part.motion->padded();
		const float* const inverse = m_inverseDiagonal.data() + part.offset;
		for ( int k = 0; k < 3; ++k )
		{
			const float* const from = r + part.offset + k * padded;
			float* const to = z + part.offset + k * padded;
			for ( int i = 0; i < padded; ++i )
			{
				to[i] = inverse[i] * from[i];
			}
		}
	}
	for ( const Connected& own : m_connected )
	{
		if ( own.coarse >= 0 )
		{
			const SoftPart& part = soft[std::size_t( own.soft )];
			m_coarseSums.segment<12>( m_coarse.offset( own.coarse ) ) = part.motion->affineSums( r + part.offset, own.part );
		}
	}
	preconditionClusters( r, z );
	for ( const RigidPart& part : rigid )
	{
		m_coarseSums.segment<6>(
			m_coarse.offset( part.coarse ) ) = Eigen::Map<const Eigen::Matrix<float, 6, 1>>( r + part.offset ).cast<double>();
	}
	m_coarse.solve( m_coarseSums, m_coarseMotion );
	for ( const Connected& own : m_connected )
	{
		if ( own.coarse >= 0 )
		{
			const SoftPart& part = soft[std::size_t( own.soft )];
			part.motion->addAffine( m_coarseMotion.segment<12>( m_coarse.offset( own.coarse ) ), z + part.offset, own.part );
		}
	}
	for ( const RigidPart& part : rigid )
	{
		Eigen::Map<Eigen::Matrix<float, 6, 1>> to( z + part.offset );
		to = m_coarseMotion.segment<6>( m_coarse.offset( part.coarse ) ).cast<float>();
	}
}

} // namespace pliant
