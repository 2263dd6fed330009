// +-----------------------------------------------------------------------------------------------------------------+
// | The measure of Ohta et al. 2009, figure 6, on the vertices of the skin instead of the nodes: bodies of different  |
// | levels have the same vertices.                                                                                   |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/skin_distance.h"

#include "demos/palette.h"

#include <algorithm>
#include <cmath>

namespace pliant_demos {

namespace {

btVector3 vertexOf( const pliant::SurfaceView& skin, int i )
{
	const float* p = skin.positions + std::size_t( i ) * 3;
	return btVector3( btScalar( p[0] ), btScalar( p[1] ), btScalar( p[2] ) );
}

} // namespace

SkinDistance skinDistance( const pliant::SoftBody& body, const pliant::SoftBody& reference, const btVector3& apart )
{
	const pliant::SurfaceView own = body.surface(), other = reference.surface();
	const btVector3 shift = own.origin - other.origin - apart;
	const int count = std::min( own.vertexCount, other.vertexCount );
	SkinDistance found;
	if ( count == 0 )
	{
		return found;
	}
	btVector3 middle( 0, 0, 0 );
	std::vector<btVector3> offsets;
	for ( int i = 0; i < count; ++i )
	{
		offsets.push_back( vertexOf( own, i ) - vertexOf( other, i ) + shift );
		middle += offsets.back() / btScalar( count );
	}
	double squares = 0;
	for ( const btVector3& offset : offsets )
	{
		const double length = double( offset.length() );
		found.vertex.push_back( float( length ) );
		found.mean += length / count;
		squares += length * length / count;
		found.shape += double( ( offset - middle ).length() ) / count;
		found.largest = std::max( found.largest, length );
	}
	found.deviation = std::sqrt( std::max( 0.0, squares - found.mean * found.mean ) );
	return found;
}

double boxDiagonal( const pliant::SoftBody& body )
{
	const pliant::SurfaceView skin = body.surface();
	btVector3 low( BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT ), high = -low;
	for ( int i = 0; i < skin.vertexCount; ++i )
	{
		low.setMin( vertexOf( skin, i ) );
		high.setMax( vertexOf( skin, i ) );
	}
	return skin.vertexCount == 0 ? 0 : double( ( high - low ).length() );
}

std::vector<float> heatColours( const std::vector<float>& distances, double full )
{
	std::vector<float> colours;
	colours.reserve( distances.size() * 3 );
	for ( const float distance : distances )
	{
		const pliant_glue::Colour colour = heat( float( double( distance ) / full ) );
		colours.insert( colours.end(), colour.begin(), colour.end() );
	}
	return colours;
}

} // namespace pliant_demos
