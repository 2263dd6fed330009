// Structured bindings name every field: a new one does not compile until it is stored.

#include "archive/settings_archive.h"

namespace pliant {

void archive( Archive& archive, Material& material )
{
	auto& [density, youngsModulus, stiffness, alpha, beta, volumeKeeping, yieldStrain, plasticCreep, plasticLimit, regionHalfWidth,
		farLevels, damping, wobbleDamping, elasticity, numericalDamping, rigidStrain, method, clusterMode, clusterEdge, weights,
		rotationFrom] = material;
	archive( density, youngsModulus, alpha, beta, volumeKeeping, yieldStrain, plasticCreep, plasticLimit, regionHalfWidth, farLevels,
		damping, wobbleDamping, numericalDamping, rigidStrain, clusterEdge );
	archive.choice( stiffness, Stiffness::RawAlpha );
	archive.choice( elasticity, Elasticity::Automatic );
	archive.choice( method, Method::Clusters );
	archive.choice( clusterMode, ClusterMode::Quadratic );
	archive.choice( weights, Weights::Literal );
	archive.choice( rotationFrom, RotationFrom::F );
}

void archive( Archive& archive, Fracture& fracture )
{
	auto& [rule, breakStrain, strength, coolDown, growthFraction, shardSize, toughness, crumbFraction, shardSeed, shardPattern, grain,
		grainLength, smallCells, smallPieces, fadeTime, maxPieces] = fracture;
	archive.choice( rule, BreakRule::Shards );
	archive( breakStrain, strength, coolDown, growthFraction, shardSize, toughness, crumbFraction, shardSeed, grain, grainLength,
		smallCells, fadeTime, maxPieces );
	archive.choice( shardPattern, ShardPattern::Rings );
	archive.choice( smallPieces, SmallPieces::Remove );
}

void archive( Archive& archive, Adaptivity& adaptivity )
{
	auto& [coarseLevels, keepMass, isSurfaceFine, regions, softening, residual, coarseStiffness, intervalSlack, hierarchicalSums,
		refineStrain, mergeFraction, mergeDelay, refinesOnContact, nodesPerStep] = adaptivity;
	archive( coarseLevels, keepMass, isSurfaceFine, coarseStiffness, intervalSlack, hierarchicalSums, refineStrain, mergeFraction,
		mergeDelay, refinesOnContact, nodesPerStep );
	archive.choice( regions, RegionRule::Interval );
	archive.choice( softening, Softening::EnergyTensor );
	archive.choice( residual, ResidualRule::Larger );
}

void archive( Archive& archive, CrackSettings& settings )
{
	auto& [faces, noiseAmplitude, noiseWavelength, noiseSeed, subdivision, bendTolerance, textureTile] = settings;
	archive.choice( faces, CrackFaces::Bricks );
	archive( noiseAmplitude, noiseWavelength, noiseSeed, subdivision, bendTolerance, textureTile );
}

void archive( Archive& archive, LatticeSettings& settings )
{
	auto& [cellSize, targetCells, maxCells, maxTriangles, samplesPerEdge, weldTolerance, minimumFill, shell, shellThickness, skinning,
		contactSurface, cracks, runner, progress, progressContext] = settings;
	archive( cellSize, targetCells, maxCells, maxTriangles, samplesPerEdge, weldTolerance, minimumFill, shellThickness, contactSurface );
	archive( cracks );
	archive.choice( shell, Shell::Always );
	archive.choice( skinning, Skinning::None );
	if ( archive.isReading() )
	{
		runner = nullptr;
		progress = nullptr;
		progressContext = nullptr;
	}
}

void archive( Archive& archive, BuildReport& report )
{
	auto& [weldedVertices, flippedTriangles, droppedTriangles, openEdges, nonManifoldEdges, shells, cells, shellCells, samplesPerEdge,
		splitCells, cutLinks, components, volume, seconds] = report;
	archive( weldedVertices, flippedTriangles, droppedTriangles, openEdges, nonManifoldEdges, shells, cells, shellCells, samplesPerEdge,
		splitCells, cutLinks, components, volume, seconds );
}

void archive( Archive& archive, StiffnessPlan& plan )
{
	auto& [alpha, reachedModulus, substepsNeeded, reachable] = plan;
	archive( alpha, reachedModulus, substepsNeeded, reachable );
}

} // namespace pliant
