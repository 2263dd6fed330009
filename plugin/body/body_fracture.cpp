// How a body breaks: links are tested, taken out, and what is then connected is a body each. Ohta et al. 2009, "Fracturing".

#include "body/body.h"
#include "body/breaking.h"
#include "body/levels.h"

#include "fracture/constants.h"
#include "matching/lattice_matcher.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <new>
#include <utility>

namespace pliant {

namespace {


/// Links whose cells share a face carry the area of the crack; d^2 each.
bool sharesFace( const Lattice& lattice, const CellLink& link )
{
	return ( lattice.coordinate[link.a].cast<int>() - lattice.coordinate[link.b].cast<int>() ).cwiseAbs().sum() == 1;
}

Result<std::vector<float>> sampleToughness( const Lattice& lattice, const ToughnessField& field )
{
	using Answer = Result<std::vector<float>>;
	std::vector<float> toughness;
	if ( !field.share )
	{
		return Answer::success( std::move( toughness ) );
	}
	const Vec3 shift = lattice.massCentre.cast<float>();
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			if ( j < i )
			{
				continue;
			}
			const Vec3 point = 0.5f * ( lattice.restCentre[i] + lattice.restCentre[j] ) + shift;
			const Vec3 direction = ( lattice.restCentre[j] - lattice.restCentre[i] ).normalized();
			const float share = field.share( point.data(), direction.data(), field.context );
			if ( !( share > 0.0f ) )
			{
				return Answer::failure( ResultCode::BadArgument, "ToughnessField: a share is not above 0." );
			}
			toughness.push_back( share );
		}
	}
	return Answer::success( std::move( toughness ) );
}

/// The connected parts, heaviest first, equals by lowest cell; those beyond `most` are counted to the heaviest.
std::vector<std::vector<std::uint32_t>> partsByMass( const Lattice& lattice, std::size_t most )
{
	std::vector<std::vector<std::uint32_t>> parts = connectedParts( lattice );
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
		if ( sorted.size() < most )
		{
			sorted.push_back( std::move( parts[k] ) );
			continue;
		}
		sorted[0].insert( sorted[0].end(), parts[k].begin(), parts[k].end() );
	}
	std::sort( sorted[0].begin(), sorted[0].end() );
	return sorted;
}

} // namespace

void Breaking::prepare( const Lattice& lattice, float strain, std::vector<float> toughness )
{
	if ( settings.rule == BreakRule::Plane )
	{
		planes = std::make_unique<PlaneCracks>( strain );
	}
	limits = limitLinks( lattice, planes ? planes->candidateStrain() : strain, std::move( toughness ) );
}

Status Body::setFracture( const Fracture& fracture, const ToughnessField& field )
{
	if ( Status status = check( fracture ); !status.ok() )
	{
		return status;
	}
	if ( fracture.rule == BreakRule::Never )
	{
		m_breaking.reset();
		return {};
	}
	if ( m_material.method != Method::Lattice )
	{
		return Status{ ResultCode::BadArgument, "Fracture needs Method::Lattice." };
	}
	try
	{
		Result<std::vector<float>> toughness = sampleToughness( *m_lattice, field );
		if ( !toughness.ok() )
		{
			return toughness.status;
		}
		auto breaking = std::make_unique<Breaking>();
		breaking->settings = fracture;
		breaking->prepare( *m_lattice, breakStrain( fracture, m_material ), std::move( toughness.value ) );
		m_breaking = std::move( breaking );
		refineBeforeBreaking();
		return {};
	}
	catch ( const std::bad_alloc& )
	{
		return Status{ ResultCode::OutOfMemory, "Not enough memory for what a body of this many links needs to break." };
	}
}

// Big nodes are split while what is under them is still whole: a crack then never runs through one.
void Body::refineBeforeBreaking()
{
	if ( m_levels )
	{
		const std::vector<float>& toughness = m_breaking->limits.toughness;
		const float weakest = toughness.empty() ? 1.0f : *std::min_element( toughness.begin(), toughness.end() );
		const float strain = std::min( kRefineBeforeBreak * weakest * breakStrain( m_breaking->settings, m_material ), kLargestBreakStrain );
		const float before = m_levels->settings().refineStrain;
		m_levels->setRefineStrain( before > 0.0f ? std::min( before, strain ) : strain );
	}
}

void Body::testLinks( float h )
{
	if ( !m_breaking )
	{
		return;
	}
	Breaking& b = *m_breaking;
	b.coolDown -= h;
	const bool isCool = b.coolDown <= 0.0f;
	const std::vector<std::uint8_t>* const mayBreak = m_levels ? &b.settled.update( *m_lattice, m_levels->cut(), m_levels->settings().coarseLevels, h ) : nullptr;
	if ( !b.broken.empty() || ( !isCool && !b.planes ) )
	{
		return;
	}
	bool hasBegun = false;
	if ( b.planes )
	{
		const CellPlaces places = m_levels ? CellPlaces( m_nodes, m_levels->cut(), *mayBreak ) : CellPlaces( m_nodes );
		hasBegun = b.planes->find( *m_lattice, b.limits, places, h, isCool, b.broken );
	}
	else if ( m_levels )
	{
		findOverstretched( b.limits, CellPlaces( m_nodes, m_levels->cut(), *mayBreak ), b.broken );
	}
	else
	{
		findOverstretched( b.limits, m_nodes, b.broken );
	}
	if ( hasBegun || ( !b.planes && !b.broken.empty() ) )
	{
		b.coolDown = b.settings.coolDown;
	}
}

void Body::breakLinks( const std::vector<CellLink>& links )
{
	std::vector<CellLink> all;
	std::set_union( m_cutLinks.begin(), m_cutLinks.end(), links.begin(), links.end(), std::back_inserter( all ) );
	m_cutLinks = std::move( all );
}

bool Body::hasBrokenLinks() const
{
	return !m_cutLinks.empty() || ( m_breaking && !m_breaking->broken.empty() );
}

std::vector<CellLink> Body::brokenLinks() const
{
	std::vector<CellLink> all = m_cutLinks;
	if ( m_breaking )
	{
		all.clear();
		std::set_union( m_cutLinks.begin(), m_cutLinks.end(), m_breaking->broken.begin(), m_breaking->broken.end(), std::back_inserter( all ) );
	}
	return all;
}

std::vector<std::uint32_t> Body::nodesAboveBroken() const
{
	std::vector<std::uint32_t> above;
	for ( const CellLink& link : brokenLinks() )
	{
		for ( const std::uint32_t cell : { link.a, link.b } )
		{
			const std::uint32_t node = m_levels->cut().node[m_levels->cut().slotOfCell[cell]];
			if ( node != cell )
			{
				above.push_back( node );
			}
		}
	}
	std::sort( above.begin(), above.end() );
	above.erase( std::unique( above.begin(), above.end() ), above.end() );
	return above;
}

bool Body::mustRefineToBreak() const
{
	return m_levels && hasBrokenLinks() && !nodesAboveBroken().empty();
}

void Body::refineToBreak()
{
	changeLevels( nodesAboveBroken(), {} );
}

std::vector<BodyPiece> Body::breakApart( BreakReport& report, int most )
{
	const std::vector<CellLink> broken = brokenLinks();
	report = reportOn( broken );
	m_cutLinks.clear();
	if ( m_breaking )
	{
		m_breaking->broken.clear();
	}
	auto whole = std::make_shared<const Lattice>( withoutLinks( *m_lattice, broken ) );
	std::vector<std::vector<std::uint32_t>> parts = partsByMass( *whole, std::size_t( most ) );
	std::vector<BodyPiece> pieces;
	for ( std::vector<std::uint32_t>& cells : parts )
	{
		std::shared_ptr<const Lattice> lattice = parts.size() == 1 ? whole : std::make_shared<const Lattice>( extractCells( *whole, cells ) );
		BodyPiece piece;
		piece.cellBefore = std::move( cells );
		piece.body = makePiece( std::move( lattice ), piece );
		pieces.push_back( std::move( piece ) );
	}
	return pieces;
}

BreakReport Body::reportOn( const std::vector<CellLink>& broken ) const
{
	BreakReport report;
	report.links = int( broken.size() );
	const double d = m_lattice->cellSize;
	// A link stands for a thirteenth of a cell: 26 links a cell, each shared by two.
	const double energyPerLink = 0.5 * m_material.youngsModulus * d * d * d / 13.0;
	for ( const CellLink& link : broken )
	{
		report.area += sharesFace( *m_lattice, link ) ? d * d : 0.0;
		const int a = nodeOfCell( link.a ), b = nodeOfCell( link.b );
		if ( a != b )
		{
			const double rest = ( m_nodes.x0.get( a ) - m_nodes.x0.get( b ) ).norm();
			const double strain = std::max( 0.0, double( ( m_nodes.x.get( a ) - m_nodes.x.get( b ) ).norm() ) / rest - 1.0 );
			report.energy += energyPerLink * strain * strain;
		}
	}
	return report;
}

int Body::nodeOfCell( std::uint32_t cell ) const
{
	return m_levels ? int( m_levels->cut().slotOfCell[cell] ) : int( cell );
}

std::unique_ptr<Body> Body::makePiece( std::shared_ptr<const Lattice> lattice, BodyPiece& piece ) const
{
	std::unique_ptr<Body> body( new Body );
	body->m_lattice = std::move( lattice );
	body->m_material = m_material;
	body->m_material.farLevels = usefulFarLevels( *body->m_lattice, m_material.farLevels );
	for ( const std::uint32_t cell : piece.cellBefore )
	{
		body->m_firstCell.push_back( m_firstCell.empty() ? cell : m_firstCell[cell] );
		if ( !m_stiffness.empty() )
		{
			body->m_stiffness.push_back( m_stiffness[cell] );
		}
	}
	if ( m_levels )
	{
		body->inheritLevels( *this, piece );
	}
	else
	{
		body->makeNodes( Adaptivity{} );
		piece.nodeBefore = piece.cellBefore;
	}
	body->makeMeasures();
	body->m_matcher = body->makePieceMatcher( *this, piece );
	body->m_lastFinite.resize( std::size_t( body->m_nodes.padded ) * 6, 0.0f );
	body->inheritNodes( *this, piece );
	body->m_reviewIn = m_reviewIn;
	body->m_sinceReview = m_sinceReview;
	static_cast<LatticeMatcher&>( *body->m_matcher ).inherit( static_cast<const LatticeMatcher&>( *m_matcher ), piece.nodeBefore );
	if ( m_breaking )
	{
		body->inheritBreaking( *m_breaking, piece );
	}
	body->keepFiniteState();
	return body;
}

// The same cells stand under one node as before, as far as they are still connected: blocks are where they were.
void Body::inheritLevels( const Body& from, BodyPiece& piece )
{
	const Levels& before = *from.m_levels;
	const std::shared_ptr<const LevelBase> base = buildLevelBase( *m_lattice, m_material, before.settings() );
	const Octree& tree = base->octree;
	auto slotBefore = [&]( std::uint32_t node ) { return before.cut().slotOfCell[piece.cellBefore[tree.cells[tree.cellStart[node]]]]; };
	Cut cut = selectCut( tree, [&]( std::uint32_t node ) { return tree.levelOf( node ) == before.levelOf( int( slotBefore( node ) ) ); } );
	for ( const std::uint32_t node : cut.node )
	{
		piece.nodeBefore.push_back( slotBefore( node ) );
	}
	m_levels = std::make_unique<Levels>( base, *m_lattice, m_material, before.settings(), m_stiffness, std::move( cut ) );
	m_levels->setFinestLevel( before.finestLevel() );
	m_levels->fillNodes( m_nodes, m_material.density );
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
	auto matcher = std::make_unique<LatticeMatcher>( *m_lattice, m_material, buildRegionTables( *m_lattice, m_material, Summation::Automatic, m_stiffness, &moments ) );
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
	m_breaking->prepare( *m_lattice, breakStrain( from.settings, m_material ), inheritToughness( from.limits, *m_lattice, piece.cellBefore ) );
	if ( m_levels )
	{
		m_breaking->settled.inherit( from.settled, piece.cellBefore );
	}
	if ( from.planes )
	{
		*m_breaking->planes = *from.planes; // cracks are where they were
	}
}

} // namespace pliant
