// The dense part of a block's preconditioner: each cluster of up to eight nodes coupled by contacts is one dense block. As
// separate 3 x 3 blocks, two nodes in contact would appear much stiffer than they are together.

#include "world/block/island_block.h"

#include <type_traits>

namespace pliant {

namespace {

/// The nodes of both sides of a contact with their weights as in SharedNodes, signed by side.
struct ContactNodes
{
	static constexpr int kMost = 2 * SharedNodes::kMost;
	int block[kMost] = {};
	double press[kMost] = {}, rub[kMost] = {};
	int count = 0;
};

ContactNodes nodesOf( const BlockContact& contact )
{
	ContactNodes nodes;
	for ( int k = 0; k < 2; ++k )
	{
		const ContactSide& side = contact.side[k];
		const double sign = k == 0 ? 1.0 : -1.0;
		for ( int j = 0; side.soft >= 0 && j < side.shared.count; ++j )
		{
			nodes.block[nodes.count] = side.block[j];
			nodes.press[nodes.count] = sign * side.shared.press[j];
			nodes.rub[nodes.count++] = sign * side.shared.rub[j];
		}
	}
	return nodes;
}

/// Calls work( count ) with the count as a compile-time constant, 1 to 8.
template <class Work>
void withSize( int count, Work&& work )
{
	switch ( count )
	{
		case 1: return work( std::integral_constant<int, 1>() );
		case 2: return work( std::integral_constant<int, 2>() );
		case 3: return work( std::integral_constant<int, 3>() );
		case 4: return work( std::integral_constant<int, 4>() );
		case 5: return work( std::integral_constant<int, 5>() );
		case 6: return work( std::integral_constant<int, 6>() );
		case 7: return work( std::integral_constant<int, 7>() );
		default: return work( std::integral_constant<int, 8>() );
	}
}

/// Replaces a positive definite matrix by -a^-1 with the sweep operator (Beaton 1964): for each pivot p, a -= a_p a_p^T / a_pp, then row
/// and column p become a_p / a_pp. Eigen's Cholesky solve for the identity takes three times as long.
template <class Matrix>
void sweep( Matrix& a )
{
	for ( int p = 0; p < Matrix::RowsAtCompileTime; ++p )
	{
		const double pivot = a( p, p );
		const Eigen::Matrix<double, Matrix::RowsAtCompileTime, 1> column = a.col( p ), fraction = column / pivot;
		for ( int j = 0; j < Matrix::RowsAtCompileTime; ++j )
		{
			a.col( j ) -= fraction * column[j];
		}
		a.col( p ) = fraction;
		a.row( p ) = fraction.transpose();
		a( p, p ) = -1.0 / pivot;
	}
}

} // namespace

// Nodes without a cluster join that of the contact's other nodes if it has capacity; otherwise they form a new one.
void IslandBlock::assignClusters( const BlockContact& contact )
{
	const ContactNodes nodes = nodesOf( contact );
	int own = -1, unassigned = 0;
	bool areSeveral = false;
	for ( int k = 0; k < nodes.count; ++k )
	{
		const int cluster = m_nodeBlocks[std::size_t( nodes.block[k] )].cluster;
		unassigned += cluster < 0 ? 1 : 0;
		areSeveral = areSeveral || ( cluster >= 0 && own >= 0 && cluster != own );
		own = cluster >= 0 ? cluster : own;
	}
	if ( unassigned == 0 )
	{
		return;
	}
	const int most = contact.isDrawn ? Cluster::kMost : Cluster::kMost / 2;
	if ( own < 0 || areSeveral || m_clusters[std::size_t( own )].count + unassigned > most )
	{
		own = int( m_clusters.size() );
		m_clusters.emplace_back();
	}
	Cluster& cluster = m_clusters[std::size_t( own )];
	for ( int k = 0; k < nodes.count; ++k )
	{
		NodeBlock& block = m_nodeBlocks[std::size_t( nodes.block[k] )];
		if ( block.cluster < 0 )
		{
			block.cluster = own;
			block.slot = cluster.count;
			cluster.blocks[cluster.count++] = nodes.block[k];
		}
	}
}

void IslandBlock::beginClusters()
{
	int scratch = 0;
	for ( Cluster& cluster : m_clusters )
	{
		cluster.scratch = scratch;
		scratch += 9 * cluster.count * cluster.count;
	}
	m_clusterStorage.assign( std::size_t( scratch ), 0.0 );
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

// Coupling between clusters is omitted, so each cluster stays positive definite.
void IslandBlock::addToClusters( const BlockContact& contact, const Eigen::Matrix3d& contactResistance )
{
	const ContactNodes nodes = nodesOf( contact );
	// Correction along the normal for nodes whose weights differ between normal and tangential directions.
	Eigen::Matrix3d normalExcess = Eigen::Matrix3d::Zero();
	if ( contact.isDrawn )
	{
		normalExcess = contact.stiffness * contact.normal * contact.normal.transpose();
	}
	for ( int a = 0; a < nodes.count; ++a )
	{
		for ( int b = 0; b < nodes.count; ++b )
		{
			const NodeBlock &one = m_nodeBlocks[std::size_t( nodes.block[a] )], &other = m_nodeBlocks[std::size_t( nodes.block[b] )];
			if ( one.cluster != other.cluster )
			{
				continue;
			}
			const double tangentWeight = nodes.rub[a] * nodes.rub[b];
			auto piece = matrixOf( m_clusters[std::size_t( one.cluster )] ).block<3, 3>( 3 * one.slot, 3 * other.slot );
			piece += tangentWeight * contactResistance;
			if ( contact.isDrawn )
			{
				piece += ( nodes.press[a] * nodes.press[b] - tangentWeight ) * normalExcess;
			}
		}
	}
}

// Sums and inverts in double; the inverse is stored in float like the iteration's vectors.
void IslandBlock::invertClusters()
{
	int scratch = 0;
	for ( Cluster& cluster : m_clusters )
	{
		cluster.inverse = scratch;
		scratch += 3 * cluster.count * columnOf( cluster.count );
		for ( int k = 0; k < cluster.count; ++k )
		{
			const NodeBlock& block = m_nodeBlocks[std::size_t( cluster.blocks[k] )];
			const SoftPart& part = soft[std::size_t( block.part )];
			cluster.index[k] = part.offset + block.node;
			cluster.stride[k] = part.motion->padded();
		}
	}
	m_clusterInverse.assign( std::size_t( scratch ), 0.0f );
	for ( const Cluster& cluster : m_clusters )
	{
		withSize( cluster.count, [&]( auto count ) {
			constexpr int rows = 3 * count();
			Eigen::Map<Eigen::Matrix<double, rows, rows>> matrix( m_clusterStorage.data() + cluster.scratch );
			sweep( matrix );
			Eigen::Map<Eigen::Matrix<float, columnOf( count() ), rows>> inverse( m_clusterInverse.data() + cluster.inverse );
			inverse.template topRows<rows>() = -matrix.template cast<float>();
		} );
	}
}

template <int count>
void IslandBlock::preconditionCluster( const Cluster& cluster, const float* r, float* z ) const
{
	constexpr int column = columnOf( count );
	const float* inverse = m_clusterInverse.data() + cluster.inverse;
	float to[column] = {};
	for ( int b = 0; b < count; ++b )
	{
		for ( int k = 0; k < 3; ++k, inverse += column )
		{
			const float from = r[cluster.index[b] + k * cluster.stride[b]];
			for ( int i = 0; i < column; ++i )
			{
				to[i] += inverse[i] * from;
			}
		}
	}
	for ( int b = 0; b < count; ++b )
	{
		for ( int k = 0; k < 3; ++k )
		{
			z[cluster.index[b] + k * cluster.stride[b]] = to[3 * b + k];
		}
	}
}

void IslandBlock::preconditionClusters( const float* r, float* z ) const
{
	for ( const Cluster& cluster : m_clusters )
	{
		withSize( cluster.count, [&]( auto count ) { preconditionCluster<count()>( cluster, r, z ); } );
	}
}

} // namespace pliant
