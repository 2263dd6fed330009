#pragma once

// Report of a world with soft bodies on its last step.

#include <vector>

namespace pliant {

class SoftBody;

/// Times of the parts of one game step, s, and counts. All zero for a world without soft bodies.
struct StepReport
{
	double forces = 0;        ///< forces and gravity
	double matching = 0;      ///< shape matching, and the block solver: the implicit step and the contacts of deformable bodies
	double collision = 0;     ///< search for contacts of all objects, rigid ones too
	double solve = 0;         ///< Bullet's solver: joints, and contacts without a deformable body
	double integrate = 0;     ///< positions from velocities, and the guard of fast nodes
	double skinning = 0;      ///< skins computed since the step before (SoftBody::surface)
	double levels = 0;        ///< changes of levels of detail
	double fracture = 0;      ///< links tested and broken, pieces and crack faces made
	double total = 0;         ///< the whole step, rigid bodies included, skins not
	int substeps = 0;         ///< soft substeps made in the last game step
	int softBodies = 0;       ///< in the world
	int awakeSoftBodies = 0;  ///< those of them that are awake
	int rigidBodies = 0;      ///< those of them that are in their rigid state (Material::rigidStrain), awake or not
	int nodes = 0;            ///< in all soft bodies
	int softContacts = 0;     ///< contact points between nodes and anything, last substep
	int implicitBodies = 0;   ///< awake bodies that took the implicit step
	int implicitPasses = 0;   ///< of the implicit solution that took most, last substep (docs/design/implicit.md)
	int implicitProducts = 0; ///< the same: products with its matrix
	int selfContacts = 0;     ///< those of them between two nodes of one body (SoftBody::setSelfCollision)
	int heldNodes =
		0; ///< fast nodes that were kept from passing through static and kinematic objects (docs/design/contacts.md), all substeps
	int levelChanges = 0;         ///< changes of bodies' levels of detail: each may split and merge many nodes
	int splits = 0;               ///< nodes that were split
	int merges = 0;               ///< nodes that replaced their children
	int nodesOnLevel[5] = {};     ///< of all soft bodies, finest first; bodies without levels have finest nodes only
	int brokenLinks = 0;          ///< between finest cells
	int fragments = 0;            ///< bodies that came off others
	int removedPieces = 0;        ///< small pieces that were not made, or have faded (SmallPieces)
	int debrisPieces = 0;         ///< pieces that the world owns, those that fade included and scenery not (DebrisBudget)
	int debrisNodes = 0;          ///< their nodes
	int debrisFading = 0;         ///< pieces that began to fade in this step because they are over the budget
	int debrisSettled = 0;        ///< pieces that became scenery in this step
	int quarantined = 0;          ///< bodies that do not move because one of their numbers became not finite
	int unreachableStiffness = 0; ///< bodies whose Young's modulus was out of reach: raise maxSoftSubsteps or regionHalfWidth
};

/// A body that broke. Its heaviest part keeps the object; the others are new bodies in the world, with its template, material, filter,
/// surface, user pointer and indices. They belong to the world, which deletes them when it is destroyed; see releaseFragment.
struct FractureEvent
{
	SoftBody* parent = nullptr;       ///< the body that broke; never null
	std::vector<SoftBody*> fragments; ///< heaviest first; empty where the body cracked and holds together
	int links = 0;                    ///< broken, between finest cells
	double area = 0;                  ///< of the crack, one side, m^2
	double energy = 0;                ///< J, that the broken links held
	double point[3] = { 0, 0, 0 };    ///< centre of the crack, world coordinates, m
	double normal[3] = { 0, 0, 0 };   ///< of the plane that fits the crack best, of unit length, either sign; zero where nothing broke
	double partingVelocity = 0;       ///< mean velocity at which the two sides part, m/s; below 0 where they approach
	int removedPieces = 0;            ///< SmallPieces::Remove
	double removedMass = 0;           ///< kg
};

} // namespace pliant
