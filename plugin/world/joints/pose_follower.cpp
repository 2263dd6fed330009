#include "world/joints/pose_follower.h"

#include "matching/constants.h"
#include "world/constants.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pliant {

void PoseFollower::setTargets( std::vector<Vec3d> wanted, bool jumps )
{
	if ( jumps || !hasPose )
	{
		before = wanted;
	}
	target = std::move( wanted );
	isMoving = before != target;
	hasPose = true;
}

/// `reached`: the fraction of the game step at the end of the substep.
void PoseFollower::gather( const Body& body, double reached )
{
	m_nodes.assign( std::size_t( body.nodeCount() ), NodeTarget{} );
	const std::vector<std::uint32_t>& first = body.firstCells();
	for ( std::uint32_t own = 0; own < std::uint32_t( body.lattice().cellCount() ); ++own )
	{
		const std::size_t cell = first.empty() ? own : first[own];
		NodeTarget& node = m_nodes[std::size_t( body.nodeOfCell( own ) )];
		const double mass = double( model->fill[cell] );
		node.mass += mass;
		node.strength += mass * double( model->strength[cell] );
		node.reach += mass * double( model->reach[cell] );
		node.at += mass * ( before[cell] + reached * ( target[cell] - before[cell] ) );
		node.displacement += mass * ( target[cell] - before[cell] );
	}
}

void PoseFollower::shift( const Vec3d& by )
{
	for ( std::vector<Vec3d>* const positions : { &before, &target } )
	{
		for ( Vec3d& position : *positions )
		{
			position += by;
		}
	}
}

// With k = omega^2 strength blend and c = 2 zeta sqrt( k ) the spring's impulse over the mass is h ( k ( t - x - h v' ) + c ( w - v' ) ), t
// and w the target and its velocity at the end of the substep. A node that would end beyond its largest distance d is held at the point of
// the sphere of radius d about t that is nearest to it.
void PoseFollower::pull( Body& body, double h, int number, int count, const Vec3& gravity )
{
	NodePull& pull = body.pull();
	if ( !hasPose || blend == 0.0 )
	{
		time += h;
		pull.clear();
		return;
	}
	gather( body, double( number + 1 ) / double( count ) );
	const NodeState& nodes = body.nodes();
	pull.resize( nodes.padded );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const NodeTarget& sums = m_nodes[std::size_t( i )];
		const double stiffness = blend * sums.strength / sums.mass;
		if ( !( stiffness > 0.0 ) )
		{
			continue;
		}
		const Vec3d away = sums.at / sums.mass - nodes.worldPosition( i );
		const Vec3d targetVelocity = sums.displacement / ( sums.mass * h * double( count ) );
		double gain = kMostPoseGain;
		Vec3d velocity = away / h;
		if ( std::isfinite( model->frequency ) )
		{
			const double rate = h * model->frequency * std::sqrt( stiffness ), spring = rate * rate,
						 damper = 2.0 * model->dampingRatio * rate;
			gain = std::min( spring + damper, kMostPoseGain );
			velocity = ( spring * velocity + damper * targetVelocity ) / ( spring + damper );
		}
		const double reach = sums.reach / sums.mass / blend;
		const Vec3d free = ( nodes.v.get( i ) + float( h ) * gravity ).cast<double>();
		const Vec3d offset = h * ( free + gain * velocity ) / ( 1.0 + gain ) - away;
		if ( offset.norm() > reach )
		{
			gain = kMostPoseGain;
			velocity = ( away + reach * offset.normalized() ) / h;
		}
		velocity *= std::min( 1.0, kMostPoseSpeed / std::max( velocity.norm(), kMostPoseSpeed ) );
		pull.gain[std::size_t( i )] = float( gain );
		pull.velocity.set( i, velocity.cast<float>() );
	}
}

void PoseFollower::sum( const Body& body, double h )
{
	Vec3d linear, angular;
	body.pullImpulse( linear, angular );
	impulse += linear;
	angularImpulse += angular;
	time += h;
}

void PoseFollower::endStep( const Vec3d& massCentre )
{
	if ( time > 0.0 )
	{
		force = impulse / time;
		torque = ( angularImpulse - massCentre.cross( impulse ) ) / time;
	}
	impulse = angularImpulse = Vec3d::Zero();
	time = 0.0;
	if ( isMoving )
	{
		before = target;
		isMoving = false;
	}
}

namespace {

/// Returns the four largest of some weights, divided by their sum.
PoseModel::Weights largestOf( std::vector<std::pair<int, double>>& all )
{
	const std::size_t kept = std::min( all.size(), std::size_t( PoseModel::kMostBones ) );
	std::partial_sort( all.begin(), all.begin() + std::ptrdiff_t( kept ), all.end(),
		[]( const auto& a, const auto& b ) { return a.second != b.second ? a.second > b.second : a.first < b.first; } );
	PoseModel::Weights weights;
	double sum = 0.0;
	for ( std::size_t k = 0; k < kept; ++k )
	{
		sum += all[k].second;
	}
	for ( std::size_t k = 0; k < kept; ++k )
	{
		weights.bone[k] = all[k].first;
		weights.weight[k] = float( all[k].second / sum );
	}
	return weights;
}

void add( std::vector<std::pair<int, double>>& to, const PoseModel::Weights& weights, double factor )
{
	for ( std::size_t k = 0; k < weights.weight.size(); ++k )
	{
		if ( weights.weight[k] <= 0.0f )
		{
			continue;
		}
		const int bone = weights.bone[k];
		auto found = std::find_if( to.begin(), to.end(), [bone]( const auto& known ) { return known.first == bone; } );
		if ( found == to.end() )
		{
			found = to.insert( to.end(), { bone, 0.0 } );
		}
		found->second += factor * double( weights.weight[k] );
	}
}

} // namespace

std::vector<PoseModel::Weights> weightsOfCells( const Lattice& lattice, int boneCount, int vertexCount,
	const std::vector<std::uint32_t>& start, const std::vector<std::uint32_t>& cell, const std::vector<float>& share,
	const std::vector<PoseModel::Weights>& vertices )
{
	const std::size_t cells = std::size_t( lattice.cellCount() );
	std::vector<std::vector<std::pair<int, double>>> sums( cells );
	for ( std::size_t v = 0; v < std::size_t( vertexCount ); ++v )
	{
		for ( std::uint32_t k = start[v]; k < start[v + 1]; ++k )
		{
			add( sums[cell[k]], vertices[v], double( share[k] ) );
		}
	}
	std::vector<PoseModel::Weights> weights( cells );
	std::vector<char> isKnown( cells, 0 );
	for ( std::size_t c = 0; c < cells; ++c )
	{
		isKnown[c] = sums[c].empty() ? 0 : 1;
		weights[c] = sums[c].empty() ? weights[c] : largestOf( sums[c] );
	}
	// One layer of cells after another; cells that no link reaches follow the first bone.
	for ( std::vector<std::size_t> found; boneCount > 0; )
	{
		found.clear();
		for ( std::size_t c = 0; c < cells; ++c )
		{
			sums[c].clear();
			for ( std::uint32_t k = lattice.linkStart[c]; !isKnown[c] && k < lattice.linkStart[c + 1]; ++k )
			{
				if ( isKnown[lattice.linkTo[k]] )
				{
					add( sums[c], weights[lattice.linkTo[k]], 1.0 );
				}
			}
			if ( !sums[c].empty() )
			{
				found.push_back( c );
			}
		}
		for ( const std::size_t c : found )
		{
			weights[c] = largestOf( sums[c] );
			isKnown[c] = 1;
		}
		if ( found.empty() )
		{
			break;
		}
	}
	for ( std::size_t c = 0; c < cells; ++c )
	{
		if ( !isKnown[c] )
		{
			weights[c].weight[0] = 1.0f;
		}
	}
	return weights;
}

} // namespace pliant
