// +-----------------------------------------------------------------------------------------------------------------+
// | From labels to a surface: the fraction of full voxels at each sample, smoothed, and the surface where it is one  |
// | half.                                                                                                            |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/liver.h"

#include "demos/marching.h"
#include "demos/shapes.h"

#include <algorithm>
#include <cmath>

namespace pliant_demos {

using pliant_glue::GreyVolume;
using pliant_glue::ModelMesh;

namespace {

constexpr int kMargin = 3;     // samples around the volume, so that the surface closes
constexpr int kSmoothings = 2; // each spreads a sample over its neighbours by 1 : 2 : 1

/// Fractions of full voxels on a grid of cubes.
class Samples
{
public:
	Samples( const GreyVolume& volume, float spacing ) : m_spacing( spacing )
	{
		std::size_t count = 1;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			m_size[k] = int( std::ceil( float( volume.size[k] ) * volume.spacing[k] / spacing ) ) + 2 * kMargin;
			count *= std::size_t( m_size[k] );
		}
		m_fraction.assign( count, 0.0f );
		std::vector<float> voxels( count, 0.0f );
		const auto sampleOf = [&]( int voxel, std::size_t k ) {
			return int( ( float( voxel ) + 0.5f ) * volume.spacing[k] / spacing ) + kMargin;
		};
		for ( int z = 0; z < volume.size[2]; ++z )
		{
			for ( int y = 0; y < volume.size[1]; ++y )
			{
				for ( int x = 0; x < volume.size[0]; ++x )
				{
					const std::size_t at = number( sampleOf( x, 0 ), sampleOf( y, 1 ), sampleOf( z, 2 ) );
					m_fraction[at] += volume.at( x, y, z ) != 0 ? 1.0f : 0.0f;
					voxels[at] += 1.0f;
				}
			}
		}
		for ( std::size_t i = 0; i < count; ++i )
		{
			m_fraction[i] /= std::max( voxels[i], 1.0f );
		}
		for ( int k = 0; k < kSmoothings; ++k )
		{
			smooth();
		}
	}

	Point extent() const
	{
		return { float( m_size[0] - 1 ) * m_spacing, float( m_size[1] - 1 ) * m_spacing, float( m_size[2] - 1 ) * m_spacing };
	}

	/// Linear between samples; 0 outside.
	float at( const Point& p ) const
	{
		std::array<int, 3> low{};
		std::array<float, 3> t{};
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const float s = p[k] / m_spacing;
			low[k] = int( std::floor( s ) );
			t[k] = s - float( low[k] );
			if ( low[k] < 0 || low[k] + 1 >= m_size[k] )
			{
				return 0.0f;
			}
		}
		float sum = 0;
		for ( int corner = 0; corner < 8; ++corner )
		{
			const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
			const float weight = ( x != 0 ? t[0] : 1 - t[0] ) * ( y != 0 ? t[1] : 1 - t[1] ) * ( z != 0 ? t[2] : 1 - t[2] );
			sum += weight * m_fraction[number( low[0] + x, low[1] + y, low[2] + z )];
		}
		return sum;
	}

private:
	std::size_t number( int x, int y, int z ) const
	{
		return ( std::size_t( z ) * std::size_t( m_size[1] ) + std::size_t( y ) ) * std::size_t( m_size[0] ) + std::size_t( x );
	}

	/// 1 : 2 : 1 along each axis in turn. No full voxel lies at the border.
	void smooth()
	{
		const std::size_t steps[3] = { 1, std::size_t( m_size[0] ), std::size_t( m_size[0] ) * std::size_t( m_size[1] ) };
		for ( const std::size_t step : steps )
		{
			std::vector<float> next( m_fraction.size(), 0.0f );
			for ( std::size_t i = step; i + step < m_fraction.size(); ++i )
			{
				next[i] = 0.25f * ( m_fraction[i - step] + 2 * m_fraction[i] + m_fraction[i + step] );
			}
			m_fraction.swap( next );
		}
	}

	float m_spacing;
	std::array<int, 3> m_size{};
	std::vector<float> m_fraction;
};

void name( ModelMesh& mesh, const char* what )
{
	mesh.name = what;
	mesh.submeshNames = { what };
	mesh.submeshOfTriangle.assign( mesh.triangleCount(), 0 );
}

} // namespace

ModelMesh surfaceOfVolume( const GreyVolume& volume, float spacing )
{
	const Samples samples( volume, spacing );
	ModelMesh mesh = marchSurface( [&]( const Point& p ) { return samples.at( p ) - 0.5f; }, { 0, 0, 0 }, samples.extent(), spacing );
	for ( std::size_t i = 0; i < mesh.positions.size(); i += 3 )
	{
		const float y = mesh.positions[i + 1];
		mesh.positions[i + 1] = mesh.positions[i + 2];
		mesh.positions[i + 2] = -y; // a rotation, not a reflection
	}
	name( mesh, "volume" );
	return mesh;
}

ModelMesh makeLiverLike()
{
	const std::vector<MetaBall> balls = { { { -0.05f, 0, 0 }, { 0.10f, 0.10f, 0.08f } },
		{ { -0.07f, -0.06f, -0.01f }, { 0.07f, 0.08f, 0.06f } }, { { 0.04f, 0.02f, 0.02f }, { 0.09f, 0.06f, 0.05f } },
		{ { 0.12f, 0.03f, 0.04f }, { 0.07f, 0.035f, 0.03f } } };
	ModelMesh mesh = makeMetaballs( balls, 0.45f, 0.006f );
	name( mesh, "liver-like" );
	return mesh;
}

} // namespace pliant_demos
