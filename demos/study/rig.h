#pragma once

// The scenes of the study. Lengths are in units of the mesh's diagonal D and times in units of sqrt( D / g ), so that every mesh is treated
// alike.

#include "demos/study/subject.h"

#include <memory>
#include <string>
#include <vector>

class btRigidBody;
class btCollisionShape;

namespace pliant_study {

enum class SceneKind : int
{
	Drop,   ///< falls on the ground
	Hang,   ///< held at its top
	Twist,  ///< held at both ends, one of them rotated by 90 degrees, then released
	Push,   ///< held at its foot, a ball is pushed into its side and removed
	Impact, ///< free, a ball of half its mass hits it
	Tear,   ///< held at both ends and pulled until it breaks
	Fly     ///< free and spinning
};

struct SceneInfo
{
	SceneKind kind;
	const char* name;
	const char* description;
	double length; ///< in sqrt( D / g )
	bool hasGravity;
	bool isFree;      ///< no external force or constraint: momentum has to be constant
	bool keepsEnergy; ///< no external work: mechanical energy must not grow
	bool takesBullet; ///< available for Bullet's own bodies
	int framesAWrite; ///< number of frames from one comparison of the vertices to the next
};

const std::vector<SceneInfo>& sceneInfos();
/// Null if there is no scene of that name.
const SceneInfo* findSceneInfo( const std::string& name );

class Rig
{
public:
	/// Null if the body is refused; `why` then has the reason. Lattice orientation 0 is the mesh's own, others are random, the same in
	/// every run.
	static std::unique_ptr<Rig> create(
		const SceneInfo& scene, const Specimen& specimen, const Candidate& candidate, int orientation, std::string& why );
	~Rig();

	/// One game step. Returns the wall-clock time of the engine alone, s.
	double step();
	int frame() const { return m_frame; }
	int frames() const { return m_frames; }
	Subject& subject() { return *m_subject; }
	/// Of soft and rigid bodies together.
	Motion motion() const;
	/// Kinetic and gravitational energy, J, without elastic energy.
	double mechanicalEnergy() const;
	/// The centre of the pushing or hitting ball; false without a ball.
	bool ball( Eigen::Vector3d& middle, double& radius ) const;

private:
	Rig( const SceneInfo& scene, const Specimen& specimen );
	/// False if no part of the body is in the region to be held.
	bool furnish();
	void drive();
	void addBall( double mass, const Eigen::Vector3d& place );
	double seconds() const { return m_frame * kGameStep; }

	SceneInfo m_scene;
	const Specimen& m_specimen;
	double m_unit = 1; ///< sqrt( D / g ), s
	int m_frame = 0, m_frames = 0;
	double m_ballRadius = 0;
	std::unique_ptr<Subject> m_subject;
	std::vector<std::unique_ptr<btCollisionShape>> m_shapes;
	std::vector<std::unique_ptr<btRigidBody>> m_rigid;
	btRigidBody* m_ball = nullptr;
};

} // namespace pliant_study
