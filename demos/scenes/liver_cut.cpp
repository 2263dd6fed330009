// +-----------------------------------------------------------------------------------------------------------------+
// | liver_cut: Steinemann et al. 2008, figure 3. A hanging liver is cut along a scripted path; nodes are split ahead |
// | of the blade, and the sides of the cuts collide.                                                                 |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/liver.h"
#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>
#include <chrono>

namespace pliant_demos {

namespace {

constexpr float kLiverCutSpacing = 6.0f; // mm, of the scan's surface
constexpr float kLiverCutHeight = 0.8f;  // m: three to four times life size
constexpr int kLiverCutCells = 3000;
constexpr int kLiverCutCoarseLevels = 2;
constexpr btScalar kLiverCutLift = btScalar( 0.95 );     // m of its middle above the ground
constexpr btScalar kLiverCutHeldFrom = btScalar( 0.27 ); // m above its middle
constexpr btScalar kHalfEdge = btScalar( 0.6 );          // m, of the blade, which points towards the viewer
constexpr btScalar kBack = btScalar( 0.16 );             // m from its edge to its back
constexpr btScalar kOverlap = btScalar( 0.03 );          // m behind the edge that are cut too: about a cell
constexpr double kShownFor = 0.25;                       // s before and after a stroke
constexpr double kLiverCutDuration = 7.5;                // s
constexpr double kStep = 1.0 / 60;                       // s
constexpr float kKeepsNodes = 60.0f;                     // s of mergeDelay: as in the paper, where the number of nodes only grows

/// The path of the edge, seen from the front, relative to the liver's centre, m and s.
struct Stroke
{
	double begin, end;
	btScalar fromX, fromY, toX, toY;

	btVector3 at( double seconds ) const
	{
		const btScalar t = btScalar( std::clamp( ( seconds - begin ) / ( end - begin ), 0.0, 1.0 ) );
		return btVector3( fromX + t * ( toX - fromX ), kLiverCutLift + fromY + t * ( toY - fromY ), 0 );
	}
	btVector3 along() const { return btVector3( toX - fromX, toY - fromY, 0 ).normalized(); }
};

constexpr Stroke kStrokes[] = {
	{ 1.0, 2.2, btScalar( -0.65 ), btScalar( -0.02 ), btScalar( -0.12 ), btScalar( 0.03 ) },
	{ 2.7, 3.9, btScalar( 0.75 ), btScalar( -0.10 ), btScalar( 0.10 ), btScalar( 0.0 ) },
	{ 4.4, 5.6, btScalar( 0.10 ), btScalar( -0.60 ), btScalar( 0.22 ), btScalar( 0.30 ) },
};

/// ms of one frame.
struct FrameTime
{
	double simulation = 0; ///< matching, contacts, integration
	double resampling = 0; ///< splitting nodes, breaking links, new regions and bodies; finding the links that the blade cuts
};

class LiverCut : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		pliant_glue::ModelMesh mesh = shape( stage );
		fitHeight( mesh, kLiverCutHeight );
		SoftOrder order;
		order.name = "liver";
		order.mesh = &mesh;
		order.cells = kLiverCutCells;
		order.material.density = 1060.0f;
		order.material.youngsModulus = 2.5e4f;
		order.material.damping = 25.0f;
		order.adaptivity.coarseLevels = kLiverCutCoarseLevels;
		order.adaptivity.refineStrain = 1.0f;
		order.adaptivity.mergeDelay = kKeepsNodes;
		order.colour = kLiver;
		order.insideColour = kFlesh;
		order.place = btTransform( btQuaternion::getIdentity(), btVector3( 0, kLiverCutLift, 0 ) );
		stage.addGround( btScalar( 0.8 ) );
		order.shape = stage.buildShape( order );
		if ( order.shape == nullptr )
		{
			return false;
		}
		m_liver = stage.addSoft( order );
		if ( m_liver == nullptr || !m_liver->prepareCracks().ok() ) // now, and not at the first cut
		{
			return false;
		}
		mustSucceed( m_liver->setSelfCollision( true ) );
		m_liver->setActivationState( DISABLE_DEACTIVATION ); // asleep it would cost nothing
		return m_liver->pinNodesInside( btVector3( -2, kLiverCutLift + kLiverCutHeldFrom, -2 ), btVector3( 2, kLiverCutLift + 2, 2 ) ) > 0;
	}

	void beforeStep( Stage& stage, double seconds ) override
	{
		const auto begin = std::chrono::steady_clock::now();
		const btVector3 edge( 0, 0, kHalfEdge );
		for ( const Stroke& stroke : kStrokes )
		{
			if ( seconds < stroke.begin || seconds >= stroke.end )
			{
				continue;
			}
			// From a little behind the previous edge: otherwise material that has swung towards it since the last step would be missed.
			const btVector3 to = stroke.at( seconds + kStep ), from = stroke.at( seconds ) - stroke.along() * kOverlap;
			for ( int i = 0; i < stage.world().softBodyCount(); ++i )
			{
				m_links += stage.world().softBody( i )->cutSweep( from - edge, from + edge, to - edge, to + edge );
			}
		}
		m_cutting = std::chrono::duration<double>( std::chrono::steady_clock::now() - begin ).count();
		m_now = seconds;
	}

	void afterStep( Stage& stage, double seconds ) override
	{
		const pliant::StepReport& report = stage.world().stepReport();
		const double resampling = report.levels + report.fracture;
		m_frames.push_back( { 1e3 * ( report.total - resampling ), 1e3 * ( resampling + m_cutting ) } );
		m_nodes.push_back( double( report.nodes ) );
		m_selfContacts = std::max( m_selfContacts, report.selfContacts );
		m_pieces += report.fragments;
		m_now = seconds;
	}

	void beforePicture( Stage&, pliant_glue::DrawList& list ) override
	{
		for ( const Stroke& stroke : kStrokes )
		{
			if ( m_now > stroke.begin - kShownFor && m_now < stroke.end + kShownFor )
			{
				// It moves in before the stroke and continues through the air after it.
				const double early = std::min( 0.0, m_now - stroke.begin );
				const btVector3 along = stroke.along(), across( -along.y(), along.x(), 0 );
				const btVector3 middle = stroke.at( m_now ) + along * ( btScalar( early ) * kBack / btScalar( kShownFor ) - kBack / 2 );
				const auto vec = []( const btVector3& v ) { return pliant_glue::Vec3{ float( v.x() ), float( v.y() ), float( v.z() ) }; };
				list.boxes.push_back(
					{ vec( along * kBack ), vec( across * btScalar( 0.006 ) ), { 0, 0, 2 * float( kHalfEdge ) }, vec( middle ), kSteel } );
			}
		}
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		if ( m_frames.empty() )
		{
			return {};
		}
		std::vector<double> simulation, resampling;
		for ( const FrameTime& frame : m_frames )
		{
			simulation.push_back( frame.simulation );
			resampling.push_back( frame.resampling );
		}
		std::sort( simulation.begin(), simulation.end() );
		std::sort( resampling.begin(), resampling.end() );
		const double most = *std::max_element( m_nodes.begin(), m_nodes.end() );
		return { { "nodes, ms a frame (collision and self-collision included)",
					 { "first", "most", "last", "sim., least", "sim., most", "resampl., most", "sim., median" },
					 { { "here",
						   { m_nodes.front(), most, m_nodes.back(), simulation.front(), simulation.back(), resampling.back(),
							   simulation[simulation.size() / 2] } },
						 { "Steinemann et al. 2008", { 500, 1550, 1550, 3.7, 15.5, 124 } } } },
			{ "what was cut", { "links", "pieces", "self-contacts, most" },
				{ { "liver", { double( m_links ), double( m_pieces ), double( m_selfContacts ) } } } } };
	}

	double duration() const override { return kLiverCutDuration; }
	pliant_glue::DrawCamera camera( double ) const override { return { { -0.55f, 1.15f, 2.9f }, { 0, 0.78f, 0 }, 34.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.45f, 0.75f, 0.60f }, { 0, 0.6f, 0 }, 1.6f }; }

private:
	static constexpr pliant_glue::Colour kLiver = { 0.30f, 0.05f, 0.035f }, kFlesh = { 0.55f, 0.13f, 0.09f },
										 kSteel = { 0.55f, 0.57f, 0.60f };

	static pliant_glue::ModelMesh shape( Stage& stage )
	{
		const std::string path = stage.options().modelFolder + "/data/images/liver.inr";
		const pliant_glue::VolumeResult scan = pliant_glue::readVolume( path );
		if ( scan.ok() )
		{
			stage.note( "surface of the scan " + path );
			return surfaceOfVolume( scan.volume, kLiverCutSpacing );
		}
		stage.note( "shape made in code instead of liver.inr (" + scan.status.sentence + " demos/fetch_models.sh fetches it)" );
		return makeLiverLike();
	}

	pliant::SoftBody* m_liver = nullptr;
	std::vector<FrameTime> m_frames;
	std::vector<double> m_nodes;
	double m_cutting = 0, m_now = 0;
	int m_links = 0, m_pieces = 0, m_selfContacts = 0;
};

} // namespace

std::unique_ptr<Scene> makeLiverCut()
{
	return std::make_unique<LiverCut>();
}

} // namespace pliant_demos
