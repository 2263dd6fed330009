// +-----------------------------------------------------------------------------------------------------------------+
// | A body of Pliant's under study, through the public face only.                                                    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/must_succeed.h"
#include "demos/study/small_world.h"
#include "demos/study/subject.h"

#include <pliant/soft_body_world.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>

namespace pliant_study {

const std::array<const char*, kStageCount> kStageNames = {
	"forces", "matching", "collision", "solve", "integrate", "levels", "fracture", "skin" };

double wholeBodyAlpha( const Specimen& specimen, const pliant::Material& material, double h )
{
	return std::min( 1.0, double( material.youngsModulus ) * h * h / ( double( material.density ) * specimen.spread ) );
}

namespace {

constexpr int kDefaultSubsteps = 4;
constexpr int kStepsToSplit = 4;

class PliantSubject : public Subject
{
public:
	std::string init( const Order& order )
	{
		m_world.setGravity( btVector3( 0, 0, 0 ) );
		m_bytesBefore = bytesInUse();
		pliant_glue::ModelMesh turned = order.specimen->mesh;
		const auto count = Eigen::Index( turned.vertexCount() );
		Eigen::Map<Eigen::Matrix<float, 3, Eigen::Dynamic>>(
			turned.positions.data(), 3, count ) = ( order.lattice.toRotationMatrix() * order.specimen->points ).cast<float>();
		const pliant::MeshView view = {
			turned.positions.data(), turned.vertexCount(), 3, turned.indices.data(), turned.triangleCount(), nullptr, nullptr };
		pliant::LatticeSettings settings;
		settings.targetCells = order.candidate.cells;
		settings.cellSize = float( order.cellSize );
		settings.skinning = order.skins ? pliant::Skinning::NearbyNodes : pliant::Skinning::None;
		const auto shape = pliant::BodyTemplate::build( view, settings );
		if ( !shape )
		{
			return shape.status.sentence;
		}
		pliant::Material material = order.candidate.material;
		if ( material.method == pliant::Method::SingleCluster )
		{
			const int substeps = order.candidate.substeps > 0 ? order.candidate.substeps : kDefaultSubsteps;
			material.alpha = float( wholeBodyAlpha( *order.specimen, material, kGameStep / substeps ) );
		}
		const btTransform back( toBullet( order.lattice.conjugate() ) );
		auto body = pliant::SoftBody::create( shape.value, order.place * back, material, order.candidate.adaptivity );
		if ( !body )
		{
			return body.status.sentence;
		}
		m_body = std::move( body.value );
		if ( order.fracture.rule != pliant::BreakRule::Never )
		{
			const pliant::Status status = m_body->setFracture( order.fracture );
			if ( !status.ok() )
			{
				return status.sentence;
			}
		}
		m_body->setActivationState( DISABLE_DEACTIVATION ); // the time of a sleeping body would be meaningless
		if ( order.candidate.substeps > 0 )
		{
			m_world.setSoftSubsteps( order.candidate.substeps );
		}
		if ( order.candidate.mostSubsteps > 0 )
		{
			m_world.setMaxSoftSubsteps( order.candidate.mostSubsteps );
		}
		m_world.addSoftBody( m_body.get() );
		m_skins = order.skins;
		return {};
	}

	~PliantSubject() override
	{
		if ( m_body )
		{
			m_world.removeSoftBody( m_body.get() );
		}
	}

	btDiscreteDynamicsWorld& world() override { return m_world; }

	void step( double seconds ) override
	{
		m_world.stepSimulation( btScalar( seconds ), 0 );
		for ( int k = 0; k < m_world.softBodyCount() && m_skins; ++k )
		{
			m_world.softBody( k )->surface();
		}
	}

	void vertices( Points& to ) override
	{
		const pliant::SurfaceView skin = m_body->surface();
		const Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>> positions( skin.positions, 3, skin.vertexCount );
		to = positions.leftCols( std::min<Eigen::Index>( to.cols(), skin.vertexCount ) ).cast<double>().colwise() + toEigen( skin.origin );
	}

	Motion motion() const override
	{
		Motion sum;
		for ( int k = 0; k < m_world.softBodyCount(); ++k )
		{
			const pliant::SoftBody& body = *m_world.softBody( k );
			const double mass = double( body.mass() );
			const Eigen::Vector3d centre = toEigen( body.massCentre() ), momentum = mass * toEigen( body.linearVelocity() );
			sum.mass += mass;
			sum.centre += mass * centre;
			sum.momentum += momentum;
			sum.spin += centre.cross( momentum ) + toEigen( body.angularMomentum() );
			for ( int i = 0; i < body.nodeCount(); ++i )
			{
				sum.kineticEnergy += 0.5 * double( body.nodeMass( i ) ) * toEigen( body.nodeVelocity( i ) ).squaredNorm();
			}
		}
		sum.centre /= sum.mass;
		return sum;
	}

	void setVelocities( const btVector3& linear, const btVector3& angular ) override
	{
		pliant_demos::mustSucceed( m_body->setVelocities( linear, angular ) );
	}

	int hold( const btVector3& low, const btVector3& high ) override
	{
		// The centres of coarse nodes are elsewhere: nodes to be held are split first, in a few steps at rest.
		for ( int k = 0; k < kStepsToSplit && m_body->material().method == pliant::Method::Lattice; ++k )
		{
			m_body->requestRefinement( low, high );
			m_world.stepSimulation( btScalar( kGameStep ), 0 );
		}
		return m_body->pinNodesInside( low, high );
	}

	void drive( bool upper, double height, const std::function<btVector3( const btVector3& )>& to ) override
	{
		for ( int k = 0; k < m_world.softBodyCount(); ++k )
		{
			pliant::SoftBody& body = *m_world.softBody( k );
			for ( int i = 0; i < body.nodeCount(); ++i )
			{
				const btVector3 at = body.isPinned( i ) ? body.nodePosition( i ) : btVector3( 0, 0, 0 );
				if ( body.isPinned( i ) && ( double( at.y() ) > height ) == upper )
				{
					pliant_demos::mustSucceed( body.driveNode( i, to( at ) ) );
				}
			}
		}
	}

	void release() override
	{
		for ( int k = 0; k < m_world.softBodyCount(); ++k )
		{
			pliant::SoftBody& body = *m_world.softBody( k );
			for ( int i = 0; i < body.nodeCount(); ++i )
			{
				if ( body.isPinned( i ) )
				{
					body.releaseNode( i );
				}
			}
		}
	}

	void cells( Points& to ) const override
	{
		const int count = m_body->bodyTemplate().cellCount();
		to.conservativeResize( 3, count );
		for ( int k = 0; k < count; ++k )
		{
			const int node = m_body->nodeOfCell( k );
			if ( node >= 0 )
			{
				to.col( k ) = toEigen( m_body->nodePosition( node ) );
			}
		}
	}

	void put( const std::function<btVector3( int, const btVector3& )>& to, double seconds ) override
	{
		for ( int i = 0; i < m_body->nodeCount(); ++i )
		{
			pliant_demos::mustSucceed( m_body->driveNode( i, to( i, m_body->nodePosition( i ) ) ) );
		}
		step( seconds );
		release();
		pliant_demos::mustSucceed( m_body->setVelocities( btVector3( 0, 0, 0 ), btVector3( 0, 0, 0 ) ) );
	}

	int substepsNeeded() const override { return m_body->stiffnessPlan().substepsNeeded; }

	int nodes() const override { return m_world.stepReport().nodes > 0 ? m_world.stepReport().nodes : m_body->nodeCount(); }
	int pieces() const override { return m_world.softBodyCount(); }
	int substeps() const override { return m_world.stepReport().substeps; }
	bool isHealthy() const override { return m_body->isHealthy() && m_world.stepReport().quarantined == 0; }

	StageTimes stages() const override
	{
		const pliant::StepReport& r = m_world.stepReport();
		return { r.forces, r.matching, r.collision, r.solve, r.integrate, r.levels, r.fracture, r.skinning };
	}

private:
	WorldParts m_parts;
	pliant::SoftBodyWorld& m_world = m_parts.world;
	std::unique_ptr<pliant::SoftBody> m_body;
	bool m_skins = true;
};

} // namespace

std::unique_ptr<Subject> makePliantSubject( const Subject::Order& order, std::string& why )
{
	auto subject = std::make_unique<PliantSubject>();
	why = subject->init( order );
	return why.empty() ? std::move( subject ) : nullptr;
}

std::unique_ptr<Subject> makeSubject( const Subject::Order& order, std::string& why )
{
	return order.candidate.engine == Engine::Pliant ? makePliantSubject( order, why ) : makeBulletSubject( order, why );
}

} // namespace pliant_study
