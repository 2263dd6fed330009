// The preconditioner of a block: the diagonal and the clusters of nodes in contact (block_clusters.cpp), plus the coarse
// system (coarse_system.h) with 6 unknowns per rigid body and the 12 affine motions of each connected part of a soft body.

#include "matching/rotation.h"
#include "world/block/island_block.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <algorithm>

namespace pliant {

namespace {

/// The velocity of a contact point in terms of a body's coarse unknowns: of a soft body u = V + L p, with `arm` = ( 1, p ); of a rigid body
/// u = V + W x r, with `jacobian`.
struct CoarseSide
{
	int body = -1;
	bool isSoft = false;
	Eigen::Vector4d arm;
	Eigen::Matrix<double, 3, 6> jacobian;
};

template <int rows, int cols>
using Fixed = Eigen::Map<Eigen::Matrix<double, rows, cols>>;

/// piece += sign Ga^T R Gb, with the rows of a and the columns of b. In a soft body's own piece the blocks above the diagonal 6 x 6 blocks
/// are omitted, since they are never read.
void addCoarse( const CoarseSide& a, const CoarseSide& b, const Eigen::Matrix3d& contactResistance, double sign, double* piece )
{
	if ( a.isSoft ) // then b, which has no higher index, is soft too
	{
		// Column by column: column c of R times each component of a's arm, then times b's.
		Fixed<12, 12> to( piece );
		for ( int c = 0; c < 3; ++c )
		{
			Eigen::Matrix<double, 12, 1> force;
			for ( int i = 0; i < 4; ++i )
			{
				force.segment<3>( 3 * i ) = ( sign * a.arm[i] ) * contactResistance.col( c );
			}
			for ( int j = 0; j < 4; ++j )
			{
				if ( a.body == b.body && j >= 2 )
				{
					to.col( 3 * j + c ).tail<6>() += b.arm[j] * force.tail<6>();
				}
				else
				{
					to.col( 3 * j + c ) += b.arm[j] * force;
				}
			}
		}
		return;
	}
	const Eigen::Matrix<double, 6, 3> force = sign * a.jacobian.transpose() * contactResistance;
	if ( !b.isSoft )
	{
		Fixed<6, 6>( piece ) += force * b.jacobian;
		return;
	}
	Fixed<6, 12> to( piece );
	for ( int j = 0; j < 4; ++j )
	{
		to.block<6, 3>( 0, 3 * j ) += b.arm[j] * force;
	}
}

} // namespace

// k n n^T + kt S, with S = 1 - n n^T for isotropic friction.
Eigen::Matrix3d IslandBlock::resistance( const BlockContact& contact ) const
{
	const Eigen::Matrix3d normalPart = contact.normal * contact.normal.transpose();
	const Eigen::Matrix3d tangentPart = contact.frictionScale < 0 ? Eigen::Matrix3d( Eigen::Matrix3d::Identity() - normalPart )
																  : frictionScales[std::size_t( contact.frictionScale )];
	return contact.stiffness * normalPart + contact.tangentStiffness * tangentPart;
}

int IslandBlock::coarseOf( const ContactSide& side ) const
{
	const ConnectedPart& own = connectedOf( side );
	return own.segments ? own.coarse + own.segments->of( side.node ) : own.coarse;
}

void IslandBlock::layOutCoarse()
{
	m_coarseSizes.clear();
	const bool areMany = m_connected.size() > kManyParts;
	for ( ConnectedPart& own : m_connected )
	{
		SoftPart& part = soft[std::size_t( own.soft )];
		const Body& body = *part.owner->impl().body;
		own.segments = part.motion->isElastic() && !body.levels() ? part.motion->segments( body.lattice() ) : nullptr;
		const bool isSoftPiece = areMany && part.motion->stiffness() < kLeastWholeStiffness &&
			part.motion->nodes().count < kLeastWholeNodes;
		if ( part.motion->isElastic() && !isSoftPiece && part.motion->hasShape( own.part ) && !own.segments )
		{
			own.coarse = int( m_coarseSizes.size() );
			m_coarseSizes.push_back( 12 );
		}
	}
	for ( ConnectedPart& own : m_connected ) // after those of 12 unknowns: addCoarse relies on it
	{
		if ( own.segments )
		{
			own.coarse = int( m_coarseSizes.size() );
			m_coarseSizes.insert( m_coarseSizes.end(), std::size_t( own.segments->count() ), 6 );
		}
	}
	for ( RigidPart& part : rigid )
	{
		part.coarse = int( m_coarseSizes.size() );
		m_coarseSizes.push_back( 6 );
	}
	// All contacts, because the active ones change from pass to pass.
	const auto bodyOf = [this]( const ContactSide& side ) {
		return side.soft >= 0 ? coarseOf( side ) : side.rigid >= 0 ? rigid[std::size_t( side.rigid )].coarse : -1;
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
	for ( const ConnectedPart& own : m_connected )
	{
		for ( std::size_t k = 0; own.segments && k < own.segments->pairs().size(); ++k )
		{
			const Segments::Pair& pair = own.segments->pairs()[k];
			m_coarsePairs.emplace_back( own.coarse + pair.first, own.coarse + pair.second );
		}
	}
	for ( const LinkedParts& whole : linked )
	{
		forLinkPairs( whole, [&]( int, int, int upper, int lower ) { m_coarsePairs.emplace_back( upper, lower ); } );
	}
	m_coarse.layOut( m_coarseSizes, m_coarsePairs );
}

void IslandBlock::addToPreconditioner( const BlockContact& contact )
{
	const Eigen::Matrix3d contactResistance = resistance( contact );
	addToClusters( contact, contactResistance );
	CoarseSide sides[2];
	for ( int k = 0; k < 2; ++k )
	{
		const ContactSide& side = contact.side[k];
		CoarseSide& own = sides[k];
		if ( side.soft >= 0 )
		{
			const SoftPart& part = soft[std::size_t( side.soft )];
			own.body = coarseOf( side );
			const Segments* const segments = connectedOf( side ).segments;
			own.isSoft = !segments;
			if ( segments )
			{
				Vec3d at = Vec3d::Zero();
				for ( int j = 0; j < side.shared.count; ++j )
				{
					at += side.shared.rub[j] * part.motion->nodes().x.get( side.shared.node[j] ).cast<double>();
				}
				own.jacobian << Eigen::Matrix3d::Identity(), -crossMatrix( at - segments->centre( segments->of( side.node ) ) );
			}
			else if ( own.body >= 0 )
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
			own.jacobian << Eigen::Matrix3d::Identity(), -crossMatrix( side.arm );
		}
	}
	for ( int a = 0; a < 2; ++a )
	{
		for ( int b = 0; b < 2; ++b )
		{
			if ( sides[b].body >= 0 && sides[a].body >= sides[b].body )
			{
				addCoarse(
					sides[a], sides[b], contactResistance, a == b ? 1.0 : -1.0, m_coarse.block( sides[a].body, sides[b].body ).data() );
			}
		}
	}
}

// Removes the locked axes of a rigid body from the coarse system.
void IslandBlock::lockAxes( const RigidPart& part, int body )
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

// Made when a pass first needs it: sweeps need none.
void IslandBlock::layOutPreconditioner()
{
	m_hasPreconditioner = true;
	m_clusters.clear();
	std::for_each( contacts.begin(), contacts.end(), [this]( const BlockContact& contact ) { assignClusters( contact ); } );
	layOutCoarse();
}

void IslandBlock::fillPreconditioner()
{
	if ( !m_hasPreconditioner )
	{
		layOutPreconditioner();
	}
	beginClusters();
	m_coarse.clear();
	for ( const ConnectedPart& own : m_connected )
	{
		if ( own.segments )
		{
			for ( int k = 0; k < own.segments->count(); ++k )
			{
				m_coarse.block( own.coarse + k, own.coarse + k ) = own.segments->own( k );
			}
			for ( const Segments::Pair& pair : own.segments->pairs() )
			{
				m_coarse.block( own.coarse + pair.first, own.coarse + pair.second ) = pair.coupling;
			}
		}
		else if ( own.coarse >= 0 )
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
	for ( const LinkedParts& whole : linked )
	{
		forLinkPairs(
			whole, [&]( int a, int b, int upper, int lower ) { m_coarse.block( upper, lower ) = whole.mass.block<6, 6>( 6 * a, 6 * b ); } );
	}
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.isActive )
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

void IslandBlock::precondition( const float* r, float* z )
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
	for ( const ConnectedPart& own : m_connected )
	{
		if ( own.coarse >= 0 )
		{
			const SoftPart& part = soft[std::size_t( own.soft )];
			if ( own.segments )
			{
				own.segments->sum( part.motion->nodes(), r + part.offset, m_coarseSums.data() + m_coarse.offset( own.coarse ) );
				continue;
			}
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
	for ( const ConnectedPart& own : m_connected )
	{
		if ( own.coarse >= 0 )
		{
			const SoftPart& part = soft[std::size_t( own.soft )];
			if ( own.segments )
			{
				own.segments->addMotions( part.motion->nodes(), m_coarseMotion.data() + m_coarse.offset( own.coarse ), z + part.offset );
				continue;
			}
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
