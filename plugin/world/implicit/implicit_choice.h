#pragma once

// Elasticity::Automatic: which bodies take the implicit step in the next game step. docs/design/implicit.md, "Automatic".

class btDiscreteDynamicsWorld;

#include <LinearMath/btScalar.h>

#include <vector>

namespace pliant {

class SoftBody;

class ImplicitChoice
{
public:
	/// Decides for all bodies with Elasticity::Automatic, an island at a time. `substeps`: those that explicit bodies would get.
	void choose( const std::vector<SoftBody*>& bodies, btDiscreteDynamicsWorld& world, btScalar gameStep, int substeps );

private:
	void measureLoads( btDiscreteDynamicsWorld& world );
	bool isTooStiff( const SoftBody& body, btScalar gameStep, int substeps ) const;
	bool isTooHeavilyLoaded( SoftBody& body, const btDiscreteDynamicsWorld& world, btScalar gameStep ) const;

	std::vector<SoftBody*> m_asked;
};

/// Choice of one body, as kept between steps.
struct ElasticityState
{
	bool isImplicit = false; ///< chosen
	double calm = 0.0;       ///< s for which nothing has asked for it
	double load = 0.0;       ///< what its touched nodes carry in units of their own weight, smoothed

	// Of this step.
	bool feelsLoads = false; ///< its stiffness alone does not ask for it
	bool needs = false;
	double heaviest = 0.0;                ///< mass of the heaviest thing that lies on it, kg
	double impulse = 0.0, nodeMass = 0.0; ///< that its nodes carry, N s, and their mass, kg
};

} // namespace pliant
