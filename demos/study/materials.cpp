// +-----------------------------------------------------------------------------------------------------------------+
// | M1 to M15 as one table: printed, as CSV and as a page.                                                           |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/materials.h"

#include "demos/study/page.h"
#include "demos/study/progress.h"
#include "demos/study/theory.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace pliant_study {

namespace {

const char* toString( Judge judge )
{
	static const char* const kNames[] = { "ratio", "difference", "spread", "at most" };
	return kNames[int( judge )];
}

std::string errorText( const MaterialRow& row )
{
	char text[32];
	const bool isFraction = row.judge == Judge::Ratio || row.judge == Judge::Spread;
	std::snprintf( text, sizeof( text ), isFraction ? "%+.2f %%" : "%+.3g", isFraction ? 100 * row.error() : row.error() );
	return text;
}

std::string boundText( const MaterialRow& row )
{
	const bool isFraction = row.judge == Judge::Ratio || row.judge == Judge::Spread;
	return shortNumber( isFraction ? 100 * row.bound : row.bound ) + ( isFraction ? " %" : "" );
}

void print( const MaterialRow& row )
{
	std::printf( "%-4s %-82s %11s %11s %10s %8s  %s%s%s\n", row.id.c_str(), row.what.c_str(), shortNumber( row.value ).c_str(),
		shortNumber( row.theory ).c_str(), errorText( row ).c_str(), boundText( row ).c_str(), row.hasPassed() ? "passed" : "FAILED",
		row.note.empty() ? "" : "; ", row.note.c_str() );
}

bool writePage( const std::string& path, const std::vector<MaterialRow>& rows, bool isShort )
{
	std::ofstream page( path );
	page << "<!doctype html><html lang=en><meta charset=utf-8><title>Material benchmarks</title><style>body{font:14px/1.5 "
			"system-ui,sans-serif;margin:2rem}"
			"table{border-collapse:collapse;font-size:13px}td,th{padding:.2rem .6rem;border-bottom:1px solid "
			"#ddd;text-align:right}td:nth-child(-n+2),th:nth-child(-n+2),"
			"td:last-child{text-align:left}.passed{background:#cfe8cf}.failed{background:#f0b4a8}</style><h1>Material "
			"benchmarks</h1><p>Testing pieces of the explicit step"
		 << ( isShort ? " (short version)" : "" ) << " against theory, on " << processorName()
		 << ". A row has passed where its error is within its "
			"bound.</p><table><tr><th></th><th>what</th><th>value</th><th>theory</th><th>unit</th><th>error</th><th>bound</th>"
			"<th></th><th></th></tr>\n";
	for ( const MaterialRow& row : rows )
	{
		const bool passed = row.hasPassed();
		page << "<tr><td>" << row.id << "</td><td>" << row.what << "</td><td>" << shortNumber( row.value ) << "</td><td>"
			 << shortNumber( row.theory ) << "</td><td>" << row.unit << "</td><td>" << errorText( row ) << "</td><td>" << boundText( row )
			 << "</td><td class=" << ( passed ? "passed>passed" : "failed>FAILED" ) << "</td><td>" << row.note << "</td></tr>\n";
	}
	page << "</table></html>\n";
	return bool( page.flush() );
}

bool writeCsv( const std::string& path, const std::vector<MaterialRow>& rows )
{
	std::ofstream csv( path );
	csv.precision( 9 );
	csv << "id;what;value;theory;unit;judged_by;error;bound;passed;note\n";
	for ( const MaterialRow& row : rows )
	{
		csv << row.id << ';' << row.what << ';' << row.value << ';' << row.theory << ';' << row.unit << ';' << toString( row.judge ) << ';'
			<< row.error() << ';' << row.bound << ';' << ( row.hasPassed() ? "yes" : "no" ) << ';' << row.note << '\n';
	}
	return bool( csv.flush() );
}

} // namespace

double MaterialRow::error() const
{
	switch ( judge )
	{
		case Judge::Ratio: return value / theory - 1;
		case Judge::Spread: return value / theory - 1;
		case Judge::Difference: return value - theory;
		default: return value;
	}
}

bool MaterialRow::hasPassed() const
{
	return std::abs( error() ) <= bound; // false also if it is not a number
}

MaterialRow spreadRow(
	const std::string& id, const std::string& what, const std::string& unit, const std::vector<double>& values, double bound )
{
	const auto [low, high] = std::minmax_element( values.begin(), values.end() );
	return { id, what + ", largest and smallest", unit, *high, *low, bound, Judge::Spread, "" };
}

const std::vector<MaterialTest>& materialTests()
{
	static const std::vector<MaterialTest> kTests = {
		{ "M1", "tension and compression", true, measureTension },
		{ "M2", "pure shear", false, measureShear },
		{ "M3", "cantilever, small load", true, measureCantilever },
		{ "M4", "cantilever, large deflection", false, measureHeavyCantilever },
		{ "M5", "end moments to a circle", false, measureCircle },
		{ "M6", "frequency and damping", true, measureFrequency },
		{ "M7", "twist and release", false, measureTwist },
		{ "M8", "large stretch", false, measureStretch },
		{ "M9", "Cook's membrane", false, measureCook },
		{ "M10", "plate of one cell", false, measurePlate },
		{ "M11", "rod of one cell", false, measureRod },
		{ "M12", "crushed and released", false, measureSquash },
		{ "M13", "every level of detail", true, measureLevels },
		{ "M14", "every step", true, measureSteps },
		{ "M15", "every way the lattice lies", true, measureTurned },
	};
	return kTests;
}

int studyMaterials( const MaterialPlan& plan )
{
	std::vector<MaterialTest> tests = materialTests();
	tests.erase( std::remove_if( tests.begin(), tests.end(),
					 [&plan]( const MaterialTest& test ) {
						 return !plan.only.empty() && std::find( plan.only.begin(), plan.only.end(), test.id ) == plan.only.end();
					 } ),
		tests.end() );
	std::vector<MaterialRow> rows;
	bool isWithin = true;
	{
		Progress progress( int( tests.size() ) );
		for ( const MaterialTest& test : tests )
		{
			progress.begin( std::string( test.id ) + " " + test.name );
			for ( const MaterialRow& row : test.measure( plan.isShort ) )
			{
				isWithin = isWithin && ( row.hasPassed() || !test.isDemanded );
				rows.push_back( row );
			}
			progress.done();
		}
	}
	std::printf( "\n%-4s %-82s %11s %11s %10s %8s\n", "", "", "value", "theory", "error", "bound" );
	for ( const MaterialRow& row : rows )
	{
		print( row );
	}
	std::error_code error;
	std::filesystem::create_directories( plan.folder, error );
	if ( !writeCsv( plan.folder + "/materials.csv", rows ) || !writePage( plan.folder + "/materials.html", rows, plan.isShort ) )
	{
		std::fprintf( stderr, "pliant_study: %s cannot be written.\n", plan.folder.c_str() );
		return 1;
	}
	std::printf( "\n%s/materials.html, materials.csv\n", plan.folder.c_str() );
	return isWithin ? 0 : 3;
}

} // namespace pliant_study
