#pragma once

// The methods under comparison, each with the settings it is tried at.

#include "demos/explicit_material.h"
#include <pliant/adaptivity.h>
#include <pliant/material.h>

#include <string>
#include <vector>

namespace pliant_study {

enum class Engine : int
{
	Pliant,
	BulletPose,    ///< btSoftBody, pose matching: one shape for the whole mesh
	BulletClusters ///< btSoftBody, clusters by k-means
};

struct Candidate
{
	std::string family;  ///< whose method: a colour in the plots
	std::string setting; ///< what tells it from others of its family; the two together are its name
	Engine engine = Engine::Pliant;
	int cells = 0;        ///< asked for; Bullet's bodies have the mesh's vertices for nodes
	int clusters = 0;     ///< Engine::BulletClusters
	int substeps = 0;     ///< soft substeps a step asked for; 0: the world's default. Stiffness may raise it
	int mostSubsteps = 0; ///< 0: the world's default
	bool isOurs = false;
	pliant::Material material = pliant_demos::explicitMaterial();
	pliant::Adaptivity adaptivity;

	std::string name() const { return family + ", " + setting; }
};

struct CandidatePlan
{
	int cells = 1000;                     ///< of the finest
	int levels = 2;                       ///< most levels of detail
	double density = 1000, modulus = 1e5; ///< kg/m^3, Pa
	bool withBullet = true;
	bool isShort = false;          ///< two resolutions, one threshold
	std::vector<std::string> only; ///< families whose name begins with one of these; empty: all
};

std::vector<Candidate> candidates( const CandidatePlan& plan );

/// Uniform, twice as fine along an edge as the plan's finest, at the same modulus: what the others' error is measured against.
Candidate reference( const CandidatePlan& plan );

/// C++ that sets what this candidate is.
std::string codeOf( const Candidate& candidate );

} // namespace pliant_study
