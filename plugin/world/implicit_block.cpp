#include "world/implicit_block.h"

#include "world/constants.h"
#include "world/soft_body_impl.h"

#include <algorithm>

namespace pliant {

namespace {

Eigen::Matrix3d hat( const Vec3d& a )
{
	Eigen::Matrix3d m;
	m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
	return m;
}

/// k n n^T + kt ( 1 - n n^T ), the contact's resistance.
Eigen::Matrix3d resistance( const BlockContact& contact )
{
	const Eigen::Matrix3d across = contact.normal * contact.normal.transpose();
	return contact.stiffness * across + contact.tangentStiffness * ( Eigen::Matrix3d::Identity() - across );
}

Matrix6 atArm( const Eigen::Matrix3d& resists, const Vec3d& arm )
{
	// u = V + W x arm: J = ( 1, - hat( arm ) )
	Eigen::Matrix<double, 3, 6> j;
	j << Eigen::Matrix3d::Identity(), -hat( arm );
	return j.transpose() * resists * j;
}

} // namespace

void ImplicitBlock::clear()
{
	soft.clear();
	rigid.clear();
	contacts.clear();
}

void ImplicitBlock::layOut()
{
	m_size = 0;
	m_softMass = 0.0;
	for ( SoftPart& part : soft )
	{
		part.offset = m_size;
		m_size += part.motion->size();
		for ( int i = 0; i < part.motion->nodes().count; ++i )
		{
			m_softMass += double( part.motion->nodes().mass[i] );
		}
	}
	for ( RigidPart& part : rigid )
	{
		part.offset = m_size;
		m_size += 6;
	}
	m_size = ( m_size + kLanes - 1 ) / kLanes * kLanes;
	for ( AlignedArray<float>* array : { &m_v, &m_next, &m_rightSide, &m_masses, &m_scratch, &m_inverseDiagonal } )
	{
		array->assign( std::size_t( m_size ), 0.0f );
	}
	for ( const SoftPart& part : soft )
	{
		startFrom( part );
	}
	for ( const RigidPart& part : rigid )
	{
		for ( int k = 0; k < 6; ++k )
		{
			m_v[std::size_t( part.offset + k )] = float( part.before[k] );
		}
	}
	nameNodeBlocks();
}

/// The iteration begins with the speeds of the substep's start; what is held has its speed already.
void ImplicitBlock::startFrom( const SoftPart& part )
{
	const int padded = part.motion->padded();
	const AlignedArray<float>* const from[3] = { &part.before->x, &part.before->y, &part.before->z };
	for ( int k = 0; k < 3; ++k )
	{
		std::copy( from[k]->begin(), from[k]->begin() + padded, m_v.begin() + part.offset + k * padded );
	}
	const NodeState& nodes = part.motion->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		m_inverseDiagonal[std::size_t( part.offset + i )] = nodes.freedom[i] / part.motion->diagonal( i );
		for ( int k = 0; k < 3 && nodes.freedom[i] == 0.0f; ++k )
		{
			m_v[std::size_t( part.offset + k * padded + i )] = nodes.v.get( i )[k];
		}
	}
}

void ImplicitBlock::nameNodeBlocks()
{
	m_nodeBlocks.clear();
	m_blockOf.assign( std::size_t( m_size ), -1 );
	for ( BlockContact& contact : contacts )
	{
		for ( ContactSide& side : contact.side )
		{
			if ( side.soft < 0 )
			{
				continue;
			}
			int& block = m_blockOf[std::size_t( soft[std::size_t( side.soft )].offset + side.node )];
			if ( block < 0 )
			{
				block = int( m_nodeBlocks.size() );
				m_nodeBlocks.push_back( NodeBlock{ side.soft, side.node } );
			}
			side.block = block;
		}
	}
}

Vec3d ImplicitBlock::speedOf( const ContactSide& side, const float* v ) const
{
	if ( side.soft >= 0 )
	{
		const SoftPart& part = soft[std::size_t( side.soft )];
		const float* at = v + part.offset + side.node;
		const int padded = part.motion->padded();
		return { double( at[0] ), double( at[padded] ), double( at[2 * padded] ) };
	}
	if ( side.rigid >= 0 )
	{
		const Eigen::Map<const Eigen::Matrix<float, 6, 1>> at( v + rigid[std::size_t( side.rigid )].offset );
		const Vec3d turn = at.tail<3>().cast<double>();
		return at.head<3>().cast<double>() + turn.cross( side.arm );
	}
	return Vec3d::Zero();
}

Vec3d ImplicitBlock::relativeSpeed( const BlockContact& contact, const float* v ) const
{
	return ( speedOf( contact.side[0], v ) + contact.side[0].given ) - ( speedOf( contact.side[1], v ) + contact.side[1].given );
}

void ImplicitBlock::addImpulse( const ContactSide& side, const Vec3d& impulse, float* to ) const
{
	if ( side.soft >= 0 )
	{
		const SoftPart& part = soft[std::size_t( side.soft )];
		float* const at = to + part.offset + side.node;
		const int padded = part.motion->padded();
		for ( int k = 0; k < 3; ++k )
		{
			at[k * padded] += float( impulse[k] );
		}
	}
	else if ( side.rigid >= 0 )
	{
		const RigidPart& part = rigid[std::size_t( side.rigid )];
		float* const at = to + part.offset;
		const Vec3d turn = side.arm.cross( impulse );
		for ( int k = 0; k < 3; ++k )
		{
			at[k] += part.moves[k] ? float( impulse[k] ) : 0.0f;
			at[3 + k] += part.turns[k] ? float( turn[k] ) : 0.0f;
		}
	}
}

void ImplicitBlock::addPair( const BlockContact& contact, const Vec3d& impulse, float* to ) const
{
	addImpulse( contact.side[0], impulse, to );
	addImpulse( contact.side[1], -impulse, to );
}

void ImplicitBlock::applyMasses( const float* v, float* to )
{
	for ( const SoftPart& part : soft )
	{
		part.motion->apply( v + part.offset, to + part.offset, m_runner );
	}
	for ( const RigidPart& part : rigid )
	{
		const float* from = v + part.offset;
		const Vec3d spin = part.inertia * Vec3d( double( from[3] ), double( from[4] ), double( from[5] ) );
		for ( int k = 0; k < 3; ++k )
		{
			to[part.offset + k] = part.moves[k] ? float( part.mass * double( from[k] ) ) : 0.0f;
			to[part.offset + 3 + k] = part.turns[k] ? float( spin[k] ) : 0.0f;
		}
	}
	const int used = rigid.empty() ? ( soft.empty() ? 0 : soft.back().offset + soft.back().motion->size() ) : rigid.back().offset + 6;
	std::fill( to + used, to + m_size, 0.0f );
}

void ImplicitBlock::apply( const float* v, float* to )
{
	applyMasses( v, to );
	for ( const BlockContact& contact : contacts )
	{
		if ( !contact.presses )
		{
			continue;
		}
		const Vec3d u = speedOf( contact.side[0], v ) - speedOf( contact.side[1], v );
		const double along = contact.normal.dot( u );
		addPair( contact, ( contact.stiffness - contact.tangentStiffness ) * along * contact.normal + contact.tangentStiffness * u, to );
	}
}

void ImplicitBlock::fillRightSide()
{
	for ( const SoftPart& part : soft )
	{
		std::copy( part.motion->rightSide(), part.motion->rightSide() + part.motion->size(), m_rightSide.begin() + part.offset );
	}
	for ( const RigidPart& part : rigid )
	{
		const Vec3d spin = part.inertia * part.free.tail<3>();
		for ( int k = 0; k < 3; ++k )
		{
			m_rightSide[std::size_t( part.offset + k )] = part.moves[k] ? float( part.mass * part.free[k] ) : 0.0f;
			m_rightSide[std::size_t( part.offset + 3 + k )] = part.turns[k] ? float( spin[k] ) : 0.0f;
		}
	}
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.presses )
		{
			const Vec3d given = contact.side[0].given - contact.side[1].given;
			const double along = contact.normal.dot( given );
			const Vec3d across = given - along * contact.normal;
			addPair( contact, ( contact.pushed + contact.stiffness * ( contact.target - along ) ) * contact.normal + contact.held - contact.tangentStiffness * across,
				m_rightSide.data() );
		}
	}
}

void ImplicitBlock::addToPreconditioner( const BlockContact& contact )
{
	const Eigen::Matrix3d resists = resistance( contact );
	for ( const ContactSide& side : contact.side )
	{
		if ( side.soft >= 0 )
		{
			SoftPart& part = soft[std::size_t( side.soft )];
			m_nodeBlocks[std::size_t( side.block )].matrix += resists;
			const Vec3d arm = part.motion->nodes().x.get( side.node ).cast<double>() - part.motion->centre();
			part.inverseRigid += atArm( resists, arm );
		}
		else if ( side.rigid >= 0 )
		{
			rigid[std::size_t( side.rigid )].inverse += atArm( resists, side.arm );
		}
	}
}

// In front of the system: 3x3 of each node with its contacts, 6x6 of each rigid body with its contacts, and, added to the nodes', 6x6 of each
// soft body's motion as a whole, which the nodes' own blocks hardly move where the body is stiff.
void ImplicitBlock::fillPreconditioner()
{
	for ( NodeBlock& block : m_nodeBlocks )
	{
		block.matrix = double( soft[std::size_t( block.part )].motion->diagonal( block.node ) ) * Eigen::Matrix3d::Identity();
	}
	for ( SoftPart& part : soft )
	{
		part.inverseRigid = part.motion->isElastic() ? part.motion->rigidMass() : Matrix6::Zero();
	}
	for ( RigidPart& part : rigid )
	{
		part.inverse.setZero();
		part.inverse.topLeftCorner<3, 3>() = part.mass * Eigen::Matrix3d::Identity();
		part.inverse.bottomRightCorner<3, 3>() = part.inertia;
	}
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.presses )
		{
			addToPreconditioner( contact );
		}
	}
	for ( NodeBlock& block : m_nodeBlocks )
	{
		block.matrix = block.matrix.inverse().eval();
	}
	for ( SoftPart& part : soft )
	{
		const bool asWhole = part.motion->isElastic() && !part.motion->hasHeldNodes();
		part.inverseRigid = asWhole ? Matrix6( part.inverseRigid.inverse() ) : Matrix6( Matrix6::Zero() );
	}
	for ( RigidPart& part : rigid )
	{
		for ( int k = 0; k < 6; ++k )
		{
			if ( !( k < 3 ? part.moves[k] : part.turns[k - 3] ) )
			{
				part.inverse.row( k ).setZero();
				part.inverse.col( k ).setZero();
				part.inverse( k, k ) = 1.0;
			}
		}
		part.inverse = part.inverse.inverse().eval();
	}
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
	for ( const NodeBlock& block : m_nodeBlocks )
	{
		const SoftPart& part = soft[std::size_t( block.part )];
		const int padded = part.motion->padded(), at = part.offset + block.node;
		const Vec3d value = block.matrix * Vec3d( double( r[at] ), double( r[at + padded] ), double( r[at + 2 * padded] ) );
		for ( int k = 0; k < 3; ++k )
		{
			z[at + k * padded] = float( value[k] );
		}
	}
	for ( const SoftPart& part : soft )
	{
		if ( part.motion->isElastic() && !part.motion->hasHeldNodes() )
		{
			part.motion->addRigid( part.inverseRigid * part.motion->rigidSums( r + part.offset ), z + part.offset );
		}
	}
	for ( const RigidPart& part : rigid )
	{
		const Vector6 value = part.inverse * Eigen::Map<const Eigen::Matrix<float, 6, 1>>( r + part.offset ).cast<double>();
		for ( int k = 0; k < 6; ++k )
		{
			z[part.offset + k] = float( value[k] );
		}
	}
}

BlockCount ImplicitBlock::solve( TaskRunner* runner )
{
	BlockCount count;
	m_runner = runner;
	layOut();
	chooseStiffness();
	linearise( m_v.data() );
	while ( true )
	{
		fillRightSide();
		fillPreconditioner();
		m_next = m_v;
		const GradientLimits limits{ kGradientShare, m_softMass * double( kGradientSpeed ) * double( kGradientSpeed ), kMostGradients };
		count.products += m_gradients.solve( *this, m_rightSide.data(), m_next.data(), limits ) + 1;
		++count.passes;
		readImpulses( m_next.data() );
		if ( count.passes == kMostPasses || countChanged( m_next.data() ) == 0 )
		{
			break;
		}
		// The first step is taken whole: it brings the forces that the start lacks.
		const float t = count.passes == 1 ? 1.0f : float( stepTowards( m_next.data() ) );
		for ( int k = 0; k < m_size; ++k )
		{
			m_v[k] += t * ( m_next[k] - m_v[k] );
		}
		linearise( m_v.data() );
	}
	m_v = m_next;
	readAnswer();
	keepMomentum();
	return count;
}

void ImplicitBlock::readAnswer()
{
	for ( SoftPart& part : soft )
	{
		part.motion->setSpeeds( m_v.data() + part.offset );
	}
	for ( RigidPart& part : rigid )
	{
		for ( int k = 0; k < 6; ++k )
		{
			part.speed[k] = double( m_v[std::size_t( part.offset + k )] );
		}
	}
}

} // namespace pliant
