#pragma once

// The methods under comparison, each with its settings.

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
	std::string setting; ///< distinguishes it from others of its family; family and setting together are its name
	Engine engine = Engine::Pliant;
	int cells = 0;        ///< requested number; the nodes of Bullet's bodies are the mesh's vertices
	int clusters = 0;     ///< Engine::BulletClusters
	int substeps = 0;     ///< requested soft substeps a step; 0: the world's default. Stiffness may raise the number
	int mostSubsteps = 0; ///< 0: the world's default
	bool isOurs = false;
	pliant::Material material = pliant_demos::explicitMaterial();
	pliant::Adaptivity adaptivity;

	std::string name() const { return family + ", " + setting; }
};

struct CandidatePlan
{
	int cells = 1000;                     ///< of the finest
	int levels = 2;                       ///< largest number of levels of detail
	double density = 1000, modulus = 1e5; ///< kg/m^3, Pa
	bool withBullet = true;
	bool isShort = false;          ///< two resolutions, one threshold
	std::vector<std::string> only; ///< families whose name begins with one of these; empty: all
};

std::vector<Candidate> candidates( const CandidatePlan& plan );

/// Uniform, twice as fine along an edge as the plan's finest, at the same modulus: the reference for the errors of the others.
Candidate reference( const CandidatePlan& plan );

/// C++ code that sets this candidate's method.
std::string codeOf( const Candidate& candidate );

} // namespace pliant_study
