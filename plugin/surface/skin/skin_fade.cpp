#include "surface/skin/skin_fade.h"

#include "surface/constants.h"
#include "surface/skin/rows_of_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

constexpr std::uint32_t kRemoved = std::numeric_limits<std::uint32_t>::max(); // LevelChange::keptAs of removed nodes

using MapRows = Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>;

double diagonalOf( const std::vector<Vec3>& points )
{
	Vec3 low = points.front(), high = low;
	for ( const Vec3& p : points )
	{
		low = low.cwiseMin( p );
		high = high.cwiseMax( p );
	}
	return double( ( high - low ).norm() );
}

/// The differences D_c = M_before - M_now of the cells whose maps have changed, which move the skin back.
class MapChanges
{
public:
	static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

	explicit MapChanges( std::size_t cells ) : m_number( cells, kNone ) {}

	void add( std::uint32_t cell, const float* before, const float* now )
	{
		m_number[cell] = std::uint32_t( m_difference.size() );
		m_difference.push_back( MapRows( before ) - MapRows( now ) );
	}

	/// sum of w_c D_c over the cells c of a row, at the row's rest position. Exactly zero where no map has changed.
	Vec3 jumpOf( const SkinBinding& binding, std::uint32_t row ) const
	{
		Rows sum = Rows::Zero();
		bool isChanged = false;
		for ( std::uint32_t k = binding.start[row]; k < binding.start[row + 1]; ++k )
		{
			if ( const std::uint32_t number = m_number[binding.node[k]]; number != kNone )
			{
				sum += binding.weight[k] * m_difference[number];
				isChanged = true;
			}
		}
		return isChanged ? Vec3( sum * binding.restPosition[row].homogeneous() ) : Vec3( Vec3::Zero() );
	}

private:
	using Rows = Eigen::Matrix<float, 3, 4, Eigen::RowMajor>;
	std::vector<std::uint32_t> m_number; ///< by cell
	std::vector<Rows> m_difference;
};

} // namespace

void SkinFade::reserveNodes( int count, std::size_t touched, int cellCount )
{
	reserveScratch( m_mapBefore, std::size_t( count ) * kSkinMapFloats, touched * kSkinMapFloats );
	reserveScratch( m_mapNow, std::size_t( count ) * kSkinMapFloats, touched * kSkinMapFloats );
	reserveScratch( m_slotBefore, std::size_t( cellCount ), std::size_t( cellCount ) );
}

void SkinFade::keep( const NodeState& nodes, const SkinPose& pose, int cellCount, AlignedArray<float>* maps )
{
	if ( maps )
	{
		m_mapBefore.swap( *maps );
	}
	else
	{
		m_mapBefore.resize( std::size_t( nodes.count ) * kSkinMapFloats );
		skinMaps( nodes, pose, m_mapBefore.data() );
	}
	m_slotBefore.assign( pose.slotOfCell, pose.slotOfCell + cellCount );
}

/// Slots whose maps may have changed: nodes measured again, and members of groups, which may have ended.
std::vector<char> SkinFade::changeableSlots( const Nodes& nodes ) const
{
	std::vector<char> mayDiffer( std::size_t( nodes.now.count ), nodes.measured ? 0 : 1 );
	if ( !nodes.measured )
	{
		return mayDiffer;
	}
	for ( const std::uint32_t slot : *nodes.measured )
	{
		mayDiffer[slot] = 1;
	}
	for ( const Group& group : m_group )
	{
		for ( std::uint32_t before = group.first; before < group.first + group.count; ++before )
		{
			if ( nodes.keptAs[before] != kRemoved )
			{
				mayDiffer[nodes.keptAs[before]] = 1;
			}
		}
	}
	return mayDiffer;
}

void SkinFade::measureMaps( const Nodes& nodes, const std::vector<char>& mayDiffer )
{
	m_mapNow.resize( mayDiffer.size() * kSkinMapFloats );
	for ( std::size_t slot = 0; slot < mayDiffer.size(); )
	{
		std::size_t end = slot + 1;
		for ( ; end < mayDiffer.size() && mayDiffer[end] == mayDiffer[slot] && nodes.source[end] == nodes.source[slot] + ( end - slot );
			  ++end )
		{}
		if ( mayDiffer[slot] != 0 )
		{
			skinMaps( nodes.now, nodes.pose, m_mapNow.data(), int( slot ), int( end ) );
		}
		else
		{
			const auto from = m_mapBefore.begin() + std::ptrdiff_t( nodes.source[slot] ) * kSkinMapFloats;
			std::copy(
				from, from + std::ptrdiff_t( end - slot ) * kSkinMapFloats, m_mapNow.begin() + std::ptrdiff_t( slot ) * kSkinMapFloats );
		}
		slot = end;
	}
	ease( nodes.now, m_mapNow.data() );
}

/// Slots whose maps have visibly changed.
std::vector<char> SkinFade::changedSlots( const Nodes& nodes, std::vector<char> mayDiffer, float visible ) const
{
	std::vector<char>& changed = mayDiffer;
	for ( std::size_t slot = 0; slot < changed.size(); ++slot )
	{
		const std::uint32_t before = nodes.source[slot];
		if ( changed[slot] == 0 || nodes.keptAs[before] != slot )
		{
			continue;
		}
		const Eigen::Matrix<float, 3, 4> difference = MapRows( &m_mapNow[slot * kSkinMapFloats] ) -
			MapRows( &m_mapBefore[before * kSkinMapFloats] );
		const Vec3 atNode = difference * nodes.now.x0.get( int( slot ) ).homogeneous();
		changed[slot] = atNode.norm() > visible || difference.leftCols<3>().norm() > kFadeFloor;
	}
	return mayDiffer;
}

/// Keeps groups whose nodes all still exist, and adds one for each split. The effect on the maps is compensated by the offsets.
void SkinFade::regroup( const Nodes& nodes )
{
	std::vector<Group> groups;
	std::size_t old = 0;
	const auto isKept = [&]( std::uint32_t before ) { return nodes.keptAs[before] != kRemoved; };
	for ( std::uint32_t slot = 0, end = 0; slot < std::uint32_t( nodes.now.count ); slot = end )
	{
		const std::uint32_t before = nodes.source[slot];
		for ( end = slot + 1; end < std::uint32_t( nodes.now.count ) && nodes.source[end] == before; ++end )
		{}
		for ( ; old < m_group.size() && m_group[old].first < before; ++old )
		{}
		if ( end - slot > 1 )
		{
			groups.push_back( Group{ slot, end - slot, 0 } );
		}
		else if ( old < m_group.size() && m_group[old].first == before )
		{
			bool isComplete = true;
			for ( std::uint32_t k = 0; k < m_group[old].count; ++k )
			{
				isComplete = isComplete && isKept( before + k );
			}
			if ( isComplete )
			{
				groups.push_back( Group{ slot, m_group[old].count, m_group[old].frame } );
			}
		}
	}
	m_group.swap( groups );
}

void SkinFade::ease( const NodeState& nodes, float* maps ) const
{
	using Rows = Eigen::Map<Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>;
	for ( const Group& group : m_group )
	{
		Eigen::Matrix<float, 3, 4> sum = Eigen::Matrix<float, 3, 4>::Zero();
		Vec3 at = Vec3::Zero(), rest = Vec3::Zero();
		float mass = 0.0f;
		for ( std::uint32_t slot = group.first; slot < group.first + group.count; ++slot )
		{
			const float m = nodes.mass[slot];
			mass += m;
			sum += m * Rows( maps + std::size_t( slot ) * kSkinMapFloats );
			at += m * nodes.x.get( int( slot ) );
			rest += m * nodes.x0.get( int( slot ) );
		}
		Eigen::Matrix<float, 3, 4> common = sum / mass;
		common.col( 3 ) = at / mass - common.leftCols<3>() * ( rest / mass );
		const float s = 1.0f - float( group.frame ) / float( kEaseFrames );
		for ( std::uint32_t slot = group.first; slot < group.first + group.count; ++slot )
		{
			Rows map( maps + std::size_t( slot ) * kSkinMapFloats );
			map = ( 1.0f - s ) * map + s * common;
		}
	}
}

// Only carriers outside panels need offsets: other vertices copy from carriers or are interpolated from corners.
void SkinFade::start( const SkinBinding& binding, const Nodes& nodes )
{
	m_diagonal = m_diagonal > 0.0 ? m_diagonal : diagonalOf( binding.restPosition );
	const float visible = kFadeFloor * float( m_diagonal );
	const std::vector<char> mayDiffer = changeableSlots( nodes );
	regroup( nodes );
	measureMaps( nodes, mayDiffer );
	const std::vector<char> changed = changedSlots( nodes, mayDiffer, visible );
	const std::uint32_t* const slot = nodes.pose.slotOfCell;

	MapChanges changes( m_slotBefore.size() );
	std::vector<char> cellChanged( m_slotBefore.size(), 0 );
	for ( std::uint32_t cell = 0; cell < std::uint32_t( cellChanged.size() ); ++cell )
	{
		if ( changed[slot[cell]] != 0 )
		{
			cellChanged[cell] = 1;
			changes.add( cell, &m_mapBefore[m_slotBefore[cell] * std::size_t( kSkinMapFloats )],
				&m_mapNow[slot[cell] * std::size_t( kSkinMapFloats )] );
		}
	}
	const bool areNamed = nodes.complex && !binding.point.empty();
	std::vector<char> rowChanged = areNamed ? rowsAtPointsOf( binding, cellChanged, *nodes.complex, *nodes.cellsInComplex )
											: rowsThatHold( binding, cellChanged );
	std::for_each(
		binding.placed.begin(), binding.placed.end(), [&rowChanged]( const SkinBinding::Placed& of ) { rowChanged[of.vertex] = 0; } );

	std::vector<std::uint32_t> vertices;
	std::vector<Vec3> offsets;
	vertices.reserve( 2 * m_vertex.size() );
	offsets.reserve( 2 * m_vertex.size() );
	std::size_t old = 0;
	const float remaining = fraction();
	double largest = 0.0;
	for ( std::uint32_t v = 0; v < std::uint32_t( binding.restPosition.size() ); ++v )
	{
		const bool hadOffset = old < m_vertex.size() && m_vertex[old] == v;
		if ( !hadOffset && rowChanged[v] == 0 )
		{
			continue; // most vertices
		}
		Vec3 offset = hadOffset ? Vec3( remaining * m_offset[old++] ) : Vec3( Vec3::Zero() );
		if ( rowChanged[v] != 0 )
		{
			offset += nodes.body.conjugate() * changes.jumpOf( binding, v );
		}
		const float length = offset.norm();
		if ( length > visible )
		{
			vertices.push_back( v );
			offsets.push_back( offset );
			largest = std::max( largest, double( length ) );
		}
	}
	m_vertex.swap( vertices );
	m_offset.swap( offsets );
	// The fade is linear in time. No frame moves a vertex by more than a step, as long as the limits of N permit: N >= largest / ( step
	// diagonal ).
	m_frames = int(
		std::clamp( std::ceil( largest / ( kFadeStep * m_diagonal ) ), double( kFewestFadeFrames ), double( kMostFadeFrames ) ) );
	m_frame = 0;
	++m_offsetVersion;
}

float SkinFade::fraction() const
{
	return m_frame < m_frames ? 1.0f - float( m_frame ) / float( m_frames ) : 0.0f;
}

bool SkinFade::advance()
{
	if ( !isActive() )
	{
		return false;
	}
	if ( ++m_frame >= m_frames && !m_vertex.empty() )
	{
		m_vertex.clear();
		m_offset.clear();
		++m_offsetVersion;
	}
	for ( Group& group : m_group )
	{
		++group.frame;
	}
	m_group.erase(
		std::remove_if( m_group.begin(), m_group.end(), []( const Group& g ) { return g.frame >= kEaseFrames; } ), m_group.end() );
	return true;
}

void SkinFade::clear()
{
	m_offsetVersion += m_vertex.empty() ? 0 : 1;
	m_group.clear();
	m_vertex.clear();
	m_offset.clear();
}

void SkinFade::addTo( float* packed, float* wide, const Eigen::Quaternionf& body ) const
{
	const Eigen::Matrix3f turn = fraction() * body.toRotationMatrix();
	for ( std::size_t k = 0; k < m_vertex.size(); ++k )
	{
		const Vec3 offset = turn * m_offset[k];
		for ( int axis = 0; axis < 3; ++axis )
		{
			packed[3 * std::size_t( m_vertex[k] ) + std::size_t( axis )] += offset[axis];
			wide[4 * std::size_t( m_vertex[k] ) + std::size_t( axis )] += offset[axis];
		}
	}
}

void SkinFade::spread( const SkinBinding& binding, std::vector<SkinOffset>& offsets ) const
{
	offsets.assign( binding.restPosition.size(), SkinOffset{} );
	for ( std::size_t k = 0; k < m_vertex.size(); ++k )
	{
		std::copy_n( m_offset[k].data(), 3, offsets[m_vertex[k]].offset );
	}
	for ( std::size_t v = 0; v < binding.carrier.size(); ++v )
	{
		offsets[v] = offsets[binding.carrier[v]];
	}
}

} // namespace pliant
