#pragma once

// The stage of a scene: a world, its rigid and soft bodies, and their colours.

#include "demos/explicit_material.h"
#include "demos/step_log.h"

#include "third_party_glue/draw_list.h"
#include "third_party_glue/model_file.h"

#include <pliant/soft_body_world.h>

#include <btBulletDynamicsCommon.h>

#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pliant_demos {

struct StageOptions
{
	int threads = 1;
	int softSubsteps = 0; ///< 0: the world's default
	unsigned seed = 1;
	bool gpuSkin = false;    ///< the renderer computes the skins
	std::string modelFolder; ///< holds data/meshes of libcgal-demo; may be missing
};

/// Request for a soft body.
struct SoftOrder
{
	std::string name;
	const pliant_glue::ModelMesh* mesh = nullptr;
	int cells = 1000;
	float cellSize = 0;                                ///< m; 0: as `cells` requires
	std::shared_ptr<const pliant::BodyTemplate> shape; ///< if several bodies share one; `mesh` and cells are then ignored
	btTransform place = btTransform::getIdentity();
	pliant::Material material = pliant_demos::explicitMaterial();
	pliant::Adaptivity adaptivity;
	pliant::StiffnessField stiffness;
	pliant::Fracture fracture;
	pliant::ToughnessField toughness;
	pliant::CrackSettings cracks; ///< ignored if `shape` is given
	btScalar friction = btScalar( 0.5 );
	pliant_glue::Colour colour = { 0.8f, 0.4f, 0.25f };
	pliant_glue::Colour insideColour = { -1, -1, -1 }; ///< of the faces of cracks; below 0: `colour`
};

struct StageCounts
{
	int softBodies = 0, nodes = 0, links = 0, rigidBodies = 0, triangles = 0;
	int fragments = 0; ///< of the soft bodies: number that broke off others
};

/// Which of Bullet's worlds a stage has.
enum class StageWorld
{
	Plain,
	MultiBodies
};

class Stage
{
public:
	explicit Stage( const StageOptions& options, std::string name = {}, StageWorld kind = StageWorld::Plain );
	~Stage();
	Stage( const Stage& ) = delete;
	Stage& operator=( const Stage& ) = delete;

	/// Of a stage with SoftBodyWorld.
	pliant::SoftBodyWorld& world() { return *m_plain; }
	const pliant::SoftBodyWorld& world() const { return *m_plain; }
	/// Of a stage with multibodies.
	btMultiBodyDynamicsWorld& multiBodyWorld() { return *m_multiBodies; }
	/// Common to the worlds of all stages.
	pliant::SoftBodyHost& host() { return *m_host; }
	const StageOptions& options() const { return m_options; }
	const std::string& name() const { return m_name; }
	void setName( const std::string& name ) { m_name = name; }
	/// Takes part in steps and measurements, but is not drawn.
	void hide() { m_isDrawn = false; }

	/// The plane y = 0.
	void addGround( btScalar friction );
	/// Mass 0 makes a static body.
	btRigidBody* addBox( const btVector3& size, const btTransform& place, btScalar mass, const pliant_glue::Colour& colour );
	btRigidBody* addSphere( btScalar diameter, const btVector3& place, btScalar mass, const pliant_glue::Colour& colour );
	/// A static body becomes kinematic: it moves to `place` and pushes the objects in its path.
	static void moveBody( btRigidBody* body, const btTransform& place );
	void addConstraint( std::unique_ptr<btTypedConstraint> constraint, bool bodiesCollide );
	/// Null if the mesh or the material is refused; `status()` then has the reason.
	pliant::SoftBody* addSoft( const SoftOrder& order );
	/// The order's mesh as a template for several bodies. Null as above.
	std::shared_ptr<const pliant::BodyTemplate> buildShape( const SoftOrder& order );
	/// Red, green, blue for each vertex of the skin, linear; empty: the body's single colour again.
	void colourVertices( const pliant::SoftBody* body, std::vector<float> colours );

	/// One game step, recorded in the log.
	void step( double seconds );
	const StepLog& log() const { return m_log; }

	/// The model file if it exists, otherwise the shape from code; records which of the two.
	pliant_glue::ModelMesh modelOr( const std::string& file, const std::function<pliant_glue::ModelMesh()>& shape );
	void note( const std::string& sentence ) { m_notes.push_back( sentence ); }
	const std::vector<std::string>& notes() const { return m_notes; }

	const pliant::Status& status() const { return m_status; }
	StageCounts counts() const;
	/// FNV-1a over the bits of every node and rigid body: equal for equal runs.
	std::uint64_t stateHash() const;

	/// Updates every skin, which reading the surface would do otherwise, and records the time in the log.
	void skin();

	/// Adds every body to the picture; nodes as spheres instead of skins when `showNodes`. Meshes are numbered from `firstId`.
	void draw( pliant_glue::DrawList& list, bool showNodes, std::uint64_t firstId ) const;

private:
	struct RigidItem
	{
		std::unique_ptr<btCollisionShape> shape;
		std::unique_ptr<btRigidBody> body;
		btVector3 size = btVector3( 0, 0, 0 );
		pliant_glue::Colour colour = { 0, 0, 0 };
		bool isSphere = false;
		bool isDrawn = true;
	};
	struct SoftItem
	{
		std::unique_ptr<pliant::SoftBody> owned; ///< null for fragments, which belong to the world
		pliant::SoftBody* body = nullptr;
		std::uint64_t id = 0; ///< of the drawn mesh; unique among the items of this stage
		pliant_glue::Colour colour = { 0, 0, 0 };
		std::vector<float> vertexColours;
		pliant_glue::Colour insideColour = { -1, -1, -1 };
		unsigned colouredVersion = 0; ///< topology for whose crack faces vertexColours are valid
	};

	/// Data of a body's drawing, wherever its skin is computed.
	struct ShownMesh
	{
		unsigned topologyVersion;
		int vertexCount, triangleCount;
		const std::uint32_t *indices, *triangleSource;
	};
	ShownMesh shownMesh( const pliant::SoftBody& body ) const;

	btRigidBody* addRigid( std::unique_ptr<btCollisionShape> shape, const btTransform& place, btScalar mass, RigidItem looks );
	void followFragments();
	void colourCracks( SoftItem& item ) const;
	void drawNodes( const SoftItem& item, pliant_glue::DrawList& list ) const;

	StageOptions m_options;
	std::string m_name;
	pliant::Status m_status;
	std::vector<std::string> m_notes;
	StepLog m_log;
	bool m_isSkinned = false; // since the last step
	bool m_isDrawn = true;
	// Bullet requires that the world is deleted before the objects that it points to: members are destroyed from the bottom up.
	std::unique_ptr<btCollisionConfiguration> m_configuration;
	std::unique_ptr<btCollisionDispatcher> m_dispatcher;
	std::unique_ptr<btBroadphaseInterface> m_broadphase;
	std::unique_ptr<btConstraintSolver> m_solver;
	std::vector<RigidItem> m_rigid;
	std::vector<SoftItem> m_soft;
	std::uint64_t m_nextId = 0;
	std::vector<std::unique_ptr<btTypedConstraint>> m_constraints;
	std::unique_ptr<btDiscreteDynamicsWorld> m_world;
	pliant::SoftBodyHost* m_host = nullptr;            ///< the same world
	pliant::SoftBodyWorld* m_plain = nullptr;          ///< the same, where it is of this class
	btMultiBodyDynamicsWorld* m_multiBodies = nullptr; ///< the same, where it is of this class
};

} // namespace pliant_demos
