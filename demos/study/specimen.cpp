// +-----------------------------------------------------------------------------------------------------------------+
// | The mesh under study.                                                                                            |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/specimen.h"

#include "demos/shapes.h"

#include <Eigen/Geometry>

#include <cstdio>
#include <cstring>

namespace pliant_study {

namespace {

Eigen::Vector3i cornersOf( const pliant_glue::ModelMesh& mesh, std::size_t triangle )
{
	const std::uint32_t* v = &mesh.indices[3 * triangle];
	return { int( v[0] ), int( v[1] ), int( v[2] ) };
}

/// On a square of edge `width`, of height `height`.
pliant_glue::ModelMesh makeBox( float width, float height )
{
	constexpr int kCuts = 16;
	pliant_glue::ModelMesh mesh = pliant_demos::makeCube( width, kCuts );
	for ( std::size_t v = 0; v < mesh.vertexCount(); ++v )
	{
		mesh.positions[3 * v + 1] *= height / width;
	}
	return mesh;
}

/// Volume and second moment of the enclosed space: sums over the tetrahedra from the origin to each triangle.
void measureInside( Specimen& specimen )
{
	Eigen::Vector3d first = Eigen::Vector3d::Zero(), second = Eigen::Vector3d::Zero();
	for ( std::size_t t = 0; t < specimen.mesh.triangleCount(); ++t )
	{
		const Eigen::Vector3i v = cornersOf( specimen.mesh, t );
		const Eigen::Array3d a = specimen.points.col( v[0] ), b = specimen.points.col( v[1] ), c = specimen.points.col( v[2] );
		const double volume = a.matrix().dot( b.matrix().cross( c.matrix() ) ) / 6;
		specimen.volume += volume;
		first += ( volume / 4 * ( a + b + c ) ).matrix();
		// int x^2 over a tetrahedron with one corner at the origin: V / 10 ( a^2 + b^2 + c^2 + ab + bc + ca ), axis by axis.
		second += ( volume / 10 * ( a * a + b * b + c * c + a * b + b * c + c * a ) ).matrix();
	}
	specimen.spread = ( second / specimen.volume - ( first / specimen.volume ).cwiseAbs2() ).mean();
}

} // namespace

Specimen makeSpecimen( pliant_glue::ModelMesh mesh, double diagonal )
{
	Specimen specimen;
	const auto count = Eigen::Index( mesh.vertexCount() );
	specimen.points = Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>>( mesh.positions.data(), 3, count ).cast<double>();
	const Eigen::Vector3d low = specimen.points.rowwise().minCoeff(), high = specimen.points.rowwise().maxCoeff();
	const double scale = diagonal > 0 ? diagonal / ( high - low ).norm() : 1.0;
	specimen.points = scale * ( specimen.points.colwise() - ( low + high ) / 2 );
	specimen.half = scale * ( high - low ) / 2;
	specimen.diagonal = 2 * specimen.half.norm();
	Eigen::Map<Eigen::Matrix<float, 3, Eigen::Dynamic>>( mesh.positions.data(), 3, count ) = specimen.points.cast<float>();
	mesh.normals.clear();
	specimen.mesh = std::move( mesh );
	measureInside( specimen );

	specimen.fraction = Eigen::VectorXd::Zero( count );
	for ( std::size_t t = 0; t < specimen.mesh.triangleCount(); ++t )
	{
		const Eigen::Vector3i v = cornersOf( specimen.mesh, t );
		const Eigen::Vector3d a = specimen.points.col( v[0] ), b = specimen.points.col( v[1] ), c = specimen.points.col( v[2] );
		const double area = ( b - a ).cross( c - a ).norm() / 2;
		for ( const int corner : v )
		{
			specimen.fraction[corner] += area / 3;
		}
	}
	specimen.fraction /= specimen.fraction.sum();
	return specimen;
}

const std::vector<std::string>& shapeNames()
{
	static const std::vector<std::string> kNames = { "bunny", "bar", "cube", "plate", "rod", "sphere", "torus", "glob" };
	return kNames;
}

bool makeShape( const std::string& name, pliant_glue::ModelMesh& mesh )
{
	if ( name == "bunny" )
	{
		mesh = pliant_demos::makeBunnyLike();
	}
	else if ( name == "bar" ) // upright
	{
		mesh = makeBox( 1.0f, 4.0f );
	}
	else if ( name == "plate" )
	{
		mesh = makeBox( 1.0f, 0.1f );
	}
	else if ( name == "rod" )
	{
		mesh = makeBox( 1.0f, 10.0f );
	}
	else if ( name == "cube" )
	{
		mesh = makeBox( 1.0f, 1.0f );
	}
	else if ( name == "sphere" )
	{
		mesh = pliant_demos::makeSphere( 1.0f, 4 );
	}
	else if ( name == "torus" )
	{
		mesh = pliant_demos::makeTorus( 0.5f, 0.18f, 48, 24 );
	}
	else if ( name == "glob" )
	{
		mesh = pliant_demos::makeGlob();
	}
	else
	{
		return false;
	}
	return true;
}

double enclosedVolume( const pliant_glue::ModelMesh& mesh, const Points& points )
{
	// Relative to a corner of the body instead of the world's origin, so that distant bodies keep their precision.
	const Eigen::Vector3d from = points.col( 0 );
	double six = 0;
	for ( std::size_t t = 0; t < mesh.triangleCount(); ++t )
	{
		const Eigen::Vector3i v = cornersOf( mesh, t );
		const Eigen::Vector3d a = points.col( v[0] ) - from, b = points.col( v[1] ) - from, c = points.col( v[2] ) - from;
		six += a.dot( b.cross( c ) );
	}
	return six / 6;
}

std::string fingerprint( const pliant_glue::ModelMesh& mesh )
{
	std::uint64_t hash = 14695981039346656037u;
	const auto add = [&hash]( const void* data, std::size_t bytes ) {
		const auto* at = static_cast<const unsigned char*>( data );
		for ( std::size_t k = 0; k < bytes; ++k )
		{
			hash = ( hash ^ at[k] ) * 1099511628211u;
		}
	};
	add( mesh.positions.data(), mesh.positions.size() * sizeof( float ) );
	add( mesh.indices.data(), mesh.indices.size() * sizeof( std::uint32_t ) );
	char text[20];
	std::snprintf( text, sizeof( text ), "%016llx", static_cast<unsigned long long>( hash ) );
	return text;
}

} // namespace pliant_study
