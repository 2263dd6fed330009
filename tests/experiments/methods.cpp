#include "experiments/methods.h"

namespace pliant::experiment {

std::vector<NamedMethod> staticMethods( int coarseLevels )
{
	std::vector<NamedMethod> methods;
	const auto add = [&]( const char* name, RegionRule regions, Softening softening, ResidualRule residual, Weights weights ) {
		Adaptivity settings;
		settings.coarseLevels = coarseLevels;
		settings.regions = regions;
		settings.softening = softening;
		settings.residual = residual;
		methods.push_back( NamedMethod{ name, settings, weights } );
	};
	const Weights conserving = Weights::Conserving, literal = Weights::Literal;
	add( "Steinemann, literal", RegionRule::Interval, Softening::None, ResidualRule::Keep, literal );
	add( "Steinemann, conserving", RegionRule::Interval, Softening::None, ResidualRule::Keep, conserving );
	add( "union, beta 0, literal", RegionRule::Union, Softening::None, ResidualRule::Keep, literal );
	add( "Ohta eq. 10, literal", RegionRule::Union, Softening::Ohta3D, ResidualRule::Keep, literal );
	add( "Ohta eq. 10, conserving", RegionRule::Union, Softening::Ohta3D, ResidualRule::Keep, conserving );
	add( "Ohta eq. 8, conserving", RegionRule::Union, Softening::Ohta1D, ResidualRule::Keep, conserving );
	add( "multiplicity, beta 0", RegionRule::Multiplicity, Softening::None, ResidualRule::Keep, conserving );
	add( "multiplicity, eq. 10", RegionRule::Multiplicity, Softening::Ohta3D, ResidualRule::Keep, conserving );
	add( "multiplicity, eq. 10, eta = beta", RegionRule::Multiplicity, Softening::Ohta3D, ResidualRule::Soften, conserving );
	add( "energy, eta 0", RegionRule::Multiplicity, Softening::Energy, ResidualRule::Keep, conserving );
	add( "energy, eta = beta", RegionRule::Multiplicity, Softening::Energy, ResidualRule::Soften, conserving );
	add( "energy, larger eta", RegionRule::Multiplicity, Softening::Energy, ResidualRule::Larger, conserving );
	add( "tensor, eta = beta", RegionRule::Multiplicity, Softening::EnergyTensor, ResidualRule::Soften, conserving );
	add( "tensor, larger eta (ours)", RegionRule::Multiplicity, Softening::EnergyTensor, ResidualRule::Larger, conserving );
	return methods;
}

std::vector<NamedMethod> refiningMethods( int coarseLevels )
{
	std::vector<NamedMethod> methods;
	for ( const float strain : { 0.3f, 0.2f, 0.15f } )
	{
		Adaptivity settings;
		settings.coarseLevels = coarseLevels;
		settings.refineStrain = strain;
		settings.mergeDelay = 0.2f;
		methods.push_back( NamedMethod{ "ours, refined at " + std::to_string( strain ).substr( 0, 4 ), settings, Weights::Conserving } );
	}
	return methods;
}

} // namespace pliant::experiment
