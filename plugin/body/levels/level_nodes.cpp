#include "body/levels/level_nodes.h"

#include "body/levels/levels.h"
#include "matching/step/lattice_matcher.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

using Matrix3fRows = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

/// Nodes summed side by side; determines the order of the sums.
constexpr int kSumLanes = 8;
static_assert( kLanes % kSumLanes == 0 );
using Lanes = Eigen::Array<double, kSumLanes, 1>;

Lanes load( const AlignedArray<float>& array, int i )
{
	return Eigen::Map<const Eigen::Array<float, kSumLanes, 1>>( array.data() + i ).cast<double>();
}

/// Sums over all nodes, in double, in one pass, about the nodes' origin.
struct Motion
{
	double mass = 0.0;
	Vec3d first = Vec3d::Zero(), momentum = Vec3d::Zero(), spin = Vec3d::Zero();
	Vec3d square = Vec3d::Zero(), offDiagonal = Vec3d::Zero(); ///< sum m x x^T: xx, yy, zz and yz, xz, xy

	Vec3d centre() const { return first / mass; }
	/// Spin about the centre of mass.
	Vec3d ownSpin() const { return spin - centre().cross( momentum ); }
	Eigen::Matrix3d inertia() const
	{
		Eigen::Matrix3d moment;
		moment << square[0], offDiagonal[2], offDiagonal[1], offDiagonal[2], square[1], offDiagonal[0], offDiagonal[1], offDiagonal[0],
			square[2];
		moment -= first * centre().transpose();
		return moment.trace() * Eigen::Matrix3d::Identity() - moment;
	}
};

Motion motionOf( const NodeState& nodes )
{
	Lanes mass = Lanes::Zero(), sum[5][3];
	for ( auto& kind : sum )
	{
		std::fill( std::begin( kind ), std::end( kind ), Lanes( Lanes::Zero() ) );
	}
	for ( int i = 0; i < nodes.padded; i += kSumLanes ) // padding has no mass
	{
		const Lanes m = load( nodes.mass, i );
		const Lanes x[3] = { load( nodes.x.x, i ), load( nodes.x.y, i ), load( nodes.x.z, i ) };
		const Lanes p[3] = { m * load( nodes.v.x, i ), m * load( nodes.v.y, i ), m * load( nodes.v.z, i ) };
		mass += m;
		for ( int k = 0; k < 3; ++k )
		{
			const int k1 = ( k + 1 ) % 3, k2 = ( k + 2 ) % 3;
			const Lanes mx = m * x[k];
			sum[0][k] += mx;
			sum[1][k] += p[k];
			sum[2][k] += x[k1] * p[k2] - x[k2] * p[k1];
			sum[3][k] += mx * x[k];
			sum[4][k] += m * x[k1] * x[k2];
		}
	}
	Motion motion;
	motion.mass = mass.sum();
	Vec3d* const to[5] = { &motion.first, &motion.momentum, &motion.spin, &motion.square, &motion.offDiagonal };
	for ( int kind = 0; kind < 5; ++kind )
	{
		*to[kind] = Vec3d( sum[kind][0].sum(), sum[kind][1].sum(), sum[kind][2].sum() );
	}
	return motion;
}

/// v += shift + turn x x
void addRigid( NodeState& nodes, const Vec3d& shift, const Vec3d& turn )
{
	AlignedArray<float>* const v[3] = { &nodes.v.x, &nodes.v.y, &nodes.v.z };
	for ( int i = 0; i < nodes.padded; i += kSumLanes )
	{
		const Lanes x[3] = { load( nodes.x.x, i ), load( nodes.x.y, i ), load( nodes.x.z, i ) };
		for ( int k = 0; k < 3; ++k )
		{
			const int k1 = ( k + 1 ) % 3, k2 = ( k + 2 ) % 3;
			const Lanes sum = load( *v[k], i ) + ( shift[k] + ( turn[k1] * x[k2] - turn[k2] * x[k1] ) );
			Eigen::Map<Eigen::Array<float, kSumLanes, 1>>( v[k]->data() + i ) = sum.cast<float>();
		}
	}
	for ( AlignedArray<float>* component : v )
	{
		std::fill( component->begin() + nodes.count, component->end(), 0.0f );
	}
}

/// Copies nodes `old`, old + 1, ... to `first` to end - 1.
void copyNodes( const NodeState& before, int old, NodeState& now, int first, int end )
{
	const auto from = arraysOf( const_cast<NodeState&>( before ) ), to = arraysOf( now ); // read only
	for ( std::size_t k = 0; k < from.size(); ++k )
	{
		std::copy( from[k]->begin() + old, from[k]->begin() + old + ( end - first ), to[k]->begin() + first );
	}
}

} // namespace

std::array<AlignedArray<float>*, 11> arraysOf( NodeState& nodes )
{
	return { &nodes.x.x, &nodes.x.y, &nodes.x.z, &nodes.v.x, &nodes.v.y, &nodes.v.z, &nodes.x0.x, &nodes.x0.y, &nodes.x0.z, &nodes.mass,
		&nodes.freedom };
}

void resizeNodes( NodeState& nodes, int count )
{
	nodes.count = count;
	nodes.padded = ( count + kLanes - 1 ) / kLanes * kLanes;
	for ( AlignedArray<float>* array : arraysOf( nodes ) )
	{
		array->resize( std::size_t( nodes.padded ) );
		std::fill( array->begin() + count, array->end(), 0.0f );
	}
}

void restoreMomentum( NodeState& nodes, const NodeState& before )
{
	const auto isPinned = []( float freedom ) { return freedom == 0.0f; };
	if ( nodes.count < 2 || std::any_of( nodes.freedom.begin(), nodes.freedom.begin() + nodes.count, isPinned ) )
	{
		return;
	}
	const Motion then = motionOf( before ), now = motionOf( nodes );
	const Vec3d turn = flooredInverse( now.inertia(), kInertiaFloor ) * ( then.ownSpin() - now.ownSpin() );
	const Vec3d shift = ( then.momentum - now.momentum ) / now.mass;
	addRigid( nodes, shift - turn.cross( now.centre() ), turn );
}

double removeInternalMotion( NodeState& nodes, double joules )
{
	const Motion motion = motionOf( nodes );
	const Vec3d turn = flooredInverse( motion.inertia(), kInertiaFloor ) * motion.ownSpin(),
				shift = motion.momentum / motion.mass - turn.cross( motion.centre() );
	const auto rigid = [&]( int i ) { return Vec3d( shift + turn.cross( nodes.x.get( i ).cast<double>() ) ); };
	double internal = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		internal += 0.5 * double( nodes.freedom[i] ) * double( nodes.mass[i] ) *
			( nodes.v.get( i ).cast<double>() - rigid( i ) ).squaredNorm();
	}
	const double removed = std::min( joules, internal );
	if ( !( removed > 0.0 ) )
	{
		return 0.0;
	}
	// v <- v_rigid + sqrt( 1 - taken / own ) ( v - v_rigid )
	const double fraction = std::sqrt( 1.0 - removed / internal );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const double scale = nodes.freedom[i] == 0.0f ? 1.0 : fraction;
		nodes.v.set( i, ( rigid( i ) + scale * ( nodes.v.get( i ).cast<double>() - rigid( i ) ) ).cast<float>() );
	}
	return removed;
}

/// The source of a node is the first of the old nodes under it: both cuts are in depth-first order.
void Levels::numberSources( const Cut& next )
{
	m_change.source.assign( next.node.size(), kNoNode );
	m_change.nodeNow.assign( m_cut.node.size(), kNoNode );
	m_change.keptAs.assign( m_cut.node.size(), kNoNode );
	const Octree& tree = octree();
	std::uint32_t i = 0, j = 0;
	while ( i < std::uint32_t( m_cut.count() ) )
	{
		const std::uint32_t old = m_cut.node[i], now = next.node[j];
		m_change.source[j] = std::min( m_change.source[j], i );
		if ( old == now )
		{
			m_change.nodeNow[i] = m_change.keptAs[i] = j;
			++i;
			++j;
			continue;
		}
		if ( tree.cellCount[now] >= tree.cellCount[old] )
		{
			m_change.nodeNow[i] = j;
		}
		const std::uint32_t oldEnd = tree.cellStart[old] + tree.cellCount[old], nowEnd = tree.cellStart[now] + tree.cellCount[now];
		i += oldEnd <= nowEnd ? 1 : 0;
		j += nowEnd <= oldEnd ? 1 : 0;
	}
}

/// Old nodes that are replaced by their children, ascending.
std::vector<std::uint32_t> Levels::splitNodes( const Cut& next ) const
{
	std::vector<std::uint32_t> split;
	for ( int i = 0; i < next.count(); ++i )
	{
		const std::uint32_t old = m_change.source[i];
		const bool isChild = !isKept( next, i ) && octree().cellCount[m_cut.node[old]] >= octree().cellCount[next.node[i]];
		if ( isChild && ( split.empty() || split.back() != old ) )
		{
			split.push_back( old );
		}
	}
	return split;
}

NodeState Levels::changedNodes( const NodeState& before, LatticeMatcher& matcher, const Cut& next, float density )
{
	NodeState now = std::move( m_scratch.nodes );
	now.origin = before.origin;
	resizeNodes( now, next.count() );
	const double fullCell = double( density ) * std::pow( double( m_lattice->cellSize ), 3 );
	for ( int i = 0; i < now.count; )
	{
		const int old = int( m_change.source[i] );
		int end = i;
		while ( end < now.count && int( m_change.source[end] ) == old + ( end - i ) && isKept( next, end ) )
		{
			++end;
		}
		if ( end > i )
		{
			copyNodes( before, old, now, i, end );
			i = end;
			continue;
		}
		now.x0.set( i, octree().restCentre[next.node[i]] );
		now.mass[i] = float( fullCell * octree().mass[next.node[i]] );
		now.freedom[i] = before.freedom[old];
		if ( octree().cellCount[m_cut.node[old]] < octree().cellCount[next.node[i]] )
		{
			mergeInto( before, old, now, i );
		}
		++i;
	}
	const std::vector<std::uint32_t> parents = splitNodes( next );
	std::vector<float> gradients( parents.size() * 9 );
	NodeState& readable = const_cast<NodeState&>( before ); // the matcher's view has one form, for reading and writing
	matcher.deformationsOf( readable, parents, gradients.data() );
	splitInto( before, parents, gradients, next, now );
	if ( before.force.x.empty() )
	{
		now.force = {};
		return now;
	}
	now.force.resize( now.padded );
	for ( int i = 0; i < now.count; ++i )
	{
		const int old = int( m_change.source[i] );
		now.force.set( i, before.force.get( old ) * ( now.mass[i] / before.mass[old] ) );
	}
	return now;
}

// A child is placed by its parent's region: x = x_a + F ( x0_c - x0_a ), v = v_a + G ( x0_c - x0_a ). The children's mass centre is the
// parent's, at rest and hence now: momentum is conserved, and spin that the parent did not have is removed from the body afterwards. A
// parent takes the mean position and velocity of its children.
void Levels::splitInto( const NodeState& before, const std::vector<std::uint32_t>& parents, const std::vector<float>& gradients,
	const Cut& next, NodeState& now ) const
{
	std::size_t parent = 0;
	std::uint32_t last = kNoNode; // children are adjacent
	Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
	for ( int i = 0; i < now.count && !parents.empty(); ++i )
	{
		const std::uint32_t old = m_change.source[i];
		while ( parent + 1 < parents.size() && parents[parent] < old )
		{
			++parent;
		}
		if ( parents[parent] != old || isKept( next, i ) )
		{
			continue;
		}
		const Vec3 arm = now.x0.get( i ) - before.x0.get( int( old ) );
		const Eigen::Matrix3f f = Eigen::Map<const Matrix3fRows>( gradients.data() + 9 * parent );
		now.x.set( i, before.x.get( int( old ) ) + f * arm );
		if ( old != last )
		{
			last = old;
			gradient = velocityGradient( before, int( old ) );
		}
		now.v.set( i, before.v.get( int( old ) ) + ( gradient * arm.cast<double>() ).cast<float>() );
	}
}

void Levels::mergeInto( const NodeState& before, int first, NodeState& now, int slot ) const
{
	Vec3d x = Vec3d::Zero(), v = Vec3d::Zero();
	double mass = 0.0;
	for ( int k = first; k < before.count && m_change.nodeNow[k] == std::uint32_t( slot ); ++k )
	{
		const double m = before.mass[k];
		mass += m;
		x += m * before.x.get( k ).cast<double>();
		v += m * before.v.get( k ).cast<double>();
		now.freedom[slot] = std::min( now.freedom[slot], before.freedom[k] );
	}
	now.x.set( slot, ( x / mass ).cast<float>() );
	now.v.set( slot, ( v / mass ).cast<float>() );
}

/// G = sum u ( v - v_r ) q^T J^+, 1/s: the velocity gradient around a node with respect to its rest shape.
Eigen::Matrix3d Levels::velocityGradient( const NodeState& nodes, int node ) const
{
	const RegionMoments& moments = m_tables->moments;
	const Vec3d centre( moments.centre[0][node], moments.centre[1][node], moments.centre[2][node] );
	Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
	const Vec3d own = nodes.v.get( node ).cast<double>(); // any velocity may be subtracted: sum u q = 0
	for ( std::uint32_t k = matrix().start[node]; k < matrix().start[node + 1]; ++k )
	{
		const int a = int( matrix().member[k] );
		const Vec3d q = nodes.x0.get( a ).cast<double>() / double( m_lattice->cellSize ) - centre;
		sum += matrix().mass[k] * matrix().unit[std::size_t( a )] * ( nodes.v.get( a ).cast<double>() - own ) * q.transpose();
	}
	Eigen::Matrix3d inverse;
	const auto& j = moments.inverseMoment;
	inverse << j[0][node], j[5][node], j[4][node], j[5][node], j[1][node], j[3][node], j[4][node], j[3][node], j[2][node];
	return sum * inverse / double( m_lattice->cellSize );
}

} // namespace pliant
