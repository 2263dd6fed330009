#pragma once

// Elasticity::Automatic: chooses the bodies that take the implicit step in the next game step, and those of them that take it in every
// substep. docs/design/implicit.md, "Automatic" and "Rebound".

class btDiscreteDynamicsWorld;

#include <LinearMath/btScalar.h>

#include <vector>

namespace pliant {

class SoftBody;
struct StiffnessPlan;

class ImplicitChoice
{
public:
	/// Decides for all bodies with Elasticity::Automatic, island by island. `substeps`: the number that explicit bodies would get.
	void choose( const std::vector<SoftBody*>& bodies, btDiscreteDynamicsWorld& world, btScalar gameStep, int substeps );

	/// Whether an explicit body may take the implicit step because of the rigid bodies that its substeps would move: those that can break
	/// may not, since fewer links break in the implicit step.
	static bool mayLeaveGroup( const SoftBody& body );
	/// Chooses the implicit step for such a body.
	static void leaveGroup( SoftBody& body );

private:
	void measureLoads( btDiscreteDynamicsWorld& world );
	bool isTooStiff( const SoftBody& body, btScalar gameStep, int substeps ) const;
	bool isTooHeavilyLoaded( SoftBody& body, const btDiscreteDynamicsWorld& world, btScalar gameStep ) const;

	std::vector<SoftBody*> m_automatic;
};

/// The choice for one body, kept between steps.
struct ElasticityState
{
	bool isImplicit = false;  ///< the choice
	double calmTime = 0.0;    ///< time since the implicit step was last needed, s
	double load = 0.0;        ///< on its touched nodes, in units of their own weight, smoothed
	double landingTime = 0.0; ///< that a landing of an implicit body still takes, s; 0: none
	double blow = 0.0;        ///< mean square of the changes of its nodes' velocities by impulses since the last step, (m/s)^2

	// Of the current game step.
	bool checksLoads = false; ///< its stiffness alone does not need the implicit step
	bool needsImplicit = false;
	double rolling = 0.0;                 ///< of a body whose rolling substeps may resolve, from 0 (it rocks at rest) to 1
	double heaviestLoad = 0.0;            ///< mass of the heaviest object that rests on it, kg
	double impulse = 0.0, nodeMass = 0.0; ///< impulse on its touched nodes, N s, and their mass, kg
};

/// Whether the body's next substep is implicit.
bool stepsImplicitly( const SoftBody& body );
/// The velocity of sound of longitudinal waves in a thin bar of the body's material, m/s.
double soundVelocity( const SoftBody& body );
/// The edge of a cube of the body's volume, m.
double sizeOf( const SoftBody& body );
/// Returns how far sound travels in a step of `h`, s, in body sizes.
double travelOfSound( const SoftBody& body, double h );
/// How far a step of `h`, s, resolves the body's vibrations and impacts, from 0, not at all, to 1.
double resolvedFraction( const SoftBody& body, double h );

/// How an implicit body takes a game step.
struct ImplicitStepPlan
{
	int parts = 1;                 ///< equal parts of the step
	float numericalDamping = 1.0f; ///< in each of them, [0, 1]
};
/// Divides a game step of `gameStep`, s, where it would not resolve a landing, a body that rolls, or vibrations that the material keeps
/// (Material::numericalDamping below 1), all in at most `usual` parts; where the body's shape changes much; and where the step is long.
ImplicitStepPlan planImplicitStep( const SoftBody& body, double gameStep, int usual );

/// Limits the alpha of a free implicit body that neither breaks nor flows to what floats resolve in a whole game step. `substeps`: those of
/// `plan`.
void limitStiffness( const SoftBody& body, int substeps, StiffnessPlan& plan );

/// Returns the fraction of restitution that acts on an implicit body against a heavy object in a step of `h`, s, [0, 1]: none where the
/// step resolves the impact, from which the body rebounds by its own elasticity.
double restitutionFraction( const SoftBody& body, double h );

} // namespace pliant
