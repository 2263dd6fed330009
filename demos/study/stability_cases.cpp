// +-----------------------------------------------------------------------------------------------------------------+
// | The rows and columns of the stability matrix.                                                                    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/stability.h"

#include <cstdio>

namespace pliant_study {

namespace {

std::string named( const char* pattern, double value )
{
	char text[64];
	std::snprintf( text, sizeof( text ), pattern, value );
	return text;
}

StabilityMethod methodOf( const std::string& name, const pliant::Adaptivity& adaptivity, pliant::Weights weights )
{
	StabilityMethod method;
	method.name = name;
	method.candidate.family = name;
	method.candidate.adaptivity = adaptivity;
	method.candidate.material.weights = weights;
	return method;
}

} // namespace

std::vector<StabilityCase> stabilityCases()
{
	std::vector<StabilityCase> all;
	const auto add = [&all]( const std::string& name, Ordeal ordeal ) -> StabilityCase& {
		StabilityCase one;
		one.name = name;
		one.ordeal = ordeal;
		all.push_back( one );
		return all.back();
	};
	add( "alpha 1", Ordeal::Drop ).isRawAlpha = true;
	for ( double modulus = 1e3; modulus < 2e9; modulus *= 10 )
	{
		add( named( "E %.0e Pa", modulus ), Ordeal::Drop ).modulus = modulus;
	}
	for ( const int rate : { 10, 30, 240, 1000, 10000 } )
	{
		add( named( "step 1/%.0f s", rate ), Ordeal::Drop ).step = 1.0 / rate;
	}
	for ( const double speed : { 100.0, 1000.0 } )
	{
		add( named( "%.0f m/s", speed ), Ordeal::Drop ).speed = speed;
	}
	for ( const double ratio : { 1.0, 100.0, 1e4, 1e6 } )
	{
		add( named( "load 1:%.0f", ratio ), Ordeal::Load ).massRatio = ratio;
	}
	const std::pair<const char*, Ordeal> deformed[] = { { "flat", Ordeal::Flat }, { "mirrored", Ordeal::Mirrored },
		{ "scrambled", Ordeal::Scrambled }, { "one point", Ordeal::Point }, { "stretched x1000", Ordeal::Stretched },
		{ "twisted 720", Ordeal::Twisted }, { "spin", Ordeal::Spin } };
	for ( const auto& [name, ordeal] : deformed )
	{
		add( name, ordeal ).gravity = 0;
	}
	add( "gravity 1000", Ordeal::Drop ).gravity = 1000;
	for ( const double scale : { 1e-3, 1e3 } )
	{
		add( named( "diagonal %g m", scale ), Ordeal::Drop ).diagonal = scale;
	}
	for ( const double away : { 1e4, 1e6 } )
	{
		add( named( "%g m away", away ), Ordeal::Drop ).far = away;
	}
	for ( const char* shape : { "plate", "rod" } )
	{
		StabilityCase& one = add( std::string( "one-cell " ) + shape, Ordeal::Drop );
		one.shape = shape;
		one.cells = shape[0] == 'p' ? 100 : 10;
	}
	add( "single cell", Ordeal::Drop ).cells = 1;
	return all;
}

std::vector<StabilityMethod> stabilityMethods( bool withBullet )
{
	using pliant::Weights;
	std::vector<StabilityMethod> all;
	const auto add = [&all]( const std::string& name, const pliant::Adaptivity& adaptivity = {},
						 Weights weights = Weights::Conserving ) -> StabilityMethod& {
		all.push_back( methodOf( name, adaptivity, weights ) );
		return all.back();
	};
	add( "explicit" ); // uniform, w 1: the first column is the one that counts
	add( "w 2" ).candidate.material.regionHalfWidth = 2;
	add( "w 3" ).candidate.material.regionHalfWidth = 3;
	add( "far levels" ).candidate.material.farLevels = 1;
	add( "implicit" ).candidate.material.elasticity = pliant::Elasticity::Implicit;
	pliant::Adaptivity levels, refined;
	levels.coarseLevels = refined.coarseLevels = 2;
	refined.refineStrain = 0.15f;
	refined.refinesOnContact = true;
	add( "levels", levels );
	add( "refined", refined );
	add( "volume" ).candidate.material.volumeKeeping = 1;
	add( "plastic" ).isPlastic = true;
	add( "breaking" ).isFracturing = true;
	add( "refined, breaking", refined ).isFracturing = true;
	StabilityMethod& everything = add( "refined, breaking, plastic, volume", refined );
	everything.isFracturing = everything.isPlastic = true;
	everything.candidate.material.volumeKeeping = 1;
	add( "Steinemann", pliant::steinemannAdaptivity( 2 ), Weights::Literal );
	add( "Ohta literal", pliant::ohtaAdaptivity( 2 ), Weights::Literal );
	add( "Ohta conserving", pliant::ohtaAdaptivity( 2 ) );
	const std::pair<const char*, pliant::ClusterMode> modes[] = { { "Müller rigid", pliant::ClusterMode::Rigid },
		{ "Müller linear", pliant::ClusterMode::Linear }, { "Müller quadratic", pliant::ClusterMode::Quadratic } };
	for ( const auto& [name, mode] : modes )
	{
		StabilityMethod& method = add( name );
		method.candidate.material.method = pliant::Method::SingleCluster;
		method.candidate.material.clusterMode = mode;
	}
	add( "Müller clusters" ).candidate.material.method = pliant::Method::Clusters;
	if ( withBullet )
	{
		add( "Bullet pose" ).candidate.engine = Engine::BulletPose;
		StabilityMethod& clusters = add( "Bullet clusters" );
		clusters.candidate.engine = Engine::BulletClusters;
		clusters.candidate.clusters = 8;
	}
	return all;
}

const char* toString( Colour colour )
{
	static const char* const kNames[] = { "green", "yellow", "red", "-" };
	return kNames[int( colour )];
}

} // namespace pliant_study
