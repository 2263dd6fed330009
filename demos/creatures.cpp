// +-----------------------------------------------------------------------------------------------------------------+
// | A palm with thin fingers, a hand, a flower.                                                                      |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/creatures.h"

#include "demos/solids.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant_demos {

using pliant_glue::ModelMesh;

namespace {

ModelMesh asOnePart( const char* name, ModelMesh mesh )
{
	mesh.name = name;
	mesh.submeshNames = { name };
	mesh.submeshOfTriangle.assign( mesh.triangleCount(), 0 );
	return mesh;
}

} // namespace

ModelMesh makePalm( const PalmPlan& plan )
{
	const float d = plan.cell;
	const Point half = { plan.width( 0 ) / 2, plan.width( 1 ) / 2, plan.width( 2 ) / 2 };
	const float length = d * float( plan.fingerCells );
	const auto field = [&]( const Point& p ) {
		float inside = roundBox( p, half, half, 1.5f * d );
		for ( const auto& at : plan.fingers )
		{
			const Point top = { d * float( at[0] ), 2 * d, d * float( at[1] ) }, tip = { top[0], d - length, top[2] };
			inside = std::max( inside, rod( p, top, tip, d, d ) );
		}
		return inside;
	};
	// Not on the faces of the palm, so that no corner of the grid lies on them.
	const float margin = 1.37f * d;
	return asOnePart( "palm",
		marchSurface( field, { -margin, -length - margin, -margin }, { 2 * half[0] + margin, 2 * half[1] + margin, 2 * half[2] + margin },
			0.8f * d ) );
}

const std::vector<Digit>& handDigits()
{
	static const std::vector<Digit> kDigits = { { { -0.15f, 0.20f, 0.02f }, { -0.36f, 0.46f, 0.06f }, 0.060f },
		{ { -0.145f, 0.40f, 0 }, { -0.19f, 0.79f, 0 }, 0.052f }, { { -0.048f, 0.42f, 0 }, { -0.055f, 0.86f, 0 }, 0.054f },
		{ { 0.050f, 0.41f, 0 }, { 0.075f, 0.81f, 0 }, 0.052f }, { { 0.140f, 0.37f, 0 }, { 0.205f, 0.67f, 0 }, 0.046f } };
	return kDigits;
}

DigitFraction digitAt( const float* point )
{
	const std::vector<Digit>& digits = handDigits();
	const Point p = { point[0], point[1], point[2] };
	DigitFraction best{ 0, 0 };
	float most = std::numeric_limits<float>::lowest();
	for ( std::size_t i = 0; i < digits.size(); ++i )
	{
		const Digit& digit = digits[i];
		const float inside = rod( p, digit.root, digit.tip, digit.radius, digit.radius );
		if ( inside > most )
		{
			most = inside;
			float along = 0, length = 0;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				along += ( p[k] - digit.root[k] ) * ( digit.tip[k] - digit.root[k] );
				length += ( digit.tip[k] - digit.root[k] ) * ( digit.tip[k] - digit.root[k] );
			}
			best = { i, std::clamp( along / ( std::sqrt( length ) * digit.radius ), 0.0f, 1.0f ) };
		}
	}
	return best;
}

ModelMesh makeHand()
{
	const auto field = [&]( const Point& p ) {
		float inside = roundBox( p, { 0, 0.29f, 0 }, { 0.195f, 0.165f, 0.075f }, 0.07f );
		inside = join( inside, rod( p, { 0, -0.02f, 0 }, { 0, 0.20f, 0 }, 0.10f, 0.11f ), 0.08f );
		for ( const Digit& digit : handDigits() )
		{
			inside = join( inside, rod( p, digit.root, digit.tip, digit.radius * 1.08f, digit.radius * 0.9f ), 0.035f );
		}
		return std::min( inside, p[1] ); // a flat foot
	};
	return asOnePart( "hand", marchSurface( field, { -0.47f, -0.013f, -0.17f }, { 0.31f, 0.95f, 0.17f }, 0.0147f ) );
}

ModelMesh makeFlower( int petals )
{
	constexpr float kTurn = 6.28318530718f;
	constexpr float kLean = 0.30f; // rad, outward
	const auto turned = [&]( float angle, float lean ) {
		const float c = std::cos( angle ), s = std::sin( angle ), cl = std::cos( lean ), sl = std::sin( lean );
		// Outward, upward along the petal, sideways.
		return std::array<Point, 3>{ Point{ c * cl, -sl, s * cl }, Point{ c * sl, cl, s * sl }, Point{ -s, 0, c } };
	};
	const auto field = [&]( const Point& p ) {
		float head = ellipsoid( p, { 0, kFlowerHeadFrom + 0.03f, 0 }, turned( 0, 0 ), { 0.07f, 0.055f, 0.07f } );
		for ( int k = 0; k < petals; ++k )
		{
			const float angle = kTurn * float( k ) / float( petals );
			const Point middle = { 0.085f * std::cos( angle ), kFlowerHeadMiddle, 0.085f * std::sin( angle ) };
			head = std::max( head, ellipsoid( p, middle, turned( angle, kLean ), { 0.030f, 0.125f, 0.064f } ) );
		}
		float stem = rod( p, { 0, 0.02f, 0 }, { 0, kFlowerHeadFrom + 0.02f, 0 }, 0.032f, 0.026f );
		for ( int k = 0; k < 2; ++k )
		{
			const float angle = kTurn * ( 0.13f + 0.5f * float( k ) );
			const Point middle = { 0.06f * std::cos( angle ), 0.12f, 0.06f * std::sin( angle ) };
			stem = join( stem, ellipsoid( p, middle, turned( angle, 0.5f ), { 0.024f, 0.13f, 0.045f } ), 0.02f );
		}
		return std::min( join( head, stem, 0.02f ), p[1] );
	};
	return asOnePart( "flower", marchSurface( field, { -0.26f, -0.009f, -0.26f }, { 0.26f, 0.68f, 0.26f }, 0.0243f ) );
}

} // namespace pliant_demos
