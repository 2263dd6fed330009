// +-----------------------------------------------------------------------------------------------------------------+
// | Makes bodies, keeps them alive as long as the world needs them, and passes them to the renderer as plain data.    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/stage.h"

#include "third_party_glue/assimp_mesh.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <set>

namespace pliant_demos {

using pliant_glue::Colour;
using pliant_glue::ModelMesh;
using pliant_glue::Vec3;

namespace {

constexpr btScalar kRigidFriction = btScalar( 0.5 );

using Clock = std::chrono::steady_clock;

/// Contact points without a soft body; the step report counts the others.
int rigidContacts( btDiscreteDynamicsWorld& world )
{
	int points = 0;
	for ( int i = 0; i < world.getDispatcher()->getNumManifolds(); ++i )
	{
		const btPersistentManifold* manifold = world.getDispatcher()->getManifoldByIndexInternal( i );
		const bool isRigid = pliant::SoftBody::upcast( manifold->getBody0() ) == nullptr &&
			pliant::SoftBody::upcast( manifold->getBody1() ) == nullptr;
		points += isRigid ? manifold->getNumContacts() : 0;
	}
	return points;
}

class Fnv1a
{
public:
	void add( const btVector3& v )
	{
		for ( int k = 0; k < 3; ++k )
		{
			unsigned char bytes[sizeof( btScalar )];
			std::memcpy( bytes, &v.m_floats[k], sizeof( btScalar ) );
			for ( const unsigned char byte : bytes )
			{
				m_hash = ( m_hash ^ byte ) * 0x100000001b3ull;
			}
		}
	}
	std::uint64_t value() const { return m_hash; }

private:
	std::uint64_t m_hash = 0xcbf29ce484222325ull;
};

} // namespace

btRigidBody* Stage::addRigid( std::unique_ptr<btCollisionShape> shape, const btTransform& place, btScalar mass, RigidItem looks )
{
	btVector3 inertia( 0, 0, 0 );
	if ( mass > 0 )
	{
		shape->calculateLocalInertia( mass, inertia );
	}
	btRigidBody::btRigidBodyConstructionInfo info( mass, nullptr, shape.get(), inertia );
	info.m_startWorldTransform = place;
	info.m_friction = kRigidFriction;
	looks.shape = std::move( shape );
	looks.body = std::make_unique<btRigidBody>( info );
	m_world->addRigidBody( looks.body.get() );
	m_rigid.push_back( std::move( looks ) );
	return m_rigid.back().body.get();
}

void Stage::addGround( btScalar friction )
{
	RigidItem looks;
	looks.isDrawn = false; // the renderer draws its own ground
	addRigid(
		std::make_unique<btStaticPlaneShape>( btVector3( 0, 1, 0 ), btScalar( 0 ) ), btTransform::getIdentity(), 0, std::move( looks ) )
		->setFriction( friction );
}

btRigidBody* Stage::addBox( const btVector3& size, const btTransform& place, btScalar mass, const Colour& colour )
{
	RigidItem looks;
	looks.size = size;
	looks.colour = colour;
	return addRigid( std::make_unique<btBoxShape>( size / 2 ), place, mass, std::move( looks ) );
}

btRigidBody* Stage::addSphere( btScalar diameter, const btVector3& place, btScalar mass, const Colour& colour )
{
	RigidItem looks;
	looks.size = btVector3( diameter, diameter, diameter );
	looks.colour = colour;
	looks.isSphere = true;
	btRigidBody* ball = addRigid(
		std::make_unique<btSphereShape>( diameter / 2 ), btTransform( btQuaternion::getIdentity(), place ), mass, std::move( looks ) );
	ball->setRollingFriction( btScalar( 0.004 ) ); // otherwise a ball on a plane would roll for ever
	return ball;
}

void Stage::moveBody( btRigidBody* body, const btTransform& place )
{
	body->setCollisionFlags(
		( body->getCollisionFlags() & ~btCollisionObject::CF_STATIC_OBJECT ) | btCollisionObject::CF_KINEMATIC_OBJECT );
	body->setActivationState( DISABLE_DEACTIVATION );
	body->setWorldTransform( place ); // Bullet derives the velocity from this change of position
}

void Stage::addConstraint( std::unique_ptr<btTypedConstraint> constraint, bool bodiesCollide )
{
	m_world->addConstraint( constraint.get(), !bodiesCollide );
	m_constraints.push_back( std::move( constraint ) );
}

std::shared_ptr<const pliant::BodyTemplate> Stage::buildShape( const SoftOrder& order )
{
	pliant::MeshView view;
	view.positions = order.mesh->positions.data();
	view.vertexCount = order.mesh->vertexCount();
	view.indices = order.mesh->indices.data();
	view.triangleCount = order.mesh->triangleCount();
	view.submeshOfTriangle = order.mesh->submeshOfTriangle.empty() ? nullptr : order.mesh->submeshOfTriangle.data();
	pliant::LatticeSettings settings;
	settings.targetCells = order.cells;
	settings.cellSize = order.cellSize;
	settings.cracks = order.cracks;
	auto made = pliant::BodyTemplate::build( view, settings );
	if ( !made.ok() )
	{
		m_status = { made.status.code, order.name + ": " + made.status.sentence };
	}
	return std::move( made.value );
}

pliant::SoftBody* Stage::addSoft( const SoftOrder& order )
{
	const std::shared_ptr<const pliant::BodyTemplate> shape = order.shape != nullptr ? order.shape : buildShape( order );
	if ( shape == nullptr )
	{
		return nullptr;
	}
	pliant::SoftBodyResult body = pliant::SoftBody::create( shape, order.place, order.material, order.adaptivity, order.stiffness );
	if ( !body.ok() )
	{
		m_status = { body.status.code, order.name + ": " + body.status.sentence };
		return nullptr;
	}
	if ( order.fracture.rule != pliant::BreakRule::Never )
	{
		pliant::Status status = body.value->setFracture( order.fracture, order.toughness );
		if ( status.ok() && order.fracture.rule == pliant::BreakRule::Shards )
		{
			status = body.value->prepareCracks(); // now, and not in the frame in which it shatters
		}
		if ( !status.ok() )
		{
			m_status = { status.code, order.name + ": " + status.sentence };
			return nullptr;
		}
	}
	pliant::SoftBody* const added = body.value.get();
	added->setFriction( order.friction );
	m_host->addSoftBody( added );
	m_soft.push_back( { std::move( body.value ), added, m_nextId++, order.colour, {}, order.insideColour } );
	return added;
}

void Stage::colourVertices( const pliant::SoftBody* body, std::vector<float> colours )
{
	const auto found = std::find_if( m_soft.begin(), m_soft.end(), [&]( const SoftItem& item ) { return item.body == body; } );
	if ( found != m_soft.end() )
	{
		found->vertexColours = std::move( colours );
	}
}

void Stage::step( double seconds )
{
	const Clock::time_point begin = Clock::now();
	m_world->stepSimulation( btScalar( seconds ), 0 );
	const double wallSeconds = secondsSince( begin );
	m_isSkinned = false;
	followFragments();
	m_log.add( m_host->stepReport(), wallSeconds, rigidContacts( *m_world ) );
}

/// Pieces get the colour of the body that they broke off from; bodies that the world has removed are forgotten.
void Stage::followFragments()
{
	for ( const pliant::FractureEvent& event : m_host->fractureEvents() )
	{
		for ( pliant::SoftBody* fragment : event.fragments )
		{
			const auto itemOf = [this]( const pliant::SoftBody* body ) {
				return std::find_if( m_soft.begin(), m_soft.end(), [body]( const SoftItem& item ) { return item.body == body; } );
			};
			// A fragment may have the address of one that was deleted, and is a different one nevertheless.
			if ( const auto old = itemOf( fragment ); old != m_soft.end() )
			{
				m_soft.erase( old );
			}
			const auto parent = itemOf( event.parent );
			SoftItem item;
			item.body = fragment;
			item.id = m_nextId++;
			item.colour = parent == m_soft.end() ? item.colour : parent->colour;
			item.insideColour = parent == m_soft.end() ? item.insideColour : parent->insideColour;
			if ( parent != m_soft.end() && item.insideColour[0] < 0 )
			{
				item.vertexColours = parent->vertexColours;
			}
			m_soft.push_back( std::move( item ) );
		}
	}
	if ( m_soft.size() == std::size_t( m_host->softBodyCount() ) )
	{
		return;
	}
	std::set<const pliant::SoftBody*> present;
	for ( int i = 0; i < m_host->softBodyCount(); ++i )
	{
		present.insert( m_host->softBody( i ) );
	}
	std::erase_if( m_soft, [&]( const SoftItem& item ) { return item.owned == nullptr && present.count( item.body ) == 0; } );
}

ModelMesh Stage::modelOr( const std::string& file, const std::function<ModelMesh()>& shape )
{
	const std::string path = m_options.modelFolder + "/data/meshes/" + file;
	pliant_glue::ReadResult read = pliant_glue::readModel( path );
	if ( read.ok() )
	{
		m_notes.push_back( "model " + path );
		return std::move( read.mesh );
	}
	ModelMesh made = shape();
	m_notes.push_back( "shape \"" + made.name + "\" made in code instead of " + file + " (" + read.status.sentence +
		" demos/fetch_models.sh fetches it)" );
	return made;
}

StageCounts Stage::counts() const
{
	StageCounts counts;
	for ( const SoftItem& item : m_soft )
	{
		++counts.softBodies;
		counts.nodes += item.body->nodeCount();
		counts.links += item.body->linkCount();
		counts.triangles += shownMesh( *item.body ).triangleCount;
		counts.fragments += item.owned == nullptr ? 1 : 0;
	}
	counts.rigidBodies = int( m_rigid.size() );
	return counts;
}

std::uint64_t Stage::stateHash() const
{
	Fnv1a hash;
	for ( const SoftItem& item : m_soft )
	{
		for ( int i = 0; i < item.body->nodeCount(); ++i )
		{
			hash.add( item.body->nodePosition( i ) );
		}
	}
	for ( const RigidItem& item : m_rigid )
	{
		const btTransform& at = item.body->getWorldTransform();
		hash.add( at.getOrigin() );
		hash.add( at.getBasis()[0] );
		hash.add( at.getBasis()[1] );
	}
	return hash.value();
}

} // namespace pliant_demos
