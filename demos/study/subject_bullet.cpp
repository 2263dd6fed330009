// +-----------------------------------------------------------------------------------------------------------------+
// | Bullet's own soft bodies under study: pose matching and clusters, with settings as close to the same material as |
// | possible.                                                                                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/subject.h"

#if PLIANT_HAS_BULLET_SOFT_BODY

	#include <BulletSoftBody/btSoftBody.h>
	#include <BulletSoftBody/btSoftBodyHelpers.h>
	#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
	#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
	#include <btBulletDynamicsCommon.h>

	#include <algorithm>
	#include <cmath>

#endif

namespace pliant_study {

#if PLIANT_HAS_BULLET_SOFT_BODY

namespace {

constexpr int kMostVertices = 20000;

class BulletSubject : public Subject
{
public:
	std::string init( const Order& order )
	{
		const pliant_glue::ModelMesh& mesh = order.specimen->mesh;
		if ( mesh.vertexCount() > kMostVertices )
		{
			return "Bullet's soft bodies take a node for each vertex: this mesh has more than " + std::to_string( kMostVertices ) + ".";
		}
		m_world.setGravity( btVector3( 0, 0, 0 ) );
		m_bytesBefore = bytesInUse();
		m_world.getWorldInfo().m_gravity.setZero();
		std::vector<int> triangles( mesh.indices.begin(), mesh.indices.end() );
		std::vector<btScalar> positions( mesh.positions.begin(), mesh.positions.end() );
		m_body.reset( btSoftBodyHelpers::CreateFromTriMesh(
			m_world.getWorldInfo(), positions.data(), triangles.data(), int( mesh.triangleCount() ), false ) );
		m_body->setTotalMass( btScalar( double( order.candidate.material.density ) * order.specimen->volume ), true );
		m_body->transform( order.place );
		// Alpha of each step: the same formula as for one cluster of ours.
		const double fraction = wholeBodyAlpha( *order.specimen, order.candidate.material, kGameStep );
		m_body->m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
		if ( order.candidate.engine == Engine::BulletPose )
		{
			m_body->m_cfg.kMT = btScalar( fraction );
			m_body->setPose( false, true );
		}
		else
		{
			m_body->generateClusters( order.candidate.clusters );
			for ( int k = 0; k < m_body->clusterCount(); ++k )
			{
				m_body->m_clusters[k]->m_matching = btScalar( fraction );
			}
		}
		m_body->setActivationState( DISABLE_DEACTIVATION );
		m_world.addSoftBody( m_body.get() );
		return {};
	}

	~BulletSubject() override
	{
		if ( m_body )
		{
			m_world.removeSoftBody( m_body.get() );
		}
	}

	btDiscreteDynamicsWorld& world() override { return m_world; }

	void step( double seconds ) override
	{
		m_world.getWorldInfo().m_gravity = m_world.getGravity();
		m_world.stepSimulation( btScalar( seconds ), 0 );
	}

	void vertices( Points& to ) override
	{
		for ( int i = 0; i < std::min( int( to.cols() ), m_body->m_nodes.size() ); ++i )
		{
			to.col( i ) = toEigen( m_body->m_nodes[i].m_x );
		}
	}

	Motion motion() const override
	{
		Motion sum;
		for ( int i = 0; i < m_body->m_nodes.size(); ++i )
		{
			const btSoftBody::Node& node = m_body->m_nodes[i];
			const double mass = node.m_im > 0 ? 1.0 / double( node.m_im ) : 0.0; // held nodes have none
			const Eigen::Vector3d x = toEigen( node.m_x ), v = toEigen( node.m_v );
			sum.mass += mass;
			sum.centre += mass * x;
			sum.momentum += mass * v;
			sum.spin += x.cross( mass * v );
			sum.kineticEnergy += 0.5 * mass * v.squaredNorm();
		}
		sum.centre /= sum.mass;
		return sum;
	}

	void setVelocities( const btVector3& linear, const btVector3& angular ) override
	{
		const Eigen::Vector3d c = motion().centre;
		const btVector3 centre( btScalar( c.x() ), btScalar( c.y() ), btScalar( c.z() ) );
		for ( int i = 0; i < m_body->m_nodes.size(); ++i )
		{
			btSoftBody::Node& node = m_body->m_nodes[i];
			node.m_v = linear + angular.cross( node.m_x - centre );
		}
	}

	int hold( const btVector3& low, const btVector3& high ) override
	{
		const std::size_t before = m_held.size();
		for ( int i = 0; i < m_body->m_nodes.size(); ++i )
		{
			const btVector3 x = m_body->m_nodes[i].m_x;
			btVector3 inside = x;
			inside.setMax( low );
			inside.setMin( high );
			if ( inside == x )
			{
				m_held.push_back( { i, m_body->getMass( i ) } );
				m_body->setMass( i, 0 );
			}
		}
		return int( m_held.size() - before );
	}

	void drive( bool upper, double height, const std::function<btVector3( const btVector3& )>& to ) override
	{
		for ( const Held& held : m_held )
		{
			btSoftBody::Node& node = m_body->m_nodes[held.node];
			if ( ( double( node.m_x.y() ) > height ) == upper )
			{
				node.m_x = to( node.m_x );
				node.m_v.setZero();
			}
		}
	}

	void release() override
	{
		for ( const Held& held : m_held )
		{
			m_body->setMass( held.node, held.mass );
		}
		m_held.clear();
	}

	void cells( Points& to ) const override
	{
		to.resize( 3, m_body->m_nodes.size() );
		for ( int i = 0; i < m_body->m_nodes.size(); ++i )
		{
			to.col( i ) = toEigen( m_body->m_nodes[i].m_x );
		}
	}

	void put( const std::function<btVector3( int, const btVector3& )>& to, double ) override
	{
		for ( int i = 0; i < m_body->m_nodes.size(); ++i )
		{
			btSoftBody::Node& node = m_body->m_nodes[i];
			node.m_x = node.m_q = to( i, node.m_x );
			node.m_v.setZero();
		}
	}

	int nodes() const override { return m_body->m_nodes.size(); }
	int pieces() const override { return 1; }
	int substeps() const override { return 1; }

	bool isHealthy() const override
	{
		for ( int i = 0; i < m_body->m_nodes.size(); ++i )
		{
			if ( !toEigen( m_body->m_nodes[i].m_x ).allFinite() )
			{
				return false;
			}
		}
		return true;
	}

private:
	struct Held
	{
		int node;
		btScalar mass;
	};
	btSoftBodyRigidBodyCollisionConfiguration m_configuration;
	btCollisionDispatcher m_dispatcher{ &m_configuration };
	btDbvtBroadphase m_broadphase;
	btSequentialImpulseConstraintSolver m_solver;
	btSoftRigidDynamicsWorld m_world{ &m_dispatcher, &m_broadphase, &m_solver, &m_configuration };
	std::unique_ptr<btSoftBody> m_body;
	std::vector<Held> m_held;
};

} // namespace

std::unique_ptr<Subject> makeBulletSubject( const Subject::Order& order, std::string& why )
{
	auto subject = std::make_unique<BulletSubject>();
	why = subject->init( order );
	return why.empty() ? std::move( subject ) : nullptr;
}

#else

std::unique_ptr<Subject> makeBulletSubject( const Subject::Order&, std::string& why )
{
	why = "built without Bullet's soft bodies";
	return nullptr;
}

#endif

} // namespace pliant_study
