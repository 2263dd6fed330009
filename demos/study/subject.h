#pragma once

// One body in a world of its own, for any engine: the actions of a scene on it and the measurements of it.

#include "demos/study/candidate.h"
#include "demos/study/specimen.h"

#include <pliant/fracture.h>

#include <LinearMath/btTransform.h>

#include <Eigen/Geometry>

#include <array>
#include <functional>
#include <memory>
#include <string>

class btDiscreteDynamicsWorld;

namespace pliant_study {

/// s: a step of the game, for every engine.
constexpr double kGameStep = 1.0 / 60.0;

inline Eigen::Vector3d toEigen( const btVector3& v )
{
	return { double( v.x() ), double( v.y() ), double( v.z() ) };
}

inline btVector3 toBullet( const Eigen::Vector3d& v )
{
	return { btScalar( v.x() ), btScalar( v.y() ), btScalar( v.z() ) };
}

inline btQuaternion toBullet( const Eigen::Quaterniond& q )
{
	return { btScalar( q.x() ), btScalar( q.y() ), btScalar( q.z() ), btScalar( q.w() ) };
}

/// Sums over the body's nodes; if it has broken, over all its pieces.
struct Motion
{
	double mass = 0;                                    ///< kg
	Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< of mass, m
	Eigen::Vector3d momentum = Eigen::Vector3d::Zero(); ///< kg m/s
	Eigen::Vector3d spin = Eigen::Vector3d::Zero();     ///< angular momentum about the world's origin, kg m^2/s
	double kineticEnergy = 0;                           ///< J, of the nodes' translation
};

/// Parts of one game step, s; zero for engines that do not report them.
constexpr std::size_t kStageCount = 8;
extern const std::array<const char*, kStageCount> kStageNames;
using StageTimes = std::array<double, kStageCount>;

class Subject
{
public:
	struct Order
	{
		const Specimen* specimen = nullptr;
		Candidate candidate;
		Eigen::Quaterniond lattice =
			Eigen::Quaterniond::Identity(); ///< rotation of the mesh before it is divided into cells, reversed when the body is placed
		btTransform place = btTransform::getIdentity(); ///< of the mesh
		pliant::Fracture fracture;
		double cellSize = 0; ///< m; 0: as the candidate's number of cells requires
		bool skins = true;   ///< a step's time includes the skin
	};

	virtual ~Subject() = default;
	virtual btDiscreteDynamicsWorld& world() = 0;
	virtual void step( double seconds ) = 0;
	/// The present positions of the mesh's vertices. If the body has broken: its first vertices.
	virtual void vertices( Points& to ) = 0;
	virtual Motion motion() const = 0;
	virtual void setVelocities( const btVector3& linear, const btVector3& angular ) = 0;
	/// Holds the nodes in a world box until they are driven or released. Returns their number.
	virtual int hold( const btVector3& low, const btVector3& high ) = 0;
	/// Moves the held nodes above (or below) a height to `to( present position )` by the end of the next step.
	virtual void drive( bool upper, double height, const std::function<btVector3( const btVector3& )>& to ) = 0;
	virtual void release() = 0;

	/// Where each finest cell is, m; of a body that has broken: of its main piece, others do not count and stay as `to` has them. Bullet's
	/// bodies: each node.
	virtual void cells( Points& to ) const = 0;
	/// Puts every node where `to( its number, where it is )` says, by the end of the next step; then it is free again.
	virtual void put( const std::function<btVector3( int, const btVector3& )>& to, double seconds ) = 0;
	/// Soft substeps a step that the stiffness requires; 1 if it requires none.
	virtual int substepsNeeded() const { return 1; }

	virtual int nodes() const = 0;
	virtual int pieces() const = 0;
	virtual int substeps() const = 0; ///< of the last step
	virtual bool isHealthy() const = 0;
	virtual StageTimes stages() const { return {}; }
	/// Memory in use after its world was built and before its body was, bytes.
	double bytesBefore() const { return m_bytesBefore; }

protected:
	double m_bytesBefore = 0;
};

/// Memory in use in this process, bytes; 0 if unknown.
double bytesInUse();

/// Null if it is refused; `why` then has the reason.
std::unique_ptr<Subject> makeSubject( const Subject::Order& order, std::string& why );

// One engine in each file.
std::unique_ptr<Subject> makePliantSubject( const Subject::Order& order, std::string& why );
std::unique_ptr<Subject> makeBulletSubject( const Subject::Order& order, std::string& why );

/// The fraction of the displacement to the goal (alpha) for a step of `h` s with which a uniform stretch of the whole body stores the
/// energy that the modulus gives: alpha = E h^2 / ( rho <x^2> ), at most 1. With regions instead of the body it is the lattice's formula.
double wholeBodyAlpha( const Specimen& specimen, const pliant::Material& material, double h );

} // namespace pliant_study
