#include "lattice/build/contact_patches.h"

#include "lattice/build/surface_points.h"
#include "lattice/constants.h"
#include "lattice/guarded_tasks.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace pliant {

namespace {

/// A point of the surface, in cells from the grid's low corner, with its normal and the area it represents.
struct Sample
{
	std::uint64_t key;
	Vec3d point, normal;
	double area;
};

/// Samples every triangle, or every n-th of a very fine mesh, in the order of their lattice positions.
std::vector<Sample> sampleSurface( const WeldedMesh& mesh, const Grid& grid )
{
	std::vector<Sample> samples;
	const std::size_t stride = 1 + mesh.triangle.size() / kMaxPatchTriangles;
	for ( std::size_t t = 0; t < mesh.triangle.size(); t += stride )
	{
		std::array<Vec3d, 3> corner;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			corner[k] = ( mesh.position[mesh.triangle[t][k]] - grid.corner ) / grid.cellSize;
		}
		const Vec3d across = ( corner[1] - corner[0] ).cross( corner[2] - corner[0] );
		const double size = across.norm();
		if ( !( size > 0.0 ) )
		{
			continue;
		}
		visitTriangle( corner, kPatchSampleDensity, [&]( const Vec3d& point, double area ) {
			const Eigen::Vector3i at = positionOfPoint( grid, point );
			if ( area > 0.0 )
			{
				samples.push_back( Sample{ grid.key( at.x(), at.y(), at.z() ), point, across / size, area } );
			}
		} );
	}
	std::stable_sort( samples.begin(), samples.end(), []( const Sample& a, const Sample& b ) { return a.key < b.key; } );
	return samples;
}

/// The samples near one cell, weighted by area and by a falloff with the distance from the node.
class Neighbourhood
{
public:
	Neighbourhood( const std::vector<Sample>& samples, const Grid& grid ) : m_samples( samples ), m_grid( grid ) {}

	void gather( const Eigen::Vector3i& cell, const Vec3d& node )
	{
		m_near.clear();
		constexpr int kReach = int( kPatchFitRadius ) + 1; // cells: the node is in its own
		const Eigen::Vector3i low = ( cell.array() - kReach ).max( 0 ), high = ( cell.array() + kReach ).min( m_grid.extent.array() - 1 );
		for ( int z = low.z(); z <= high.z(); ++z )
		{
			for ( int y = low.y(); y <= high.y(); ++y )
			{
				gatherRow( m_grid.key( low.x(), y, z ), m_grid.key( high.x(), y, z ), node );
			}
		}
	}

	/// The mean normal of the nearest samples, not of unit length: shorter, the more they differ.
	Vec3d meanNormal( const Vec3d& node ) const
	{
		Vec3d sum = Vec3d::Zero();
		double weight = 0.0;
		for ( const auto& [sample, fraction] : m_near )
		{
			const double near = 1.0 - ( sample->point - node ).squaredNorm() / ( kPatchNormalRadius * kPatchNormalRadius );
			if ( near > 0.0 )
			{
				sum += sample->area * near * near * sample->normal;
				weight += sample->area * near * near;
			}
		}
		return weight > 0.0 ? Vec3d( sum / weight ) : Vec3d( Vec3d::Zero() );
	}

	/// The directions in which the samples face, one each where they differ by more than 45 degrees; the heaviest first.
	void directions( std::vector<Vec3d>& out ) const
	{
		std::vector<std::pair<double, Vec3d>> groups;
		for ( const auto& [sample, fraction] : m_near )
		{
			const Vec3d& normal = sample->normal;
			const auto same = std::find_if( groups.begin(), groups.end(),
				[&]( const auto& group ) { return normal.dot( group.second.normalized() ) > kMinPatchCosine; } );
			if ( same == groups.end() )
			{
				groups.emplace_back( fraction, fraction * normal );
				continue;
			}
			same->first += fraction;
			same->second += fraction * normal;
		}
		std::stable_sort( groups.begin(), groups.end(), []( const auto& a, const auto& b ) { return a.first > b.first; } );
		out.clear();
		for ( const auto& [weight, sum] : groups )
		{
			if ( weight >= kLeastFaceWeight * groups.front().first && out.size() < kMaxEdgeFaces )
			{
				out.push_back( sum.normalized() );
			}
		}
	}

	/// Fits the height above the node along n as a + g.l - k ( |l|^2 + ( h - a )^2 ) / 2, l across n, by least squares; false where the
	/// samples do not determine it. The surface is a sphere if g is zero; the a inside the square is the input value of `out.height`.
	struct Fit
	{
		double height = 0.0, curvature = 0.0, error = 0.0;
		Vec3d slope = Vec3d::Zero();
	};
	bool fit( const Vec3d& node, const Vec3d& n, Fit& out ) const
	{
		const Vec3d s = n.unitOrthogonal(), t = n.cross( s );
		Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
		Eigen::Vector4d right = Eigen::Vector4d::Zero();
		double weight = 0.0, square = 0.0;
		const double before = out.height;
		for ( const auto& [sample, fraction] : m_near )
		{
			if ( sample->normal.dot( n ) <= kMinPatchCosine )
			{
				continue;
			}
			const Vec3d p = sample->point - node;
			const double a = p.dot( s ), b = p.dot( t ), height = p.dot( n );
			const double up = height - before;
			const Eigen::Vector4d row( 1.0, a, b, -0.5 * ( a * a + b * b + up * up ) );
			normal += fraction * row * row.transpose();
			right += fraction * height * row;
			square += fraction * height * height;
			weight += fraction;
		}
		if ( !( weight > 0.0 ) )
		{
			return false;
		}
		normal.diagonal().array() += kPatchRegularity * weight;
		const Eigen::Vector4d x = normal.ldlt().solve( right );
		out = Fit{ x[0], x[3], std::sqrt( std::max( 0.0, ( square - x.dot( right ) ) / weight ) ), x[1] * s + x[2] * t };
		return x.allFinite();
	}

private:
	void gatherRow( std::uint64_t first, std::uint64_t last, const Vec3d& node )
	{
		auto sample = std::lower_bound(
			m_samples.begin(), m_samples.end(), first, []( const Sample& a, std::uint64_t key ) { return a.key < key; } );
		for ( ; sample != m_samples.end() && sample->key <= last; ++sample )
		{
			const Vec3d p = sample->point - node;
			const double near = 1.0 - p.squaredNorm() / ( kPatchFitRadius * kPatchFitRadius );
			if ( near > 0.0 && p.dot( sample->normal ) > 0.0 )
			{
				m_near.emplace_back( &*sample, sample->area * near * near );
			}
		}
	}

	const std::vector<Sample>& m_samples;
	const Grid& m_grid;
	std::vector<std::pair<const Sample*, double>> m_near;
};

/// The patch of the samples that face along n, in cells; radius 0 where they are no smooth sheet.
ContactPatch patchAlong( const Neighbourhood& near, const Vec3d& node, Vec3d n )
{
	ContactPatch patch;
	Neighbourhood::Fit fit;
	for ( int round = 0; round < kPatchFits; ++round )
	{
		if ( !near.fit( node, n, fit ) )
		{
			return patch;
		}
		// h = a + g.l: the surface's normal is along n - g.
		n = ( n - fit.slope ).normalized();
	}
	if ( !near.fit( node, n, fit ) || fit.error > kMaxPatchError || !( fit.height > kMinPatchHeight && fit.height < kMaxPatchHeight ) )
	{
		return patch;
	}
	patch.normal = n.cast<float>();
	patch.height = float( fit.height );
	patch.radius = float( std::max( fit.height, fit.curvature * kMaxPatchRadius > 1.0 ? 1.0 / fit.curvature : kMaxPatchRadius ) );
	return patch;
}

/// In cells; radius 0 where no patch exists.
ContactPatch patchOf( const Neighbourhood& near, const Vec3d& node )
{
	const Vec3d all = near.meanNormal( node );
	return all.norm() < kMinPatchAgreement ? ContactPatch{} : patchAlong( near, node, all.normalized() );
}

void toMetres( float cellSize, ContactPatch& patch )
{
	patch.height *= cellSize;
	patch.radius *= cellSize;
}

} // namespace

void fitContactPatches( const WeldedMesh& mesh, const Grid& grid, TaskRunner* runner, Lattice& lattice )
{
	const std::vector<Sample> samples = sampleSurface( mesh, grid );
	const auto count = std::size_t( lattice.cellCount() ), tasks = std::min( kMaxTasks, count );
	lattice.patch.assign( count, ContactPatch{} );
	const Vec3d middle = ( lattice.massCentre - grid.corner ) / grid.cellSize;
	std::vector<std::vector<ContactPatch>> faces( tasks ); // of the cells of each task
	lattice.edgeFaceStart.assign( count + 1, 0 );
	auto fitSome = [&]( int task ) {
		Neighbourhood near( samples, grid );
		std::vector<Vec3d> directions;
		for ( std::size_t i = count * std::size_t( task ) / tasks; i < count * ( std::size_t( task ) + 1 ) / tasks; ++i )
		{
			if ( lattice.isSurface[i] == 0 )
			{
				continue;
			}
			const Vec3d node = middle + lattice.restCentre[i].cast<double>() / grid.cellSize;
			near.gather( lattice.coordinate[i].cast<int>(), node );
			ContactPatch& patch = lattice.patch[i];
			patch = patchOf( near, node );
			toMetres( lattice.cellSize, patch );
			patch.links = std::uint8_t( lattice.linkStart[i + 1] - lattice.linkStart[i] );
			if ( patch.radius > 0.0f )
			{
				continue;
			}
			near.directions( directions );
			for ( const Vec3d& along : directions )
			{
				ContactPatch face = patchAlong( near, node, along );
				if ( face.radius > 0.0f )
				{
					toMetres( lattice.cellSize, face );
					faces[std::size_t( task )].push_back( face );
					++lattice.edgeFaceStart[i + 1];
				}
			}
		}
	};
	runGuarded( runner, int( tasks ), fitSome );
	std::partial_sum( lattice.edgeFaceStart.begin(), lattice.edgeFaceStart.end(), lattice.edgeFaceStart.begin() );
	for ( const std::vector<ContactPatch>& some : faces )
	{
		lattice.edgeFace.insert( lattice.edgeFace.end(), some.begin(), some.end() );
	}
	for ( const std::vector<ContactPatch>* const all : { &lattice.patch, &lattice.edgeFace } )
	{
		for ( const ContactPatch& patch : *all )
		{
			lattice.overhang = std::max( lattice.overhang, patch.radius > 0.0f ? patch.height - 0.5f * lattice.cellSize : 0.0f );
		}
	}
}

} // namespace pliant
