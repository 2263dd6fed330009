// +-----------------------------------------------------------------------------------------------------------------+
// | One run of one candidate, measured.                                                                              |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/measure.h"

#include <nlohmann/json.hpp>

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

#if defined( __GLIBC__ )
	#include <malloc.h>
#endif

namespace pliant_study {

double bytesInUse()
{
#if defined( __GLIBC__ ) && ( __GLIBC__ > 2 || __GLIBC_MINOR__ >= 33 )
	const struct mallinfo2 info = mallinfo2();
	return double( info.uordblks ) + double( info.hblkhd );
#else
	return 0;
#endif
}

namespace {

/// The error of a body that has flown apart or whose numbers are not finite, D: means over runs stay numbers.
constexpr double kLost = 100;

double bounded( double error )
{
	return std::isfinite( error ) ? std::min( error, kLost ) : kLost;
}

double meanDistance( const Specimen& specimen, const Points& a, const Points& b )
{
	return ( a - b ).colwise().norm().dot( specimen.fraction.transpose() ) / specimen.diagonal;
}

/// `points` moved rigidly onto `reference` (Kabsch: the rotation from the singular vectors of the weighted covariance).
Points movedOnto( const Specimen& specimen, const Points& points, const Points& reference )
{
	const Eigen::Vector3d from = points * specimen.fraction, to = reference * specimen.fraction;
	const Eigen::Matrix3d covariance = ( reference.colwise() - to ) * specimen.fraction.asDiagonal() *
		( points.colwise() - from ).transpose();
	const Eigen::JacobiSVD<Eigen::Matrix3d> svd( covariance, Eigen::ComputeFullU | Eigen::ComputeFullV );
	const double sign = ( svd.matrixU() * svd.matrixV().transpose() ).determinant() < 0 ? -1.0 : 1.0;
	const Eigen::Matrix3d rotation = svd.matrixU() * Eigen::Vector3d( 1, 1, sign ).asDiagonal() * svd.matrixV().transpose();
	return ( rotation * ( points.colwise() - from ) ).colwise() + to;
}

/// Initial values, against which drifts are measured.
class Drifts
{
public:
	Drifts( const SceneInfo& scene, const Rig& rig, double diagonal ) :
		m_scene( scene ), m_first( rig.motion() ), m_energy( rig.mechanicalEnergy() )
	{
		// A momentum of zero cannot be the unit of its drift: then the unit is the momentum that corresponds to the energy.
		const double speed = std::sqrt( 2 * m_first.kineticEnergy * m_first.mass );
		m_momentum = std::max( m_first.momentum.norm(), speed );
		m_spin = std::max( m_first.spin.norm(), speed * diagonal / 2 );
	}

	void look( const Rig& rig, Record& record ) const
	{
		if ( m_scene.isFree )
		{
			const Motion now = rig.motion();
			record.momentumDrift = std::max( record.momentumDrift, bounded( ( now.momentum - m_first.momentum ).norm() / m_momentum ) );
			record.spinDrift = std::max( record.spinDrift, bounded( ( now.spin - m_first.spin ).norm() / m_spin ) );
		}
		if ( m_scene.keepsEnergy && m_energy > 0 )
		{
			record.energyGrowth = std::max( { record.energyGrowth, 0.0, bounded( rig.mechanicalEnergy() / m_energy - 1 ) } );
		}
	}

private:
	SceneInfo m_scene;
	Motion m_first;
	double m_energy = 0, m_momentum = 0, m_spin = 0;
};

/// Median, 99th percentile and maximum of the times of all steps.
void sumUpTimes( std::vector<double> times, Record& record )
{
	std::sort( times.begin(), times.end() );
	const auto at = [&times](
						double fraction ) { return times[std::min( times.size() - 1, std::size_t( fraction * double( times.size() ) ) )]; };
	record.median = at( 0.5 );
	record.slow = at( 0.99 );
	record.slowest = times.back();
}

void addErrors( const Errors& measured, std::size_t taken, Record& record )
{
	const Errors e = { bounded( measured.mean ), bounded( measured.deviation ), bounded( measured.shape ) };
	const double fraction = 1.0 / double( taken );
	const auto blend = [fraction]( double& mean, double value ) { mean += fraction * ( value - mean ); };
	blend( record.errors.mean, e.mean );
	blend( record.errors.deviation, e.deviation );
	blend( record.errors.shape, e.shape );
	record.last = e;
	record.curve.push_back( e.mean );
}

} // namespace

Errors errorsOf( const Specimen& specimen, const Points& points, const Points& reference )
{
	Errors errors;
	const Eigen::VectorXd away = ( points - reference ).colwise().norm().transpose() / specimen.diagonal;
	errors.mean = away.dot( specimen.fraction );
	errors.deviation = std::sqrt( ( away.array() - errors.mean ).square().matrix().dot( specimen.fraction ) );
	errors.shape = meanDistance( specimen, movedOnto( specimen, points, reference ), reference );
	return errors;
}

namespace {

/// After a frame: records everything but time.
void look( const RunOrder& order, Rig& rig, const Drifts& drifts, Points& points, Record& record )
{
	Subject& subject = rig.subject();
	record.isHealthy = record.isHealthy && subject.isHealthy();
	record.pieces = std::max( record.pieces, subject.pieces() );
	if ( record.brokenAt < 0 && record.pieces > 1 )
	{
		record.brokenAt = rig.frame() * kGameStep;
	}
	drifts.look( rig, record );
	if ( rig.frame() % order.scene.framesAWrite != 0 )
	{
		return;
	}
	subject.vertices( points );
	const double rest = order.specimen->volume;
	const bool isWhole = record.brokenAt < 0;
	if ( isWhole )
	{
		record.volumeDrift = std::max(
			record.volumeDrift, bounded( std::abs( enclosedVolume( order.specimen->mesh, points ) / rest - 1 ) ) );
	}
	const std::size_t write = std::size_t( rig.frame() / order.scene.framesAWrite ) - 1;
	const bool isComparable = isWhole && ( order.referenceBrokenAt < 0 || rig.frame() * kGameStep < order.referenceBrokenAt );
	if ( order.track != nullptr )
	{
		order.track->push_back( points );
	}
	if ( order.reference != nullptr && isComparable && write < order.reference->size() )
	{
		addErrors( errorsOf( *order.specimen, points, ( *order.reference )[write] ), write + 1, record );
		if ( record.last.mean > record.worst )
		{
			record.worst = record.last.mean;
			record.worstFrame = rig.frame();
		}
	}
}

} // namespace

Record run( const RunOrder& order )
{
	Record record;
	record.candidate = order.candidate.name();
	record.family = order.candidate.family;
	record.isOurs = order.candidate.isOurs;
	record.scene = order.scene.name;
	record.orientation = order.orientation;
	if ( order.candidate.engine != Engine::Pliant && !order.scene.takesBullet )
	{
		record.refused = "Bullet's soft bodies do not break";
		return record;
	}
	const std::unique_ptr<Rig> rig = Rig::create( order.scene, *order.specimen, order.candidate, order.orientation, record.refused );
	if ( !rig )
	{
		return record;
	}
	Points points = order.specimen->points;
	const Drifts drifts( order.scene, *rig, order.specimen->diagonal );
	std::vector<double> times;
	for ( int k = 0; k < rig->frames(); ++k )
	{
		times.push_back( rig->step() );
		const StageTimes stages = rig->subject().stages();
		for ( std::size_t s = 0; s < kStageCount; ++s )
		{
			record.stages[s] += stages[s] / rig->frames();
		}
		record.nodes += double( rig->subject().nodes() ) / rig->frames();
		record.substeps += double( rig->subject().substeps() ) / rig->frames();
		look( order, *rig, drifts, points, record );
	}
	record.bytes = std::max( 0.0, bytesInUse() - rig->subject().bytesBefore() );
	sumUpTimes( std::move( times ), record );
	if ( order.reference != nullptr && record.curve.empty() )
	{
		record.refused = "it broke before it could be compared"; // otherwise its error would count as zero
	}
	return record;
}

nlohmann::json toJson( const Record& r )
{
	return { { "candidate", r.candidate }, { "family", r.family }, { "scene", r.scene }, { "orientation", r.orientation },
		{ "ours", r.isOurs }, { "refused", r.refused }, { "nodes", r.nodes }, { "substeps", r.substeps }, { "bytes", r.bytes },
		{ "median_s", r.median }, { "p99_s", r.slow }, { "max_s", r.slowest }, { "stages_s", r.stages }, { "error", r.errors.mean },
		{ "error_deviation", r.errors.deviation }, { "error_shape", r.errors.shape }, { "error_end", r.last.mean },
		{ "error_end_deviation", r.last.deviation }, { "error_end_shape", r.last.shape }, { "error_worst", r.worst },
		{ "worst_frame", r.worstFrame }, { "curve", r.curve }, { "volume_drift", r.volumeDrift }, { "momentum_drift", r.momentumDrift },
		{ "spin_drift", r.spinDrift }, { "energy_growth", r.energyGrowth }, { "broken_at_s", r.brokenAt }, { "pieces", r.pieces },
		{ "healthy", r.isHealthy } };
}

Record recordFrom( const nlohmann::json& json )
{
	Record r;
	const auto take = [&json]( const char* key, auto& to ) { json.at( key ).get_to( to ); };
	take( "candidate", r.candidate );
	take( "family", r.family );
	take( "scene", r.scene );
	take( "orientation", r.orientation );
	take( "ours", r.isOurs );
	take( "refused", r.refused );
	take( "nodes", r.nodes );
	take( "substeps", r.substeps );
	take( "bytes", r.bytes );
	take( "median_s", r.median );
	take( "p99_s", r.slow );
	take( "max_s", r.slowest );
	take( "stages_s", r.stages );
	take( "error", r.errors.mean );
	take( "error_deviation", r.errors.deviation );
	take( "error_shape", r.errors.shape );
	take( "error_end", r.last.mean );
	take( "error_end_deviation", r.last.deviation );
	take( "error_end_shape", r.last.shape );
	take( "error_worst", r.worst );
	take( "worst_frame", r.worstFrame );
	take( "curve", r.curve );
	take( "volume_drift", r.volumeDrift );
	take( "momentum_drift", r.momentumDrift );
	take( "spin_drift", r.spinDrift );
	take( "energy_growth", r.energyGrowth );
	take( "broken_at_s", r.brokenAt );
	take( "pieces", r.pieces );
	take( "healthy", r.isHealthy );
	return r;
}

} // namespace pliant_study
