// +-----------------------------------------------------------------------------------------------------------------+
// | The methods under comparison.                                                                                    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/candidate.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

namespace pliant_study {

namespace {

constexpr int kFewestCells = 24;
constexpr int kReferenceSubsteps = 16, kReferenceMostSubsteps = 64;
constexpr float kMergeDelay = 0.2f;

/// Builds all candidates, family by family.
class Menu
{
public:
	explicit Menu( const CandidatePlan& plan ) : m_plan( plan )
	{
		m_material.density = float( plan.density );
		m_material.youngsModulus = float( plan.modulus );
		const int steps = plan.isShort ? 2 : 5;
		int cells = plan.cells;
		for ( int k = 0; k < steps && cells >= kFewestCells; ++k )
		{
			m_sizes.push_back( cells );
			cells /= plan.isShort ? 4 : 2;
		}
		if ( m_sizes.empty() )
		{
			m_sizes.push_back( plan.cells );
		}
	}

	const std::vector<int>& sizes() const { return m_sizes; }
	const pliant::Material& material() const { return m_material; }

	Candidate& add( const std::string& family, int cells, const std::string& more )
	{
		Candidate candidate;
		candidate.family = family;
		candidate.setting = std::to_string( cells ) + " cells" + ( more.empty() ? "" : ", " + more );
		candidate.cells = cells;
		candidate.material = m_material;
		m_all.push_back( candidate );
		return m_all.back();
	}

	std::vector<Candidate> take()
	{
		std::vector<Candidate> wanted;
		for ( Candidate& candidate : m_all )
		{
			const auto begins = [&candidate]( const std::string& word ) { return candidate.family.rfind( word, 0 ) == 0; };
			if ( m_plan.only.empty() || std::any_of( m_plan.only.begin(), m_plan.only.end(), begins ) )
			{
				wanted.push_back( std::move( candidate ) );
			}
		}
		return wanted;
	}

private:
	CandidatePlan m_plan;
	pliant::Material m_material;
	std::vector<int> m_sizes;
	std::vector<Candidate> m_all;
};

/// Müller et al. 2005: clusters, with the stiffness at which a stretch of the whole body stores the energy that the modulus gives
/// (Subject).
void addMueller( Menu& menu )
{
	using pliant::ClusterMode;
	const std::pair<const char*, ClusterMode> modes[] = {
		{ "Müller rigid", ClusterMode::Rigid }, { "Müller linear", ClusterMode::Linear }, { "Müller quadratic", ClusterMode::Quadratic } };
	for ( const auto& [name, mode] : modes )
	{
		Candidate& candidate = menu.add( name, menu.sizes().back(), "" );
		candidate.material.method = pliant::Method::SingleCluster;
		candidate.material.clusterMode = mode;
	}
	for ( const int cells : { menu.sizes().front(), menu.sizes().back() } )
	{
		Candidate& candidate = menu.add( "Müller clusters", cells, "linear, edge 4" );
		candidate.material.method = pliant::Method::Clusters;
	}
}

/// Rivers and James 2007 with our kernels and momentum-conserving weights: Pliant's default.
void addUniform( Menu& menu, bool isShort )
{
	for ( int w = 1; w <= ( isShort ? 2 : 3 ); ++w )
	{
		for ( const int cells : menu.sizes() )
		{
			Candidate& candidate = menu.add( "uniform w " + std::to_string( w ), cells, "" );
			candidate.material.regionHalfWidth = w;
			candidate.isOurs = true;
		}
	}
	for ( const int substeps : { 1, 2, 8 } )
	{
		for ( std::size_t k = 0; k < menu.sizes().size() && !isShort; k += 2 )
		{
			Candidate& candidate = menu.add(
				"uniform w 1", menu.sizes()[k], std::to_string( substeps ) + ( substeps == 1 ? " substep" : " substeps" ) );
			candidate.substeps = substeps;
			candidate.isOurs = true;
		}
	}
}

/// Octree methods: the papers' and ours, with as many levels as fit.
void addLevels( Menu& menu, const CandidatePlan& plan )
{
	pliant::Adaptivity conserving = pliant::ohtaAdaptivity( 1 );
	const struct
	{
		const char* family;
		pliant::Adaptivity settings;
		pliant::Weights weights;
		bool isOurs;
	} methods[] = { { "Steinemann", pliant::steinemannAdaptivity( 1 ), pliant::Weights::Literal, false },
		{ "Ohta, literal", pliant::ohtaAdaptivity( 1 ), pliant::Weights::Literal, false },
		{ "Ohta, conserving", conserving, pliant::Weights::Conserving, false },
		{ "ours, levels", pliant::Adaptivity(), pliant::Weights::Conserving, true } };
	const std::size_t sizes = std::min<std::size_t>( menu.sizes().size(), 3 );
	for ( const auto& method : methods )
	{
		for ( std::size_t k = 0; k < sizes; ++k )
		{
			for ( int levels = 1; levels <= plan.levels; ++levels )
			{
				Candidate& candidate = menu.add(
					method.family, menu.sizes()[k], std::to_string( levels ) + ( levels == 1 ? " level" : " levels" ) );
				candidate.adaptivity = method.settings;
				candidate.adaptivity.coarseLevels = levels;
				candidate.material.weights = method.weights;
				candidate.isOurs = method.isOurs;
			}
		}
	}
	for ( std::size_t k = 0; k < sizes; ++k )
	{
		for ( const float strain : { 0.15f, 0.3f } )
		{
			char text[40];
			std::snprintf( text, sizeof( text ), "%d levels, split at %.2f", plan.levels, double( strain ) );
			Candidate& candidate = menu.add( "ours, refined", menu.sizes()[k], text );
			candidate.adaptivity.coarseLevels = plan.levels;
			candidate.adaptivity.refineStrain = strain;
			candidate.adaptivity.mergeDelay = kMergeDelay;
			candidate.isOurs = true;
		}
	}
}

void addOthers( Menu& menu, const CandidatePlan& plan )
{
	for ( const int cells : menu.sizes() )
	{
		Candidate& candidate = menu.add( "ours, implicit", cells, "one step" );
		candidate.material.elasticity = pliant::Elasticity::Implicit;
		candidate.substeps = 1;
		candidate.isOurs = true;
	}
	for ( std::size_t k = 0; k < std::min<std::size_t>( menu.sizes().size(), 3 ); ++k )
	{
		Candidate& candidate = menu.add( "ours, far levels", menu.sizes()[k], "1 far level, 2 substeps" );
		candidate.material.farLevels = 1;
		candidate.substeps = 2;
		candidate.isOurs = true;
	}
	if ( !plan.withBullet )
	{
		return;
	}
	Candidate& pose = menu.add( "Bullet pose matching", 0, "" );
	pose.setting = "the mesh's own vertices";
	pose.engine = Engine::BulletPose;
	for ( const int clusters : { 8, 32 } )
	{
		Candidate& candidate = menu.add( "Bullet clusters", 0, "" );
		candidate.setting = std::to_string( clusters ) + " clusters";
		candidate.engine = Engine::BulletClusters;
		candidate.clusters = clusters;
	}
}

std::string number( float value )
{
	char text[32];
	std::snprintf( text, sizeof( text ), "%.6g", double( value ) );
	std::string made = text;
	return made.find_first_of( ".e" ) == std::string::npos ? made + ".0f" : made + "f";
}

} // namespace

std::vector<Candidate> candidates( const CandidatePlan& plan )
{
	Menu menu( plan );
	addMueller( menu );
	addUniform( menu, plan.isShort );
	addLevels( menu, plan );
	addOthers( menu, plan );
	return menu.take();
}

Candidate reference( const CandidatePlan& plan )
{
	Menu menu( plan );
	Candidate made = menu.add( "reference", 8 * plan.cells, "w 1" );
	made.substeps = kReferenceSubsteps;
	made.mostSubsteps = kReferenceMostSubsteps;
	return made;
}

std::string codeOf( const Candidate& candidate )
{
	if ( candidate.engine != Engine::Pliant )
	{
		return "// " + candidate.name() + ": Bullet's own soft body; see btSoftBody.h\n";
	}
	const pliant::Material& m = candidate.material;
	const pliant::Adaptivity& a = candidate.adaptivity;
	const char* const elasticities[] = { "Explicit", "Implicit", "Automatic" };
	std::ostringstream out;
	out << "pliant::LatticeSettings lattice;\nlattice.targetCells = " << candidate.cells << ";\npliant::Material material;\n";
	out << "material.density = " << number( m.density ) << ";\nmaterial.youngsModulus = " << number( m.youngsModulus ) << ";\n";
	if ( m.regionHalfWidth != 1 )
	{
		out << "material.regionHalfWidth = " << m.regionHalfWidth << ";\n";
	}
	if ( m.farLevels != 0 )
	{
		out << "material.farLevels = " << m.farLevels << ";\n";
	}
	out << "material.elasticity = pliant::Elasticity::" << elasticities[int( m.elasticity )] << ";\n";
	if ( m.weights == pliant::Weights::Literal )
	{
		out << "material.weights = pliant::Weights::Literal;\n";
	}
	if ( m.method == pliant::Method::SingleCluster )
	{
		out << "material.method = pliant::Method::SingleCluster;\nmaterial.clusterMode = pliant::ClusterMode( " << int( m.clusterMode )
			<< " );\nmaterial.stiffness = pliant::Stiffness::RawAlpha; // and material.alpha, of your body's size\n";
	}
	else if ( m.method == pliant::Method::Clusters )
	{
		out << "material.method = pliant::Method::Clusters;\nmaterial.clusterEdge = " << m.clusterEdge << ";\n";
	}
	if ( a.coarseLevels != 0 )
	{
		out << "pliant::Adaptivity adaptivity;\n";
		if ( candidate.family.rfind( "Steinemann", 0 ) == 0 )
		{
			out << "adaptivity = pliant::steinemannAdaptivity( " << a.coarseLevels << " );\n";
		}
		else if ( candidate.family.rfind( "Ohta", 0 ) == 0 )
		{
			out << "adaptivity = pliant::ohtaAdaptivity( " << a.coarseLevels << " );\n";
		}
		else
		{
			out << "adaptivity.coarseLevels = " << a.coarseLevels << ";\n";
		}
		if ( a.refineStrain > 0 )
		{
			out << "adaptivity.refineStrain = " << number( a.refineStrain ) << ";\n";
			out << "adaptivity.mergeDelay = " << number( a.mergeDelay ) << ";\n";
		}
	}
	if ( candidate.substeps > 0 )
	{
		out << "world.setSoftSubsteps( " << candidate.substeps << " );\n";
	}
	return out.str();
}

} // namespace pliant_study
