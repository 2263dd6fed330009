// For builds without plasticity: materials that flow are rejected (material.cpp), so none of this is ever called.

#include "matching/step/plasticity.h"

namespace pliant {

double FlowingRegion::energy( const Eigen::Matrix3d&, const Eigen::Matrix3d& ) const
{
	return 0.0;
}

bool flowStretch( const PlasticLaw&, float, const FlowingRegion&, Eigen::Matrix3d& )
{
	return false;
}

PlasticFlow::PlasticFlow( const RegionTables& tables ) : m_tables( &tables ) {}

bool PlasticFlow::yieldsAnywhere( const MatchView&, float )
{
	return false;
}

void PlasticFlow::show( MatchView& ) const {}

bool PlasticFlow::flow( const MatchView&, const Kernels&, const MatchStep&, int, int )
{
	return false;
}

void PlasticFlow::carryOver( const RegionTables&, const RegionTables&, const FlowSources& ) {}
void PlasticFlow::inherit( const PlasticFlow&, const std::vector<std::uint32_t>& ) {}

Eigen::Matrix3d PlasticFlow::stretch( int ) const
{
	return Eigen::Matrix3d::Identity();
}

} // namespace pliant
