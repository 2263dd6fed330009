#pragma once

// The scenes of the study: what is done to a body. Lengths are shares of the mesh's diagonal D and times of sqrt( D / g ), so that every
// mesh is treated alike.

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
	Twist,  ///< held at both ends, one of them turned by 90 degrees, then let go
	Push,   ///< held at its foot, a ball is pushed into its side and taken away
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
	bool isFree;      ///< nothing holds or moves it from outside: momentum has to stay
	bool keepsEnergy; ///< nothing feeds it: mechanical energy must not grow
	bool takesBullet; ///< Bullet's own bodies can be tried
	int framesAWrite; ///< the vertices are compared at every so many frames
};

const std::vector<SceneInfo>& sceneInfos();
/// Null when there is none of that name.
const SceneInfo* findSceneInfo( const std::string& name );

class Rig
{
public:
	/// Null where the body is refused; `why` then says why. Lattice orientation 0 is the mesh's own, others are random, each the same every
	/// time.
	static std::unique_ptr<Rig> create(
		const SceneInfo& scene, const Specimen& specimen, const Candidate& candidate, int orientation, std::string& why );
	~Rig();

	/// One game step. Its wall-clock time, s, of the engine alone.
	double step();
	int frame() const { return m_frame; }
	int frames() const { return m_frames; }
	Subject& subject() { return *m_subject; }
	/// Of soft and rigid bodies together.
	Motion motion() const;
	/// Kinetic and in gravity's field, J; what is stored in deformation is not in it.
	double mechanicalEnergy() const;
	/// The pushing or hitting ball's middle; no ball: false.
	bool ball( Eigen::Vector3d& middle, double& radius ) const;

private:
	Rig( const SceneInfo& scene, const Specimen& specimen );
	/// False when nothing of the body is where it is to be held.
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
