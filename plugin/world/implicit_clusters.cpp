// The part of an implicit block's preconditioner that stands near the contacts: the nodes that a contact presses on, up to four, with all that acts among them,
// as one dense piece. By themselves, 3 x 3 each, two nodes pressed together are taken for far harder to move than they are.

#include "world/implicit_block.h"

#include <algorithm>

namespace pliant {

namespace {

/// A contact's blocks and how they feel it: u = sum of weight times the block's speed.
struct Touched
{
	int block[4] = { -1, -1, -1, -1 };
	double weight[4] = { 0.0, 0.0, 0.0, 0.0 };
	int count = 0;
};

Touched touchedBy( const BlockContact& contact )
{
	Touched touched;
	for ( int k = 0; k < 2; ++k )
	{
		const ContactSide& side = contact.side[k];
		const double sign = k == 0 ? 1.0 : -1.0;
		const auto add = [&]( int block, double weight ) {
			if ( block >= 0 )
			{
				touched.block[touched.count] = block;
				touched.weight[touched.count++] = sign * weight;
			}
		};
		add( side.soft >= 0 ? side.block : -1, 1.0 - side.share );
		add( side.innerBlock, side.share );
	}
	return touched;
}

} // namespace

// Nodes that have no cluster yet join the one that the contact's others have, where there is room, or make one together.
void ImplicitBlock::nameClusters( const BlockContact& contact )
{
	const Touched touched = touchedBy( contact );
	int own = -1, lacking = 0;
	bool areMany = false;
	for ( int k = 0; k < touched.count; ++k )
	{
		const int cluster = m_nodeBlocks[std::size_t( touched.block[k] )].cluster;
		lacking += cluster < 0 ? 1 : 0;
		areMany = areMany || ( cluster >= 0 && own >= 0 && cluster != own );
		own = cluster >= 0 ? cluster : own;
	}
	if ( lacking == 0 )
	{
		return;
	}
	if ( own < 0 || areMany || m_clusters[std::size_t( own )].count + lacking > Cluster::kMost )
	{
		own = int( m_clusters.size() );
		m_clusters.emplace_back();
	}
	Cluster& cluster = m_clusters[std::size_t( own )];
	for ( int k = 0; k < touched.count; ++k )
	{
		NodeBlock& block = m_nodeBlocks[std::size_t( touched.block[k] )];
		if ( block.cluster < 0 )
		{
			block.cluster = own;
			block.slot = cluster.count;
			cluster.blocks[cluster.count++] = touched.block[k];
		}
	}
}

void ImplicitBlock::beginClusters()
{
	int room = 0;
	for ( Cluster& cluster : m_clusters )
	{
		cluster.room = room;
		room += 9 * cluster.count * cluster.count;
	}
	m_clusterRoom.assign( std::size_t( room ), 0.0 );
	for ( const Cluster& cluster : m_clusters )
	{
		Eigen::Map<Eigen::MatrixXd> matrix = matrixOf( cluster );
		for ( int k = 0; k < cluster.count; ++k )
		{
			const NodeBlock& block = m_nodeBlocks[std::size_t( cluster.blocks[k] )];
			matrix.diagonal().segment<3>( 3 * k ).setConstant( double( soft[std::size_t( block.part )].motion->diagonal( block.node ) ) );
		}
	}
}

// What lies between two clusters is left out, so each stays positive.
void ImplicitBlock::addToClusters( const BlockContact& contact, const Eigen::Matrix3d& resists )
{
	const Touched touched = touchedBy( contact );
	for ( int a = 0; a < touched.count; ++a )
	{
		for ( int b = 0; b < touched.count; ++b )
		{
			const NodeBlock &one = m_nodeBlocks[std::size_t( touched.block[a] )], &other = m_nodeBlocks[std::size_t( touched.block[b] )];
			if ( one.cluster == other.cluster )
			{
				matrixOf( m_clusters[std::size_t( one.cluster )] ).block<3, 3>( 3 * one.slot, 3 * other.slot ) += ( touched.weight[a] * touched.weight[b] ) * resists;
			}
		}
	}
}

void ImplicitBlock::invertClusters()
{
	for ( const Cluster& cluster : m_clusters )
	{
		Eigen::Map<Eigen::MatrixXd> matrix = matrixOf( cluster );
		if ( cluster.count == 1 )
		{
			matrix = Eigen::Matrix3d( matrix ).inverse().eval();
			continue;
		}
		const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 12, 12> whole = matrix;
		matrix = whole.llt().solve( Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 12, 12>::Identity( whole.rows(), whole.cols() ) );
	}
}

void ImplicitBlock::preconditionClusters( const float* r, float* z ) const
{
	for ( const Cluster& cluster : m_clusters )
	{
		const int rows = 3 * cluster.count;
		const double* const inverse = m_clusterRoom.data() + cluster.room;
		double from[3 * Cluster::kMost], to[3 * Cluster::kMost] = {};
		int places[3 * Cluster::kMost];
		for ( int i = 0; i < rows; ++i )
		{
			const NodeBlock& block = m_nodeBlocks[std::size_t( cluster.blocks[i / 3] )];
			const SoftPart& part = soft[std::size_t( block.part )];
			places[i] = part.offset + block.node + i % 3 * part.motion->padded();
			from[i] = double( r[places[i]] );
		}
		for ( int j = 0; j < rows; ++j )
		{
			for ( int i = 0; i < rows; ++i )
			{
				to[i] += inverse[j * rows + i] * from[j];
			}
		}
		for ( int i = 0; i < rows; ++i )
		{
			z[places[i]] = float( to[i] );
		}
	}
}

} // namespace pliant
