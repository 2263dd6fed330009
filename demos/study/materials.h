#pragma once

// The material benchmarks M1 to M15: rows against theory.

#include "demos/study/coupon.h"

#include <string>
#include <vector>

namespace pliant_study {

/// Definition of a row's error.
enum class Judge : int
{
	Ratio,      ///< value / theory - 1
	Difference, ///< value - theory
	Spread,     ///< largest over smallest - 1: `value` and `theory` are these two
	AtMost      ///< value itself
};

struct MaterialRow
{
	std::string id; ///< "M1"
	std::string what;
	std::string unit;
	double value = 0, theory = 0;
	double bound = 0; ///< of the error's magnitude
	Judge judge = Judge::Ratio;
	std::string note;

	double error() const;
	bool hasPassed() const;
};

/// A row for the smallest and the largest of values that should be equal.
MaterialRow spreadRow(
	const std::string& id, const std::string& what, const std::string& unit, const std::vector<double>& values, double bound );

struct MaterialTest
{
	const char* id;
	const char* name;
	bool isDemanded; ///< has to be within its bounds
	std::vector<MaterialRow> ( *measure )( bool isShort );
};

const std::vector<MaterialTest>& materialTests();

// Equilibrium under loads: materials_balance.cpp.
std::vector<MaterialRow> measureTension( bool isShort );
std::vector<MaterialRow> measureShear( bool isShort );
std::vector<MaterialRow> measureCantilever( bool isShort );
std::vector<MaterialRow> measureHeavyCantilever( bool isShort );
std::vector<MaterialRow> measureCircle( bool isShort );
// More of them: materials_shapes.cpp.
std::vector<MaterialRow> measureStretch( bool isShort );
std::vector<MaterialRow> measureCook( bool isShort );
std::vector<MaterialRow> measurePlate( bool isShort );
std::vector<MaterialRow> measureRod( bool isShort );
// In motion: materials_motion.cpp.
std::vector<MaterialRow> measureFrequency( bool isShort );
std::vector<MaterialRow> measureTwist( bool isShort );
std::vector<MaterialRow> measureSquash( bool isShort );
// Parameters that must not matter: materials_same.cpp.
std::vector<MaterialRow> measureLevels( bool isShort );
std::vector<MaterialRow> measureSteps( bool isShort );
std::vector<MaterialRow> measureTurned( bool isShort );

/// E and the transverse contraction, m/m, in the middle of a bar along x that is pulled at both ends: stress over stretch, and contraction
/// over stretch.
struct TensionResult
{
	double modulus = 0, poisson = 0;
};
TensionResult drawBar( Coupon& bar, double strain, double grip );
/// Tip deflection of a bar along x that is held by its first layer and loaded at its last, over that of a beam with shear.
double loadedTip( Coupon& bar );

struct MaterialPlan
{
	std::string folder = "out/materials";
	std::vector<std::string> only; ///< M1 ...; empty: all
	bool isShort = false;
};

/// Prints every row, passed or not; writes materials.csv and materials.html. 0, or the process's exit code: 3 where a demanded row is out
/// of its bound.
int studyMaterials( const MaterialPlan& plan );

} // namespace pliant_study
