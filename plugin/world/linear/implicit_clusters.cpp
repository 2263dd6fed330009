// The part of an implicit block's preconditioner that stands near the contacts: the nodes that contacts press on, up to eight, with all
// that acts among them, as one dense piece. By themselves, 3 x 3 each, two nodes pressed together are taken for far harder to move than
// they are.

#include "world/implicit/implicit_block.h"

#include <algorithm>
#include <type_traits>

namespace pliant {

namespace {

/// A contact's blocks and how they feel it: as SharedNodes, with the sign of their side.
struct Touched
{
	static constexpr int kMost = 2 * SharedNodes::kMost;
	int block[kMost] = {};
	double press[kMost] = {}, rub[kMost] = {};
	int count = 0;
};

Touched touchedBy( const BlockContact& contact )
{
	Touched touched;
	for ( int k = 0; k < 2; ++k )
	{
		const ContactSide& side = contact.side[k];
		const double sign = k == 0 ? 1.0 : -1.0;
		for ( int j = 0; side.soft >= 0 && j < side.shared.count; ++j )
		{
			touched.block[touched.count] = side.block[j];
			touched.press[touched.count] = sign * side.shared.press[j];
			touched.rub[touched.count++] = sign * side.shared.rub[j];
		}
	}
	return touched;
}

/// work( count ) with the count as a constant, 1 to 8.
template <class Work>
void bySize( int count, Work&& work )
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

/// a = -a^-1 of a positive definite matrix, by sweeps (Beaton 1964): of each pivot p, a -= a_p a_p^T / a_pp, row and column p become a_p /
/// a_pp. Eigen's Cholesky, solved for the unit matrix, takes three times as long.
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
	const int most = contact.isDrawn ? Cluster::kMost : Cluster::kMost / 2;
	if ( own < 0 || areMany || m_clusters[std::size_t( own )].count + lacking > most )
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

// What lies between two clusters is left out, so each stays positive.
void ImplicitBlock::addToClusters( const BlockContact& contact, const Eigen::Matrix3d& resists )
{
	const Touched touched = touchedBy( contact );
	// Where nodes share what presses otherwise than what rubs, by so much more in the direction of the normal.
	Eigen::Matrix3d press = Eigen::Matrix3d::Zero();
	if ( contact.isDrawn )
	{
		press = contact.stiffness * contact.normal * contact.normal.transpose();
	}
	for ( int a = 0; a < touched.count; ++a )
	{
		for ( int b = 0; b < touched.count; ++b )
		{
			const NodeBlock &one = m_nodeBlocks[std::size_t( touched.block[a] )], &other = m_nodeBlocks[std::size_t( touched.block[b] )];
			if ( one.cluster != other.cluster )
			{
				continue;
			}
			const double rubs = touched.rub[a] * touched.rub[b];
			auto piece = matrixOf( m_clusters[std::size_t( one.cluster )] ).block<3, 3>( 3 * one.slot, 3 * other.slot );
			piece += rubs * resists;
			if ( contact.isDrawn )
			{
				piece += ( touched.press[a] * touched.press[b] - rubs ) * press;
			}
		}
	}
}

// What was summed in double acts in float, as the iteration's vectors are.
void ImplicitBlock::invertClusters()
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
			cluster.place[k] = part.offset + block.node;
			cluster.stride[k] = part.motion->padded();
		}
	}
	m_clusterInverse.assign( std::size_t( scratch ), 0.0f );
	for ( const Cluster& cluster : m_clusters )
	{
		bySize( cluster.count, [&]( auto count ) {
			constexpr int rows = 3 * count();
			Eigen::Map<Eigen::Matrix<double, rows, rows>> matrix( m_clusterStorage.data() + cluster.scratch );
			sweep( matrix );
			Eigen::Map<Eigen::Matrix<float, columnOf( count() ), rows>> inverse( m_clusterInverse.data() + cluster.inverse );
			inverse.template topRows<rows>() = -matrix.template cast<float>();
		} );
	}
}

template <int count>
void ImplicitBlock::preconditionCluster( const Cluster& cluster, const float* r, float* z ) const
{
	constexpr int column = columnOf( count );
	const float* inverse = m_clusterInverse.data() + cluster.inverse;
	float to[column] = {};
	for ( int b = 0; b < count; ++b )
	{
		for ( int k = 0; k < 3; ++k, inverse += column )
		{
			const float from = r[cluster.place[b] + k * cluster.stride[b]];
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
			z[cluster.place[b] + k * cluster.stride[b]] = to[3 * b + k];
		}
	}
}

void ImplicitBlock::preconditionClusters( const float* r, float* z ) const
{
	for ( const Cluster& cluster : m_clusters )
	{
		bySize( cluster.count, [&]( auto count ) { preconditionCluster<count()>( cluster, r, z ); } );
	}
}

} // namespace pliant
