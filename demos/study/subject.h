#pragma once

// One body in a world of its own, whatever engine moves it: what a scene does to it and what is measured on it.

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

/// Sums over the body's nodes; a body that has broken: over all its pieces.
struct Motion
{
	double mass = 0;                                    ///< kg
	Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< of mass, m
	Eigen::Vector3d momentum = Eigen::Vector3d::Zero(); ///< kg m/s
	Eigen::Vector3d spin = Eigen::Vector3d::Zero();     ///< angular momentum about the world's origin, kg m^2/s
	double kineticEnergy = 0;                           ///< J, of the nodes' straight motion
};

/// Shares of one game step, s; engines that do not tell leave zeros.
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
			Eigen::Quaterniond::Identity();             ///< the mesh is turned by it before cells are laid, and back when placed
		btTransform place = btTransform::getIdentity(); ///< of the mesh
		pliant::Fracture fracture;
		double cellSize = 0; ///< m; 0: as the candidate's number of cells asks
		bool skins = true;   ///< a step's time has the skin in it
	};

	virtual ~Subject() = default;
	virtual btDiscreteDynamicsWorld& world() = 0;
	virtual void step( double seconds ) = 0;
	/// The mesh's vertices, as they stand now. Of a body that has broken: its first vertices.
	virtual void vertices( Points& to ) = 0;
	virtual Motion motion() const = 0;
	virtual void setVelocities( const btVector3& linear, const btVector3& angular ) = 0;
	/// Holds what is in a world box until it is driven or let go. How many nodes that are.
	virtual int hold( const btVector3& low, const btVector3& high ) = 0;
	/// Moves what is held and higher (or lower) than a height to `to( where it is )` by the end of the next step.
	virtual void drive( bool upper, double height, const std::function<btVector3( const btVector3& )>& to ) = 0;
	virtual void release() = 0;

	/// Where each finest cell is, m; of a body that has broken: of its main piece, others do not count and stay as `to` has them. Bullet's
	/// bodies: each node.
	virtual void cells( Points& to ) const = 0;
	/// Puts every node where `to( its number, where it is )` says, by the end of the next step; then it is free again.
	virtual void put( const std::function<btVector3( int, const btVector3& )>& to, double seconds ) = 0;
	/// Soft substeps a step that the stiffness asks for; 1 where it asks for none.
	virtual int substepsNeeded() const { return 1; }

	virtual int nodes() const = 0;
	virtual int pieces() const = 0;
	virtual int substeps() const = 0; ///< of the last step
	virtual bool isHealthy() const = 0;
	virtual StageTimes stages() const { return {}; }
	/// Memory in use when its world stood and its body did not, bytes.
	double bytesBefore() const { return m_bytesBefore; }

protected:
	double m_bytesBefore = 0;
};

/// Memory in use in this process, bytes; 0 where that is not known.
double bytesInUse();

/// Null where it is refused; `why` then says why.
std::unique_ptr<Subject> makeSubject( const Subject::Order& order, std::string& why );

// One engine a file.
std::unique_ptr<Subject> makePliantSubject( const Subject::Order& order, std::string& why );
std::unique_ptr<Subject> makeBulletSubject( const Subject::Order& order, std::string& why );

/// What a shape-matching share of the way to the goal a step of `h` s has to be, so that a uniform stretch of the whole body costs what it
/// costs at the modulus: alpha = E h^2 / ( rho <x^2> ), at most 1. With regions in place of the body it is the lattice's formula.
double wholeBodyAlpha( const Specimen& specimen, const pliant::Material& material, double h );

} // namespace pliant_study
