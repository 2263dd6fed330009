// Pieces of a body that has broken apart: finding them, and moving the state of the whole to them. Ohta et al. 2009, "Fracturing".

#include "body/body.h"
#include "body/breaking.h"
#include "body/constants.h"
#include "body/levels/levels.h"
#include "lattice/assert_valid.h"

#include "fracture/shards/shard_cracks.h"
#include "matching/step/lattice_matcher.h"

#include <algorithm>
#include <utility>

namespace pliant {

namespace {

/// Heaviest first, equal ones by lowest cell.
std::vector<std::vector<std::uint32_t>> byMass( const Lattice& lattice, std::vector<std::vector<std::uint32_t>> parts )
{
	std::vector<std::pair<double, std::size_t>> order;
	for ( std::size_t k = 0; k < parts.size(); ++k )
	{
		double fill = 0.0;
		for ( const std::uint32_t cell : parts[k] )
		{
			fill += lattice.fill[cell];
		}
		order.emplace_back( -fill, k );
	}
	std::sort( order.begin(), order.end() );
	std::vector<std::vector<std::uint32_t>> sorted;
	for ( const auto& [fill, k] : order )
	{
		sorted.push_back( std::move( parts[k] ) );
	}
	return sorted;
}

/// Merges parts beyond the first `most` into the heaviest.
void mergeSurplus( std::vector<std::vector<std::uint32_t>>& parts, std::size_t most )
{
	for ( std::size_t k = most; k < parts.size(); ++k )
	{
		parts[0].insert( parts[0].end(), parts[k].begin(), parts[k].end() );
	}
	parts.resize( std::min( parts.size(), most ) );
	if ( !std::is_sorted( parts[0].begin(), parts[0].end() ) ) // usually nothing was added
	{
		std::sort( parts[0].begin(), parts[0].end() );
	}
}

/// Returns the lattice with some links removed and others restored.
Lattice relinked( const Lattice& lattice, const std::vector<CellLink>& broken, const std::vector<CellLink>& healed )
{
	Lattice now = withoutLinks( lattice, broken );
	if ( !healed.empty() )
	{
		now = withLinks( now, healed );
	}
	return now; // a conditional expression would copy
}

/// Both ends of all links, without duplicates, ascending.
std::vector<std::uint32_t> cellsOf( const std::vector<CellLink>& broken, const std::vector<CellLink>& healed )
{
	std::vector<std::uint32_t> cells;
	for ( const std::vector<CellLink>* links : { &broken, &healed } )
	{
		for ( const CellLink& link : *links )
		{
			cells.push_back( link.a );
			cells.push_back( link.b );
		}
	}
	std::sort( cells.begin(), cells.end() );
	cells.erase( std::unique( cells.begin(), cells.end() ), cells.end() );
	return cells;
}

/// Indices in `cells` of those of `some` that it contains; both ascending.
std::vector<std::uint32_t> indicesIn( const std::vector<std::uint32_t>& some, const std::vector<std::uint32_t>& cells )
{
	std::vector<std::uint32_t> indices;
	for ( const std::uint32_t cell : some )
	{
		if ( const auto found = std::lower_bound( cells.begin(), cells.end(), cell ); found != cells.end() && *found == cell )
		{
			indices.push_back( std::uint32_t( found - cells.begin() ) );
		}
	}
	return indices;
}

/// One rigid cluster of the same material, as stiff as possible. Plastic flow is dropped: the cluster has the original rest shape.
Material rigidMaterial( const Material& original )
{
	Material material = original;
	material.method = Method::SingleCluster;
	material.clusterMode = ClusterMode::Rigid;
	material.alpha = 1.0f;
	material.beta = 0.0f;
	material.volumeKeeping = 0.0f;
	material.farLevels = 0;
	material.yieldStrain = 0.0f;
	return material;
}

} // namespace

std::vector<BodyPiece> Body::breakApart( BreakReport& report, int most, PieceBuild build )
{
	const std::vector<CellLink> broken = brokenLinks();
	const std::vector<std::uint32_t> touched = m_levels ? cellsOf( broken, m_healedLinks ) : std::vector<std::uint32_t>();
	report = reportOn( broken );
	report.broken = broken;
	report.hasHealed = !m_healedLinks.empty();
	auto whole = std::make_shared<const Lattice>( relinked( *m_lattice, broken, m_healedLinks ) );
	m_cutLinks.clear();
	m_healedLinks.clear();
	if ( m_breaking )
	{
		m_breaking->broken.clear();
	}
	std::vector<std::vector<std::uint32_t>> parts = byMass( *whole, connectedParts( *whole ) );
	removeSmall( parts, report );
	const bool isMerged = parts.size() > std::size_t( most );
	mergeSurplus( parts, std::size_t( most ) );
	std::vector<float> rotations;
	if ( makesRigid() || m_material.method != Method::Lattice )
	{
		rotations.resize( std::size_t( m_nodes.count ) * 4 );
		nodeRotations( rotations.data() );
	}
	std::vector<BodyPiece> pieces( parts.size() );
	for ( std::size_t k = parts.size(); k-- > 0; ) // the heaviest last
	{
		std::vector<std::uint32_t>& cells = parts[k];
		const bool isAll = cells.size() == whole->fill.size();
		std::shared_ptr<const Lattice> lattice = isAll ? whole : std::make_shared<const Lattice>( extractCells( *whole, cells ) );
		BodyPiece& piece = pieces[k];
		piece.isOnePart = !isMerged || k > 0;
		piece.isLast = k == 0;
		piece.isSmall = k > 0 && isSmall( cells );
		piece.isRigid = piece.isSmall && makesRigid();
		if ( !rotations.empty() )
		{
			piece.turn = Eigen::Map<const Eigen::Quaternionf>( rotations.data() + 4 * std::size_t( nodeOfCell( cells[0] ) ) );
		}
		piece.cellBefore = std::move( cells );
		piece.touched = m_levels ? indicesIn( touched, piece.cellBefore ) : std::vector<std::uint32_t>();
		if ( isAll && m_levels && build == PieceBuild::Reuse )
		{
			piece.body = relinkWhole( lattice, piece );
		}
		if ( !piece.body )
		{
			if ( m_levels )
			{
				m_levels->measureSkippedRows( m_material );
			}
			piece.body = makePiece( std::move( lattice ), piece, build );
		}
		assertValid( *piece.body );
	}
	return pieces;
}

bool Body::makesRigid() const
{
	return m_fracture.smallCells > 0 && ( m_fracture.smallPieces == SmallPieces::Rigid || m_fracture.smallPieces == SmallPieces::Fade );
}

// Rigid pieces consist of finest cells, held together only by their own cluster.
void Body::addNodesOfRigidPieces( std::vector<std::uint32_t>& nodes ) const
{
	if ( !makesRigid() )
	{
		return;
	}
	const Lattice open = relinked( *m_lattice, brokenLinks(), m_healedLinks );
	const std::vector<std::vector<std::uint32_t>> parts = byMass( open, connectedParts( open ) );
	for ( std::size_t k = 1; k < parts.size(); ++k )
	{
		for ( std::size_t i = 0; isSmall( parts[k] ) && i < parts[k].size(); ++i )
		{
			const std::uint32_t cell = parts[k][i], node = m_levels->cut().node[m_levels->cut().slotOfCell[cell]];
			if ( node != cell )
			{
				nodes.push_back( node );
			}
		}
	}
}

// Removed pieces are not built and do not count towards a limit. The heaviest part is never a small piece.
void Body::removeSmall( std::vector<std::vector<std::uint32_t>>& parts, BreakReport& report ) const
{
	if ( m_fracture.smallPieces != SmallPieces::Remove )
	{
		return;
	}
	std::vector<std::vector<std::uint32_t>> kept;
	const double d = m_lattice->cellSize, fullCell = m_material.density * d * d * d;
	for ( std::vector<std::uint32_t>& cells : parts )
	{
		if ( kept.empty() || !isSmall( cells ) )
		{
			kept.push_back( std::move( cells ) );
			continue;
		}
		++report.removedPieces;
		for ( const std::uint32_t cell : cells )
		{
			report.removedMass += fullCell * m_lattice->fill[cell];
		}
	}
	parts = std::move( kept );
}

std::unique_ptr<Body> Body::makePiece( std::shared_ptr<const Lattice> lattice, BodyPiece& piece, PieceBuild build ) const
{
	std::unique_ptr<Body> body( new Body );
	body->m_lattice = std::move( lattice );
	body->m_material = piece.isRigid ? rigidMaterial( m_material ) : m_material;
	body->m_material.farLevels = usefulFarLevels( *body->m_lattice, body->m_material.farLevels );
	body->m_fracture = m_fracture;
	for ( const std::uint32_t cell : piece.cellBefore )
	{
		body->m_firstCell.push_back( m_firstCell.empty() ? cell : m_firstCell[cell] );
		if ( !m_stiffness.empty() && !piece.isRigid )
		{
			body->m_stiffness.push_back( m_stiffness[cell] );
		}
	}
	if ( m_levels && !piece.isRigid )
	{
		body->inheritLevels( *this, piece, build );
	}
	else
	{
		body->makeNodes( Adaptivity{} );
		for ( const std::uint32_t cell : piece.cellBefore )
		{
			piece.nodeBefore.push_back( std::uint32_t( nodeOfCell( cell ) ) );
		}
	}
	body->makeMeasures( piece.isOnePart );
	body->inheritNodes( *this, piece );
	body->m_reviewIn = m_reviewIn;
	body->m_sinceReview = m_sinceReview;
	body->m_wasImplicit = m_wasImplicit;
	body->m_numericalDamping = m_numericalDamping; // for the rest of the game step
	body->m_rolling = m_rolling;
	if ( m_energyDebt.timeLeft > 0.0f )
	{
		body->m_energyDebt = m_energyDebt.fraction( double( body->m_lattice->cellCount() ) / double( m_lattice->cellCount() ) );
	}
	if ( body->m_material.method == Method::Lattice )
	{
		body->m_matcher = body->makePieceMatcher( *this, piece );
		static_cast<LatticeMatcher&>( *body->m_matcher ).inherit( static_cast<const LatticeMatcher&>( *m_matcher ), piece.nodeBefore );
	}
	else
	{
		body->m_matcher = body->makeMatcher( body->m_material );
		body->m_matcher->reset( body->m_nodes, body->bestFit( piece.turn.cast<double>() ).rotation );
	}
	if ( piece.isRigid )
	{
		body->m_fracture.rule = BreakRule::Never;
	}
	else if ( m_breaking )
	{
		body->inheritBreaking( *m_breaking, piece );
	}
	body->keepFiniteState();
	return body;
}

std::unique_ptr<Matcher> Body::makePieceMatcher( const Body& from, const BodyPiece& piece )
{
	if ( m_levels )
	{
		return makeMatcher( m_material );
	}
	const RegionTables& before = static_cast<const LatticeMatcher&>( *from.m_matcher ).tables();
	const Vec3d shift = ( m_lattice->massCentre - from.m_lattice->massCentre ) / double( m_lattice->cellSize );
	const MomentsBefore moments{ before.moments, before.regions, piece.cellBefore, shift };
	Material measured = m_material;
	if ( from.hasFlowed() && !needsInverse( measured ) ) // plasticity was switched off, but its flow stays
	{
		measured.yieldStrain = 1.0f;
	}
	auto matcher = std::make_unique<LatticeMatcher>(
		*m_lattice, m_material, buildRegionTables( *m_lattice, measured, Summation::Automatic, m_stiffness, &moments ) );
	matcher->setFarLevels( m_material.farLevels, m_stiffness );
	return matcher;
}

void Body::inheritNodes( const Body& from, const BodyPiece& piece )
{
	const NodeState& before = from.m_nodes;
	m_nodes.origin = before.origin;
	const bool hasForce = !before.force.x.empty();
	if ( hasForce )
	{
		m_nodes.force.resize( m_nodes.padded );
	}
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		const int old = int( piece.nodeBefore[std::size_t( i )] );
		m_nodes.x.set( i, before.x.get( old ) );
		m_nodes.v.set( i, before.v.get( old ) );
		m_nodes.freedom[i] = before.freedom[old];
		if ( hasForce )
		{
			m_nodes.force.set( i, before.force.get( old ) );
		}
	}
}

void Body::inheritBreaking( const Breaking& from, const BodyPiece& piece )
{
	m_breaking = std::make_unique<Breaking>();
	m_breaking->settings = from.settings;
	m_breaking->coolDown = from.coolDown;
	m_breaking->sinceTest = from.sinceTest;
	m_breaking->limits = limitsOf( from, piece );
	if ( from.planes )
	{
		m_breaking->planes = std::make_unique<PlaneCracks>( *from.planes ); // cracks stay in place
	}
	if ( from.shards )
	{
		const double fraction = double( piece.cellBefore.size() ) / double( from.shards->shards().size() );
		m_breaking->shards = std::make_unique<ShardCracks>( *from.shards, *m_lattice, piece.cellBefore, fraction );
	}
}

LinkLimits Body::limitsOf( const Breaking& from, const BodyPiece& piece ) const
{
	const float strain = from.candidateStrain( breakStrain( from.settings, m_material ) );
	return inheritLimits( from.limits, *m_lattice, piece.cellBefore, strain );
}

} // namespace pliant
