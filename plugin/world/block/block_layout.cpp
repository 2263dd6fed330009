// The layout of a block's vectors, and the initial guess of its iteration.

#include "world/block/island_block.h"

#include "body/implicit/touched_nodes.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <algorithm>

namespace pliant {

void IslandBlock::compact()
{
	for ( BlockContact& contact : contacts )
	{
		for ( ContactSide& side : contact.side )
		{
			TouchedNodes* const touched = side.soft >= 0 ? soft[std::size_t( side.soft )].touched : nullptr;
			for ( int j = 0; touched && j < side.shared.count; ++j )
			{
				side.shared.node[j] = touched->add( side.shared.node[j] );
			}
			side.node = touched ? touched->add( side.node ) : side.node;
		}
	}
	for ( SoftPart& part : soft )
	{
		if ( part.touched )
		{
			part.touched->finish();
			part.velocityBefore = &part.touched->velocityBefore();
		}
	}
}

ImplicitMotion& IslandBlock::wholeOf( SoftPart& part )
{
	if ( part.touched && !part.whole )
	{
		part.whole = &part.owner->impl().body->measureRigidMotions();
	}
	return part.touched ? *part.whole : *part.motion;
}

void IslandBlock::layOut()
{
	compact();
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
	m_v.assign( std::size_t( m_size ), 0.0f );
	m_inverseDiagonal.assign( std::size_t( m_size ), 0.0f );
	for ( AlignedArray<float>* array : { &m_next, &m_rightSide, &m_free, &m_freeNext, &m_massProduct, &m_scratch } )
	{
		array->resize( std::size_t( m_size ) ); // each is fully written before it is read
	}
	listConnected();
	for ( const SoftPart& part : soft )
	{
		startFrom( part );
	}
	for ( const RigidPart& part : rigid )
	{
		for ( int k = 0; k < 6; ++k )
		{
			m_v[std::size_t( part.offset + k )] = float( part.velocityBefore[k] );
		}
	}
	registerNodeBlocks();
	m_hasPreconditioner = false;
}

void IslandBlock::listConnected()
{
	m_connected.clear();
	for ( std::size_t p = 0; p < soft.size(); ++p )
	{
		soft[p].firstConnected = int( m_connected.size() );
		for ( int part = 0; part < soft[p].motion->parts().count(); ++part )
		{
			m_connected.push_back( ConnectedPart{ int( p ), part } );
		}
	}
	for ( const BlockContact& contact : contacts )
	{
		for ( const ContactSide& side : contact.side )
		{
			if ( side.soft >= 0 )
			{
				m_connected[std::size_t( &connectedOf( side ) - m_connected.data() )].touches = true;
			}
		}
	}
}

// The initial guess is the velocities at the start of the substep; held nodes keep their prescribed ones. A body without contacts and held
// nodes starts from the velocities of free flight, which solve the system if it is not strained. So does each connected part without
// contacts and held nodes, and each node without contacts of a body that steps explicitly.
void IslandBlock::startFrom( const SoftPart& part )
{
	const int padded = part.motion->padded();
	const bool isFree = !part.motion->isElastic() || ( contacts.empty() && !part.motion->hasHeldNodes() );
	const Vec3Array& start = isFree ? part.motion->nodes().v : *part.velocityBefore;
	const AlignedArray<float>* const from[3] = { &start.x, &start.y, &start.z };
	for ( int k = 0; k < 3; ++k )
	{
		std::copy( from[k]->begin(), from[k]->begin() + padded, m_v.begin() + part.offset + k * padded );
	}
	const NodeState& nodes = part.motion->nodes();
	const ConnectedParts& parts = part.motion->parts();
	for ( int i = 0; parts.areSeveral() && i < nodes.count; ++i )
	{
		const int own = parts.partOf( i );
		for ( int k = 0; !m_connected[std::size_t( part.firstConnected + own )].touches && !part.motion->isHeld( own ) && k < 3; ++k )
		{
			m_v[std::size_t( part.offset + k * padded + i )] = nodes.v.get( i )[k];
		}
	}
	for ( int i = 0; i < nodes.count; ++i )
	{
		m_inverseDiagonal[std::size_t( part.offset + i )] = nodes.freedom[i] / part.motion->diagonal( i );
		for ( int k = 0; k < 3 && nodes.freedom[i] == 0.0f; ++k )
		{
			m_v[std::size_t( part.offset + k * padded + i )] = nodes.v.get( i )[k];
		}
	}
}

void IslandBlock::startFromBefore( const SoftPart& part, int node )
{
	const Vec3 before = part.velocityBefore->get( node );
	for ( int k = 0; part.motion->nodes().freedom[node] != 0.0f && k < 3; ++k )
	{
		m_v[std::size_t( part.offset + k * part.motion->padded() + node )] = before[k];
	}
}

void IslandBlock::registerNodeBlocks()
{
	std::for_each(
		m_nodeBlocks.begin(), m_nodeBlocks.end(), [this]( const NodeBlock& named ) { m_blockOf[std::size_t( named.index )] = -1; } );
	m_nodeBlocks.clear();
	m_blockOf.resize( std::max( m_blockOf.size(), std::size_t( m_size ) ), -1 );
	for ( BlockContact& contact : contacts )
	{
		for ( ContactSide& side : contact.side )
		{
			if ( side.soft < 0 )
			{
				continue;
			}
			for ( int j = 0; j < side.shared.count; ++j )
			{
				side.block[j] = registerNode( side.soft, side.shared.node[j] );
				startFromBefore( soft[std::size_t( side.soft )], side.shared.node[j] );
			}
		}
	}
}

int IslandBlock::registerNode( int part, int node )
{
	const int index = soft[std::size_t( part )].offset + node;
	int& block = m_blockOf[std::size_t( index )];
	if ( block < 0 )
	{
		block = int( m_nodeBlocks.size() );
		m_nodeBlocks.push_back( NodeBlock{ part, node, index } );
	}
	return block;
}

} // namespace pliant
