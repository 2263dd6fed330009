#pragma once

// What a testing machine says of the material: rows against theory, M1 to M15.

#include "demos/study/coupon.h"

#include <string>
#include <vector>

namespace pliant_study {

/// How a row's error is taken.
enum class Judge : int
{
	Ratio,      ///< value / theory - 1
	Difference, ///< value - theory
	Spread,     ///< largest over smallest - 1: `value` and `theory` hold the two
	AtMost      ///< value itself
};

struct MaterialRow
{
	std::string id; ///< "M1"
	std::string what;
	std::string unit;
	double value = 0, theory = 0;
	double bound = 0; ///< of the error's size
	Judge judge = Judge::Ratio;
	std::string note;

	double error() const;
	bool hasPassed() const;
};

/// Of the smallest and the largest of what should be one.
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

// Balance under loads: materials_balance.cpp.
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
// What must not matter: materials_same.cpp.
std::vector<MaterialRow> measureLevels( bool isShort );
std::vector<MaterialRow> measureSteps( bool isShort );
std::vector<MaterialRow> measureTurned( bool isShort );

/// E, m/m of what lies in the middle of a bar along x that is drawn at both ends: stress over stretch, and the contraction across over it.
struct TensionResult
{
	double modulus = 0, poisson = 0;
};
TensionResult drawBar( Coupon& bar, double strain, double grip );
/// Tip deflection of a bar along x that is held by its first layer and laden at its last, over what a beam's is with shear.
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
