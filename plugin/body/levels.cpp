#include "body/levels.h"

#include "matching/lattice_matcher.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

using Matrix3fRows = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

/// Largest | s - 1 | over the singular values s of F lies between the root of a third of their squares' sum and the root of it.
float strainOf( float squares )
{
	return std::sqrt( squares );
}

/// Sum and spin of all nodes, in double.
struct Motion
{
	double mass = 0.0;
	Vec3d centre = Vec3d::Zero(), momentum = Vec3d::Zero(), spin = Vec3d::Zero();
	bool isHeld = false;
};

Motion motionOf( const NodeState& nodes )
{
	Motion motion;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const double m = nodes.mass[i];
		motion.mass += m;
		motion.centre += m * nodes.x.get( i ).cast<double>();
		motion.momentum += m * nodes.v.get( i ).cast<double>();
		motion.isHeld = motion.isHeld || nodes.freedom[i] == 0.0f;
	}
	motion.centre /= motion.mass;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d arm = nodes.x.get( i ).cast<double>() - motion.centre;
		motion.spin += double( nodes.mass[i] ) * arm.cross( nodes.v.get( i ).cast<double>() );
	}
	return motion;
}

/// One rigid motion for the whole body makes up for what the change cost in momentum and spin: a big node has no spin of its own.
void restoreMotion( NodeState& nodes, const Motion& before )
{
	const Motion now = motionOf( nodes );
	if ( now.isHeld || nodes.count < 2 )
	{
		return;
	}
	Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d p = nodes.x.get( i ).cast<double>() - now.centre;
		inertia += double( nodes.mass[i] ) * ( p.squaredNorm() * Eigen::Matrix3d::Identity() - p * p.transpose() );
	}
	const Vec3d turn = flooredInverse( inertia, kInertiaFloor ) * ( before.spin - now.spin );
	const Vec3d shift = ( before.momentum - now.momentum ) / now.mass;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d p = nodes.x.get( i ).cast<double>() - now.centre;
		nodes.v.set( i, ( nodes.v.get( i ).cast<double>() + shift + turn.cross( p ) ).cast<float>() );
	}
}

void resizeNodes( NodeState& nodes, int count )
{
	nodes.count = count;
	nodes.padded = ( count + kLanes - 1 ) / kLanes * kLanes;
	nodes.x.resize( nodes.padded );
	nodes.v.resize( nodes.padded );
	nodes.x0.resize( nodes.padded );
	nodes.mass.assign( nodes.padded, 0.0f );
	nodes.freedom.assign( nodes.padded, 0.0f );
}

} // namespace

Levels::Levels( std::shared_ptr<const LevelBase> base, const Lattice& lattice, const Material& material, const Adaptivity& settings,
	const std::vector<float>& stiffness, Cut cut ) :
	m_base( std::move( base ) ), m_lattice( lattice ), m_settings( settings ), m_stiffness( stiffness ), m_cut( std::move( cut ) ),
	m_regions( buildLevelRegions( *m_base, lattice, m_cut, material, settings ) ),
	m_tables( buildLevelTables( *m_base, lattice, m_cut, m_regions, LevelSettings{ material, m_settings, m_stiffness } ) ), m_quiet( m_cut.node.size(), 0.0f ),
	m_isWanted( m_cut.node.size(), 0 )
{
	countLevels();
}

void Levels::countLevels()
{
	m_nodesOnLevel.fill( 0 );
	for ( int i = 0; i < m_cut.count(); ++i )
	{
		++m_nodesOnLevel[std::size_t( levelOf( i ) )];
	}
}

void Levels::fillNodes( NodeState& nodes, float density ) const
{
	resizeNodes( nodes, m_cut.count() );
	const double fullCell = double( density ) * std::pow( double( m_lattice.cellSize ), 3 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x0.set( i, octree().restCentre[m_cut.node[i]] );
		nodes.mass[i] = float( fullCell * octree().mass[m_cut.node[i]] );
		nodes.freedom[i] = 1.0f;
	}
}

void Levels::requestSplit( int node )
{
	keep( node );
	if ( levelOf( node ) > m_finestLevel )
	{
		m_asked.push_back( m_cut.node[node] );
	}
}

bool Levels::review( const NodeState& nodes, const AlignedArray<float>& strain, float seconds )
{
	m_split.clear();
	m_merge.clear();
	const bool followsStrain = m_settings.refineStrain > 0.0f;
	for ( int i = 0; i < m_cut.count() && !( followsStrain && strain.empty() ); ++i )
	{
		const bool isQuiet = !followsStrain || strainOf( strain[i] ) < m_settings.mergeShare * m_settings.refineStrain;
		m_quiet[i] = isQuiet && m_isWanted[i] == 0 ? m_quiet[i] + seconds : 0.0f;
	}
	collectSplits( strain );
	collectMerges( nodes );
	std::fill( m_isWanted.begin(), m_isWanted.end(), std::uint8_t( 0 ) );
	return !m_split.empty() || !m_merge.empty();
}

void Levels::collectSplits( const AlignedArray<float>& strain )
{
	// What was asked for comes first, then what only the finest level allowed had kept merged, then the most strained.
	constexpr float kAsked = -std::numeric_limits<float>::infinity(), kTooBig = -std::numeric_limits<float>::max();
	std::vector<std::pair<float, std::uint32_t>> wanted;
	std::sort( m_asked.begin(), m_asked.end() );
	std::vector<std::uint32_t> waiting;
	for ( int i = 0; i < m_cut.count(); ++i )
	{
		const std::uint32_t node = m_cut.node[i];
		const int level = octree().levelOf( node );
		if ( level <= m_finestLevel )
		{
			continue;
		}
		if ( std::binary_search( m_asked.begin(), m_asked.end(), node ) )
		{
			wanted.emplace_back( kAsked, node );
			waiting.push_back( node );
		}
		else if ( isTooBig( node ) )
		{
			wanted.emplace_back( kTooBig, node );
		}
		else if ( !strain.empty() && m_settings.refineStrain > 0.0f && strainOf( strain[i] ) > m_settings.refineStrain )
		{
			wanted.emplace_back( -strain[i], node );
		}
	}
	std::stable_sort( wanted.begin(), wanted.end(), []( const auto& a, const auto& b ) { return a.first < b.first; } );
	std::size_t brought = 0;
	for ( const auto& [order, node] : wanted )
	{
		const std::size_t children = octree().childStart[node + 1] - octree().childStart[node];
		if ( brought + children > std::size_t( m_settings.nodesPerStep ) )
		{
			break;
		}
		brought += children;
		m_split.push_back( node );
	}
	std::sort( m_split.begin(), m_split.end() );
	const auto isDone = [this]( std::uint32_t node ) { return std::binary_search( m_split.begin(), m_split.end(), node ); };
	waiting.erase( std::remove_if( waiting.begin(), waiting.end(), isDone ), waiting.end() );
	m_asked = std::move( waiting ); // each once, and only what is there: requests come again and again
}

/// Whether the body's own selection would use neither the node nor one above it (firstCut): on the way back to one that it uses, nodes
/// are merged that it would not choose by themselves.
bool Levels::isTooBig( std::uint32_t node ) const
{
	const Octree& tree = octree();
	for ( ; node != kNoNode; node = tree.parent[node] )
	{
		const bool isTooLight = tree.mass[node] < double( m_settings.keepMass ) * std::ldexp( 1.0, 3 * tree.levelOf( node ) );
		if ( !isTooLight && !( m_settings.isSurfaceFine && tree.isSurface[node] != 0 ) )
		{
			return false;
		}
	}
	return true;
}

bool Levels::mayMerge( const NodeState& nodes, std::uint32_t parent, int firstSlot ) const
{
	const Octree& tree = octree();
	const std::uint32_t children = tree.childStart[parent + 1] - tree.childStart[parent];
	if ( std::size_t( firstSlot ) + children > m_cut.node.size() )
	{
		return false;
	}
	const bool isFiner = tree.levelOf( parent ) <= m_finestLevel;
	for ( std::uint32_t k = 0; k < children; ++k )
	{
		const std::size_t slot = std::size_t( firstSlot ) + k;
		const bool isThere = m_cut.node[slot] == tree.child[tree.childStart[parent] + k];
		const bool isQuiet = isFiner || ( m_quiet[slot] >= m_settings.mergeDelay && m_isWanted[slot] == 0 );
		const bool isHeld = nodes.freedom[slot] == 0.0f; // a pin holds one node, not what surrounds it
		if ( !isThere || !isQuiet || isHeld || std::binary_search( m_split.begin(), m_split.end(), m_cut.node[slot] ) )
		{
			return false;
		}
	}
	return isFiner || !isTooBig( parent );
}

void Levels::collectMerges( const NodeState& nodes )
{
	for ( int i = 0; i < m_cut.count(); ++i )
	{
		const std::uint32_t parent = octree().parent[m_cut.node[i]];
		const bool isFirst = parent != kNoNode && octree().child[octree().childStart[parent]] == m_cut.node[i];
		if ( isFirst && mayMerge( nodes, parent, i ) )
		{
			m_merge.push_back( parent );
		}
	}
}

void Levels::apply( NodeState& nodes, LatticeMatcher& matcher, const Material& material, TaskRunner* tasks )
{
	if ( !m_split.empty() || !m_merge.empty() )
	{
		const std::vector<std::uint32_t> split = std::move( m_split ), merge = std::move( m_merge );
		m_split.clear();
		m_merge.clear();
		change( nodes, matcher, material, split, merge, tasks );
	}
}

void Levels::change( NodeState& nodes, LatticeMatcher& matcher, const Material& material, const std::vector<std::uint32_t>& split,
	const std::vector<std::uint32_t>& merge, TaskRunner* tasks )
{
	const Motion before = motionOf( nodes );
	const Cut next = changeCut( octree(), m_cut, split, merge );
	numberHeirs( next );
	m_change.splits = int( split.size() );
	m_change.merges = int( merge.size() );
	NodeState changed = changedNodes( nodes, matcher, next, material.density );
	restoreMotion( changed, before );

	m_regions = updateLevelRegions( RegionInput{ *m_base, m_lattice, material, m_settings, tasks }, m_cut, m_regions, next );
	const std::shared_ptr<const RegionTables> old = m_tables;
	m_tables = buildLevelTables( *m_base, m_lattice, next, m_regions, LevelSettings{ material, m_settings, m_stiffness, tasks },
		TablesBefore{ old.get(), unchangedRows( *old->matrix, next ) } );
	std::vector<float> quiet( next.node.size(), 0.0f );
	for ( int i = 0; i < next.count(); ++i )
	{
		const std::uint32_t heir = m_change.heir[i];
		quiet[i] = m_cut.node[heir] == next.node[i] ? m_quiet[heir] : 0.0f;
	}
	m_quiet = std::move( quiet );
	m_isWanted.assign( next.node.size(), 0 );
	m_cut = next;
	countLevels();
	std::swap( nodes, changed );
	matcher.setTables( m_tables, FlowHeirs{ m_change.heir, m_change.nodeNow, changed.mass } );
	++m_version;
}

std::vector<std::uint32_t> Levels::unchangedRows( const RegionMatrix& old, const Cut& next ) const
{
	const RegionMatrix& now = matrix();
	// Nor may masses differ: in unions and intervals a member's share hangs on regions farther off, which may have changed.
	const auto isSame = [&]( std::uint32_t r ) {
		const std::uint32_t heir = m_change.heir[r], size = now.start[r + 1] - now.start[r];
		bool same = old.start[heir + 1] - old.start[heir] == size;
		for ( std::uint32_t k = 0; same && k < size; ++k )
		{
			const std::uint32_t a = now.member[now.start[r] + k], before = old.member[old.start[heir] + k];
			same = m_cut.node[before] == next.node[a] && now.mass[now.start[r] + k] == old.mass[old.start[heir] + k] && now.unit[a] == old.unit[before];
		}
		return same;
	};
	std::vector<std::uint32_t> before( next.node.size() );
	for ( std::uint32_t r = 0; r < std::uint32_t( next.count() ); ++r )
	{
		before[r] = m_cut.node[m_change.heir[r]] == next.node[r] && isSame( r ) ? m_change.heir[r] : kNoNode;
	}
	return before;
}

void Levels::numberHeirs( const Cut& next )
{
	m_change.heir.assign( next.node.size(), 0 );
	m_change.nodeNow.assign( m_cut.node.size(), kNoNode );
	m_change.keptAs.assign( m_cut.node.size(), kNoNode );
	for ( int i = 0; i < next.count(); ++i )
	{
		m_change.heir[i] = m_cut.slotOfCell[octree().cells[octree().cellStart[next.node[i]]]];
	}
	for ( int i = 0; i < m_cut.count(); ++i )
	{
		const std::uint32_t now = next.slotOfCell[octree().cells[octree().cellStart[m_cut.node[i]]]];
		const bool isKept = octree().cellCount[next.node[now]] >= octree().cellCount[m_cut.node[i]];
		m_change.nodeNow[i] = isKept ? now : kNoNode;
		m_change.keptAs[i] = next.node[now] == m_cut.node[i] ? now : kNoNode;
	}
}

// A child stands where its parent's region has carried its rest place: x = x_a + F ( x0_c - x0_a ), and moves as the region does:
// v = v_a + G ( x0_c - x0_a ). The children's mass centre is the parent's, at rest and hence now: momentum is kept, and what spin the
// parent did not have is taken off the body afterwards. A parent stands and moves as the mean of its children.
NodeState Levels::changedNodes( const NodeState& before, LatticeMatcher& matcher, const Cut& next, float density )
{
	NodeState now;
	now.origin = before.origin;
	resizeNodes( now, next.count() );
	const bool hasForce = !before.force.x.empty();
	if ( hasForce )
	{
		now.force.resize( now.padded );
	}
	std::vector<float> gradients( std::size_t( before.padded ) * 9 );
	NodeState& readable = const_cast<NodeState&>( before ); // the matcher's view has one form, for reading and writing
	matcher.deformations( readable, gradients.data() );

	const double fullCell = double( density ) * std::pow( double( m_lattice.cellSize ), 3 );
	const std::vector<std::uint32_t>& heir = m_change.heir;
	int parent = -1; // children stand side by side
	Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
	for ( int i = 0; i < now.count; ++i )
	{
		const std::uint32_t node = next.node[i];
		const int old = int( heir[i] );
		now.x0.set( i, octree().restCentre[node] );
		now.mass[i] = float( fullCell * octree().mass[node] );
		now.freedom[i] = before.freedom[old];
		if ( m_cut.node[old] == node )
		{
			now.x.set( i, before.x.get( old ) );
			now.v.set( i, before.v.get( old ) );
		}
		else if ( octree().cellCount[m_cut.node[old]] >= octree().cellCount[node] )
		{
			const Vec3 arm = octree().restCentre[node] - before.x0.get( old );
			const Eigen::Matrix3f f = Eigen::Map<const Matrix3fRows>( gradients.data() + 9 * std::size_t( old ) );
			now.x.set( i, before.x.get( old ) + f * arm );
			if ( old != parent )
			{
				parent = old;
				gradient = velocityGradient( before, old );
			}
			now.v.set( i, before.v.get( old ) + ( gradient * arm.cast<double>() ).cast<float>() );
		}
		else
		{
			mergeInto( before, old, now, i );
		}
		if ( hasForce )
		{
			now.force.set( i, before.force.get( old ) * ( now.mass[i] / before.mass[old] ) );
		}
	}
	return now;
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

/// G = sum u ( v - v_r ) q^T J^+, 1/s: how the velocities around a node change over its rest shape.
Eigen::Matrix3d Levels::velocityGradient( const NodeState& nodes, int node ) const
{
	const RegionMoments& moments = m_tables->moments;
	const Vec3d centre( moments.centre[0][node], moments.centre[1][node], moments.centre[2][node] );
	Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
	const Vec3d own = nodes.v.get( node ).cast<double>(); // any velocity may be taken off: sum u q = 0
	for ( std::uint32_t k = matrix().start[node]; k < matrix().start[node + 1]; ++k )
	{
		const int a = int( matrix().member[k] );
		const Vec3d q = nodes.x0.get( a ).cast<double>() / double( m_lattice.cellSize ) - centre;
		sum += matrix().mass[k] * matrix().unit[std::size_t( a )] * ( nodes.v.get( a ).cast<double>() - own ) * q.transpose();
	}
	Eigen::Matrix3d inverse;
	const auto& j = moments.inverseMoment;
	inverse << j[0][node], j[5][node], j[4][node], j[5][node], j[1][node], j[3][node], j[4][node], j[3][node], j[2][node];
	return sum * inverse / double( m_lattice.cellSize );
}

std::size_t Levels::bytes() const
{
	return ( m_cut.node.size() + m_cut.slotOfCell.size() + m_change.heir.size() + m_change.nodeNow.size() + m_change.keptAs.size() ) * sizeof( std::uint32_t ) +
		   m_tables->bytes() + m_quiet.size() * sizeof( float );
}

} // namespace pliant
